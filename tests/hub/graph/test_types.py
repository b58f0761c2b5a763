"""Types: they check and encode messages, requests and goals."""

from __future__ import annotations

from struct import pack
from typing import Any, TypeVar

import cbor2
import pytest

from fibws.errors import (
    DefinitionError,
    DefinitionLimit,
    InvalidMessage,
    OperationError,
    UnknownPackage,
    UnknownType,
)
from fibws.hub.graph.types import AnyType, Types
from fibws.interfaces import Interfaces, client_definitions
from fibws.interfaces.client_definitions import DefinitionLimits

from ..fakes import ADD, FIBONACCI, INT32, NANOSECONDS

T = TypeVar("T", bound=AnyType)

TYPES = Types(Interfaces(), lambda: NANOSECONDS, strict=False)


def held(types: Types, type_: T) -> T:
    """Hold the definition of a type, and return the type."""
    types.hold(type_, "holder")
    return type_


def new_types(*, strict: bool = False) -> Types:
    return Types(Interfaces(), lambda: NANOSECONDS, strict=strict)


# Messages.


def test_known_type_checks_completes_and_encodes_messages() -> None:
    type_ = TYPES.message(INT32)
    assert (type_.name, type_.checked, type_.sequenced) == (INT32, True, False)
    assert type_.validate({}) == {"data": 0}
    assert type_.missing({}) == ["data"]
    assert cbor2.loads(type_.cbor({"data": 5})) == {"data": 5}
    assert type_.serialize({"data": 5}) == pack("<i", 5)
    type_.check(pack("<i", 5))
    assert type_.deserialize(pack("<i", 5)) == ({"data": 5}, False)
    assert type_.cbor_of(pack("<i", 5)) == (cbor2.dumps({"data": 5}), False)
    assert (type_.md5sum, type_.has_floats) == ("da5909fbe378aeaf85e547e830cc1bb7", False)
    with pytest.raises(InvalidMessage):
        type_.validate({"data": "5"})


def test_type_is_made_once() -> None:
    assert TYPES.message(INT32) is TYPES.message(INT32)
    assert TYPES.service(ADD) is TYPES.service(ADD)
    assert TYPES.action(FIBONACCI) is TYPES.action(FIBONACCI)


def test_messages_that_begin_with_a_header_are_numbered() -> None:
    assert TYPES.message("rospy_tutorials/HeaderString").sequenced
    assert not TYPES.message("std_msgs/Header").sequenced


def test_now_is_the_time_of_the_hubs_clock() -> None:
    secs, nsecs = divmod(NANOSECONDS, 10**9)
    stamp = {"secs": secs, "nsecs": nsecs}
    assert TYPES.message("std_msgs/Time").validate({"data": "now"}) == {"data": stamp}
    assert TYPES.message("std_msgs/Header").validate({})["stamp"] == stamp


def test_messages_of_an_unknown_type_are_relayed_unchanged() -> None:
    type_ = TYPES.message("my_msgs/Thing")
    assert (type_.name, type_.checked, type_.sequenced) == ("my_msgs/Thing", False, False)
    message = {"any": [{"thing": None}], "header": {"seq": 5}}
    assert type_.validate(message) == message
    assert type_.missing(message) == []
    assert cbor2.loads(type_.cbor(message)) == message


def test_messages_of_an_unknown_type_cannot_be_serialized() -> None:
    unknown = TYPES.message("my_msgs/Thing")
    assert unknown.md5sum is None
    for attempt in (
        unknown.check_known,
        lambda: unknown.check(b""),
        lambda: unknown.serialize({}),
        lambda: unknown.deserialize(b""),
        lambda: unknown.cbor_of(b""),
    ):
        with pytest.raises(OperationError, match="definition of my_msgs/Thing"):
            attempt()
    TYPES.message(INT32).check_known()


@pytest.mark.parametrize("data", [b"", b"abc", b"abcde"])
def test_bytes_that_do_not_fit_the_type_are_refused(data: bytes) -> None:
    with pytest.raises(InvalidMessage):
        TYPES.message(INT32).check(data)


@pytest.mark.parametrize(
    ("type_", "has_floats"),
    [
        (INT32, False),
        ("std_msgs/Float32", True),
        ("std_msgs/Float64MultiArray", True),
        ("geometry_msgs/TwistStamped", True),
        ("rospy_tutorials/HeaderString", False),
        ("my_msgs/Thing", True),
    ],
)
def test_type_knows_whether_a_message_may_hold_floats(type_: str, has_floats: bool) -> None:
    assert TYPES.message(type_).has_floats == has_floats


@pytest.mark.parametrize("msg", [5, "x", [], None])
def test_unchecked_message_must_be_an_object(msg: object) -> None:
    with pytest.raises(InvalidMessage, match="Expected a JSON object for type my_msgs/Thing but"):
        TYPES.message("my_msgs/Thing").validate(msg)


def test_client_may_bring_the_definition_of_a_message() -> None:
    types = new_types(strict=True)
    type_ = types.message("my_msgs/Thing", "int8 one\n")
    assert type_.validate({}) == {"one": 0}
    with pytest.raises(UnknownPackage):
        types.message("my_msgs/Thing")
    held(types, type_)
    assert types.message("my_msgs/Thing") is type_


def test_unknown_type_is_known_once_a_client_brings_its_definition() -> None:
    types = new_types()
    assert not types.message("my_msgs/Thing").checked
    type_ = held(types, types.message("my_msgs/Thing", "int8 one\n"))
    assert types.message("my_msgs/Thing") is type_
    assert not types.message("my_msgs/Other").checked


@pytest.mark.parametrize("strict", [False, True])
def test_type_is_unchecked_without_its_definition_unless_types_are_strict(strict: bool) -> None:
    types = new_types(strict=strict)
    type_ = held(types, types.message("my_msgs/Thing", "int8 one\n"))
    without = types.without_definition(type_)
    assert (without.name, without.checked) == ("my_msgs/Thing", strict)
    installed = types.message(INT32)
    assert types.without_definition(installed) is installed


def test_type_may_be_used_on_after_its_definition_is_forgotten() -> None:
    types = new_types()
    text = f"Point at\n{'=' * 80}\nMSG: my_msgs/Point\nint8 x"
    older = held(types, types.message("my_msgs/Thing", text))
    types.release(older, "holder")
    held(types, types.message("my_msgs/Point", "string x"))
    assert older.validate({"at": {"x": 1}}) == {"at": {"x": 1}}
    assert older.missing({"at": {}}) == ["at.x"]
    assert older.serialize({"at": {"x": 1}}) == b"\1"
    assert older.cbor_of(b"\1") == (cbor2.dumps({"at": {"x": 1}}), False)
    assert not older.has_floats
    with pytest.raises(InvalidMessage, match=r"requires an int8 for field at\.x"):
        older.validate({"at": {"x": "1"}})


# Services.


def test_service_checks_requests_and_responses() -> None:
    type_ = TYPES.service(ADD)
    assert (type_.name, type_.arguments) == (ADD, ("a", "b"))
    assert type_.request({"b": 2}) == {"a": 0, "b": 2}
    assert type_.response({}) == {"sum": 0}
    with pytest.raises(InvalidMessage, match="AddTwoIntsResponse does not have a field a"):
        type_.response({"a": 1})


@pytest.mark.parametrize(
    ("args", "request_"),
    [
        ({"a": 1}, {"a": 1, "b": 0}),
        ([1, 2], {"a": 1, "b": 2}),
        ([1, 2, 3], {"a": 1, "b": 2}),
        ([], {"a": 0, "b": 0}),
        (None, {"a": 0, "b": 0}),
        ("1", {"a": 0, "b": 0}),
        (1, {"a": 0, "b": 0}),
    ],
)
def test_request_may_be_an_object_or_a_list_of_its_fields(
    args: object, request_: dict[str, int]
) -> None:
    assert TYPES.service(ADD).fill_request(args) == request_


def test_request_without_fields_ignores_a_list() -> None:
    type_ = TYPES.service("std_srvs/Empty")
    assert type_.arguments == ()
    assert type_.fill_request([1, 2]) == type_.fill_request(None) == {}
    with pytest.raises(InvalidMessage):
        type_.fill_request({"a": 1})


def test_unknown_service_takes_objects_but_not_lists() -> None:
    type_ = TYPES.service("my_srvs/Do")
    assert (type_.name, type_.arguments) == ("my_srvs/Do", None)
    assert type_.fill_request({"any": 1}) == type_.response({"any": 1}) == {"any": 1}
    assert type_.fill_request("any") == {}
    with pytest.raises(InvalidMessage, match="my_srvs/Do, whose fields are not known here"):
        type_.fill_request([])


def test_client_may_bring_the_definition_of_a_service() -> None:
    types = new_types()
    assert types.service("my_srvs/Do").arguments is None
    type_ = held(types, types.service("my_srvs/Do", "int8 one\n---\n"))
    assert types.service("my_srvs/Do") is type_
    assert type_.arguments == ("one",)


# Actions.


def test_action_checks_goals_feedback_and_results() -> None:
    type_ = TYPES.action(FIBONACCI)
    assert type_.goal({}) == {"order": 0}
    assert type_.feedback({}) == type_.result({}) == {"sequence": []}
    for check in (type_.goal, type_.feedback, type_.result):
        with pytest.raises(InvalidMessage):
            check({"wrong": 1})


def test_messages_of_an_unknown_action_are_relayed_unchanged() -> None:
    type_ = TYPES.action("my_actions/Do")
    for check in (type_.goal, type_.feedback, type_.result):
        assert check({"any": 1}) == {"any": 1}
        with pytest.raises(InvalidMessage, match="Expected a JSON object for type my_actions/Do"):
            check([1])


def test_client_may_bring_the_definition_of_an_action() -> None:
    types = new_types()
    definition = "int8 goal\n---\nint8 result\n---\nint8 feedback\n"
    assert types.action("my_actions/Do").goal({"any": 1}) == {"any": 1}
    type_ = types.action("my_actions/Do", definition)
    assert (type_.goal({}), type_.feedback({}), type_.result({})) == (
        {"goal": 0},
        {"feedback": 0},
        {"result": 0},
    )


# Messages, services and actions.

KINDS = ["message", "service", "action"]
WRONG = {"message": "int33 x\n", "service": "int33 x\n---\n", "action": "int33 x\n---\n---\n"}
OTHER = {"message": "int8 x\n", "service": "int8 x\n---\n", "action": "int8 x\n---\n---\n"}
KNOWN = {"message": INT32, "service": ADD, "action": FIBONACCI}


def made(types: Types, kind: str, *args: Any) -> Any:
    return getattr(types, kind)(*args)


@pytest.mark.parametrize("kind", KINDS)
def test_strict_types_refuse_an_unknown_package(kind: str) -> None:
    with pytest.raises(UnknownPackage, match="my_package"):
        made(new_types(strict=True), kind, "my_package/Thing")


@pytest.mark.parametrize("kind", KINDS)
def test_unknown_type_of_a_known_package_is_refused_with_a_suggestion(kind: str) -> None:
    name = KNOWN[kind]
    with pytest.raises(UnknownType, match=rf"did you mean {name}\?"):
        made(TYPES, kind, name[:-1])


@pytest.mark.parametrize("kind", KINDS)
def test_invalid_definition_is_refused_and_not_kept(kind: str) -> None:
    types = new_types(strict=True)
    with pytest.raises(DefinitionError, match="int33"):
        made(types, kind, "my_package/Thing", WRONG[kind])
    with pytest.raises(UnknownPackage):
        made(types, kind, "my_package/Thing")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["known", "my_package/Thing"])
def test_md5_chooses_among_types_of_one_name(kind: str, name: str) -> None:
    types = new_types()
    name = KNOWN[kind] if name == "known" else name
    other = OTHER[kind]
    found = [
        held(types, made(types, kind, name, each))
        for each in (other, other.replace("int8", "int16"))
    ]
    if kind == "action":
        return  # Clients name no md5 of an action's type.
    choose = types.message if kind == "message" else types.service
    assert [choose(name, None, "", each.md5sum) for each in found] == found


@pytest.mark.parametrize("kind", KINDS)
def test_type_of_another_definition_is_another_one(kind: str) -> None:
    types = new_types()
    older = held(types, made(types, kind, "my_package/Thing", OTHER[kind]))
    types.release(older, "holder")
    newer = held(types, made(types, kind, "my_package/Thing", OTHER[kind].replace("8", "16")))
    assert made(types, kind, "my_package/Thing") is newer is not older


@pytest.mark.parametrize("kind", KINDS)
def test_type_is_unchecked_if_there_is_no_room_for_its_definition(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(client_definitions, "PER_CLIENT", DefinitionLimits(1000, 1000, 0))
    type_ = made(new_types(), kind, "my_package/Thing", OTHER[kind], "/greedy")
    assert (type_.codecs, type_.name) == (None, "my_package/Thing")
    assert "from /greedy to add my_package/Thing (limit is 0)" in type_.fault
    with pytest.raises(DefinitionLimit, match="limit is 0"):
        made(new_types(strict=True), kind, "my_package/Thing", OTHER[kind], "/greedy")


@pytest.mark.parametrize("kind", KINDS)
def test_unknown_type_names_are_not_kept(kind: str) -> None:
    types = new_types()
    for number in range(100):
        made(types, kind, f"made_up_{number}/Thing")
        with pytest.raises(UnknownType):
            made(types, kind, f"std_msgs/Thing{number}")
    codecs = types._installed
    assert not (codecs._messages or codecs._services or codecs._actions)
