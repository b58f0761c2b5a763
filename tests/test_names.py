"""Graph names, as http://wiki.ros.org/Names has them."""

from __future__ import annotations

import os
import re

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fibws import names
from fibws.errors import InvalidName
from fibws.names import Remapping

LEGAL = ["a", "chat", "/chat", "~chat", "a/b/c", "/a1/b_2", "A", "/fib/_action/status", "a" * 1024]
LEGAL += ["/1a", "~1", "/camera/0/image", "robot/2"]
ILLEGAL = ["", "/", "~", "1a", "1/a", "a/", "a//b", "a b", "a-b", "ä", "a~", "~/a", "a\n", "//a"]
PARTS = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,8}", fullmatch=True)
GLOBAL = st.lists(PARTS, min_size=1, max_size=4).map(lambda parts: "/" + "/".join(parts))


@pytest.mark.parametrize("name", LEGAL)
def test_legal_name_is_returned(name: str) -> None:
    assert names.check(name) == name


@pytest.mark.parametrize("name", [*ILLEGAL, "a" * 1025])
def test_illegal_name_is_an_error(name: str) -> None:
    with pytest.raises(InvalidName):
        names.check(name)


@pytest.mark.parametrize(
    ("name", "resolved"),
    [
        ("chat", "/robot/chat"),
        ("~chat", "/robot/arm/chat"),
        ("~/chat", "/robot/arm/chat"),
        ("a-b", "/robot/a-b"),
        ("a/", "/robot/a"),
        ("//a", "/a"),
        ("/a//b/", "/a/b"),
        ("/a.b", "/a.b"),
        ("/übung", "/übung"),
        ("1st", "/robot/1st"),
        ("/" + "a" * 1023, "/" + "a" * 1023),
    ],
)
def test_illegal_names_are_resolved(name: str, resolved: str) -> None:
    assert names.resolve_any(name, namespace="/robot", node="/robot/arm") == resolved


@pytest.mark.parametrize(
    "name", ["", "/", "//", "~", "~/", "a b", "a\n", "/a\x1b[0m", "/a\u202eb", "\ud800", "-" * 1025]
)
def test_names_with_whitespace_or_control_characters_are_an_error(name: str) -> None:
    with pytest.raises(InvalidName):
        names.resolve_any(name)


@given(st.text(max_size=50))
def test_resolved_name_resolves_to_itself(name: str) -> None:
    try:
        resolved = names.resolve_any(name, namespace="/robot", node="/robot/arm")
    except InvalidName:
        assert not names.is_legal(name)
    else:
        assert names.resolve_any(resolved) == resolved


@pytest.mark.parametrize("name", LEGAL)
def test_legal_name_is_resolved_equally_by_both(name: str) -> None:
    assert names.is_legal(name)
    assert names.resolve_any(name, node="/talker") == names.resolve(name, node="/talker")


def test_error_about_a_long_name_is_short() -> None:
    with pytest.raises(InvalidName, match="longer than 1024") as caught:
        names.check("a" * 10_000)
    assert len(str(caught.value)) < 150


@pytest.mark.parametrize("name", ["talker", "t1", "T_"])
def test_base_name_of_a_node(name: str) -> None:
    assert names.check_base(name) == name


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("/talker", "namespaces are not allowed"),
        ("a/b", "namespaces are not allowed"),
        ("", "a letter"),
        ("1", "a letter"),
        ("~a", "a letter"),
        ("a" * 1025, "a letter"),
    ],
)
def test_other_names_of_a_node_are_an_error(name: str, fault: str) -> None:
    with pytest.raises(InvalidName, match=fault):
        names.check_base(name)


@pytest.mark.parametrize(
    ("name", "resolved"),
    [
        ("/chat", "/chat"),
        ("/a/b", "/a/b"),
        ("chat", "/robot/chat"),
        ("a/b", "/robot/a/b"),
        ("~gain", "/robot/arm/gain"),
        ("~pid/gain", "/robot/arm/pid/gain"),
    ],
)
def test_names_are_global_relative_or_private(name: str, resolved: str) -> None:
    assert names.resolve(name, namespace="/robot", node="/robot/arm") == resolved


def test_default_namespace_is_the_root() -> None:
    assert names.resolve("chat") == "/chat"


def test_resolving_an_illegal_name_is_an_error() -> None:
    with pytest.raises(InvalidName):
        names.resolve("not legal")


@given(GLOBAL, GLOBAL)
def test_resolving_twice_changes_nothing(namespace: str, name: str) -> None:
    resolved = names.resolve(name[1:], namespace=namespace)
    assert names.resolve(resolved, namespace="/elsewhere", node="/elsewhere/node") == resolved


@given(GLOBAL, PARTS)
def test_joined_name_is_in_its_namespace(namespace: str, name: str) -> None:
    assert names.join(namespace, name) == f"{namespace}/{name}"
    assert names.join("/", name) == f"/{name}"


@given(st.binary(min_size=8, max_size=8))
@example(bytes(8))
@example(b"\xff" * 8)
def test_anonymous_name_has_the_form_of_rospys(random: bytes) -> None:
    name = names.anonymous("talker", pid=42, random=random)
    assert re.fullmatch(r"talker_42_[1-9]\d{12}", name)
    assert names.check_base(name) == name


def test_nodes_of_equal_pids_get_different_anonymous_names() -> None:
    made = {names.anonymous("talker", pid=1, random=os.urandom(8)) for _ in range(1000)}
    assert len(made) == 1000


def test_anonymous_name_on_a_host_is_legal_and_unique() -> None:
    made = {
        names.anonymous_on_host("talker", host="my-robot.local", pid=7, random=os.urandom(8))
        for _ in range(1000)
    }
    assert len(made) == 1000
    assert all(re.fullmatch(r"talker_my_robot_local_7_\d+", name) for name in made)


@pytest.mark.parametrize("spelling", ["/a/b", "a/b", "/a/b/", "a/b/"])
def test_spellings_of_a_namespace(spelling: str) -> None:
    assert names.check_namespace(spelling) == "/a/b"


@pytest.mark.parametrize("spelling", ["", "/"])
def test_root_is_a_namespace(spelling: str) -> None:
    assert names.check_namespace(spelling) == "/"


@pytest.mark.parametrize("spelling", ["a b", "1", "a//b", "~a", "/~a"])
def test_invalid_namespace_is_an_error(spelling: str) -> None:
    with pytest.raises(InvalidName):
        names.check_namespace(spelling)


def apply(remapping: Remapping, name: str) -> str:
    return remapping.apply(name, namespace="/robot", node="/robot/arm")


@pytest.mark.parametrize(
    ("argument", "name", "applied"),
    [
        ("chat:=talk", "chat", "/robot/talk"),
        ("chat:=/talk", "/robot/chat", "/talk"),
        ("/robot/chat:=talk", "chat", "/robot/talk"),
        ("/chat:=/talk", "chat", "/robot/chat"),
        ("~gain:=/gain", "~gain", "/gain"),
        ("gain:=~gain", "gain", "/robot/arm/gain"),
        ("chat:=talk", "other", "/robot/other"),
    ],
)
def test_remapping_compares_resolved_names(argument: str, name: str, applied: str) -> None:
    assert apply(names.parse_remappings([argument]), name) == applied


def test_remapping_is_applied_once() -> None:
    swapped = names.parse_remappings(["a:=b", "b:=a"])
    assert [apply(swapped, name) for name in ("a", "b")] == ["/robot/b", "/robot/a"]


def test_special_keys_name_the_node_and_its_namespace() -> None:
    remapping = names.parse_remappings(["__name:=left", "__ns:=robot/", "chat:=talk"])
    assert remapping == Remapping({"chat": "talk"}, node_name="left", namespace="/robot")


def test_no_arguments_remap_nothing() -> None:
    assert names.parse_remappings([]) == Remapping()


def test_other_special_keys_are_ignored() -> None:
    assert names.parse_remappings(["__log:=/tmp/x y"]) == Remapping()


def test_private_parameters_are_not_remappings() -> None:
    found = names.parse_remappings(["_gain:=1.5", "_pid/p:="])
    assert found == Remapping(parameters={"gain": "1.5", "pid/p": ""})


@pytest.mark.parametrize(
    "argument",
    [
        "chat",
        "chat:=",
        ":=chat",
        "a b:=c",
        "a:=b c",
        "__name:=/a/b",
        "__name:=",
        "__ns:=a b",
        "_a b:=1",
    ],
)
def test_invalid_remapping_is_an_error(argument: str) -> None:
    with pytest.raises(InvalidName):
        names.parse_remappings([argument])


def test_name_is_a_string() -> None:
    with pytest.raises(TypeError, match="a name must be a string, got 5"):
        names.resolve(5)  # type: ignore[arg-type]
