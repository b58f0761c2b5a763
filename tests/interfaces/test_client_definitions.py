"""Clients may bring types: whole, no others than those that are known, and only so many."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.errors import DefinitionError, InterfaceError, UnknownPackage, UnknownType
from fibws.interfaces import Interfaces, client_definitions, full_text
from fibws.interfaces.definition import Field

SEPARATOR = "=" * 80
POINT = f"{SEPARATOR}\nMSG: new_msgs/Point\nint32 x\n"


def test_a_client_may_bring_a_type() -> None:
    interfaces = Interfaces()
    text = f"Inner inner\nHeader h\n{SEPARATOR}\nMSG: new_msgs/Inner\nint32 x\n"
    assert interfaces.learn("new_msgs/msg/Outer", text).type == "new_msgs/Outer"
    assert interfaces.message("new_msgs/Inner").fields == (Field("x", "int32"),)
    assert "new_msgs" in interfaces.packages()
    assert interfaces.messages("new_msgs") == ["new_msgs/Inner", "new_msgs/Outer"]


def test_who_brings_a_type_says_nothing_of_the_others_of_its_package() -> None:
    interfaces = Interfaces()
    interfaces.learn("new_msgs/Mine", "int32 x")
    with pytest.raises(UnknownPackage):
        interfaces.message("new_msgs/Mien")
    with pytest.raises(UnknownType, match="did you mean std_msgs/String"):
        interfaces.message("std_msgs/Sting")


def test_what_was_learned_outlives_a_new_folder(tmp_path: Path) -> None:
    interfaces = Interfaces()
    interfaces.learn("new_msgs/Mine", "int32 x")
    interfaces.add_folder(tmp_path)
    assert interfaces.message("new_msgs/Mine").fields == (Field("x", "int32"),)


def test_every_standard_type_may_be_brought_again() -> None:
    interfaces, same = Interfaces(), Interfaces()
    for package in interfaces.packages():
        for name in interfaces.messages(package):
            assert same.learn(name, interfaces.full_text(name)) == interfaces.message(name)


@pytest.mark.parametrize("name", ["std_msgs/Int32", "new_msgs/Outer"])
def test_a_type_cannot_be_brought_with_other_fields(name: str) -> None:
    interfaces = Interfaces()
    text = f"std_msgs/Int32 data\n{SEPARATOR}\nMSG: std_msgs/Int32\nint64 data"
    with pytest.raises(DefinitionError, match="is known here with other fields"):
        interfaces.learn(name, text)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (f"Inner inner\n{SEPARATOR}\nMSG: new_msgs/Inner\nint32", "line 4: expected a field"),
        (f"Inner inner\n{SEPARATOR}\nMSG: new_msgs/Inner\nOuter o", "contains itself"),
        (f"Inner i\nNo no\n{SEPARATOR}\nMSG: new_msgs/Inner\nint8 x", "for package new_msgs"),
    ],
)
def test_a_wrong_definition_teaches_nothing(text: str, fault: str) -> None:
    interfaces = Interfaces()
    with pytest.raises(DefinitionError, match=fault):
        interfaces.learn("new_msgs/Outer", text)
    assert "new_msgs" not in interfaces.packages()


def test_clients_can_bring_only_so_much(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_definitions, "MOST", 1)
    interfaces = Interfaces()
    with pytest.raises(InterfaceError, match="limit is 262144 characters"):
        interfaces.learn("new_msgs/Long", "#" * 300_000)
    interfaces.learn("new_msgs/One", "int32 x")
    interfaces.learn("new_msgs/One", "int32 x # once more")
    with pytest.raises(InterfaceError, match="to add new_msgs/Two "):
        interfaces.learn("new_msgs/Two", "int32 x")


def test_a_client_may_bring_a_service() -> None:
    interfaces = Interfaces()
    service = interfaces.learn_service("new_msgs/srv/Ask", f"Point at\n---\nPoint[] all\n{POINT}")
    assert service is interfaces.service("new_msgs/Ask")
    assert service.request.fields == (Field("at", "new_msgs/Point"),)
    assert interfaces.message("new_msgs/Point").fields == (Field("x", "int32"),)
    assert interfaces.services("new_msgs") == ["new_msgs/Ask"]
    assert interfaces.messages("new_msgs") == ["new_msgs/Point"]
    assert "new_msgs" in interfaces.packages()


def test_a_client_may_bring_an_action() -> None:
    interfaces = Interfaces()
    action = interfaces.learn_action("new_msgs/action/Go", f"Point to\n---\n---\nPoint at\n{POINT}")
    assert action is interfaces.action("new_msgs/Go")
    assert action.goal.fields == (Field("to", "new_msgs/Point"),)
    assert interfaces.message("new_msgs/GoActionGoal").fields[2].type == "new_msgs/GoGoal"
    assert interfaces.actions("new_msgs") == ["new_msgs/Go"]
    assert len(interfaces.messages("new_msgs")) == 8
    assert "new_msgs" in interfaces.packages()


def test_a_service_may_be_brought_without_what_is_known() -> None:
    interfaces = Interfaces()
    interfaces.learn_service("new_msgs/Ask", "std_msgs/Header header\n---")
    interfaces.learn_service("std_srvs/Again", "---")
    assert interfaces.services("std_srvs")[0] == "std_srvs/Again"


def test_every_standard_service_and_action_may_be_brought_again() -> None:
    interfaces, same = Interfaces(), Interfaces()
    for package in interfaces.packages():
        for name in interfaces.services(package):
            known = interfaces.service(name)
            assert same.learn_service(name, interfaces.service_text(name)) == known
        for name in interfaces.actions(package):
            assert same.learn_action(name, interfaces.action_text(name)) == interfaces.action(name)


def test_what_a_node_sends_of_its_own_package_is_all_that_is_needed(tmp_path: Path) -> None:
    package = tmp_path / "my_msgs"
    for name, text in {
        "msg/Outer.msg": "Inner[] inner\nHeader header",
        "msg/Inner.msg": "wstring<=5 text",
        "srv/Ask.srv": "Outer outer\n---\nInner inner",
        "action/Go.action": "Outer outer\n---\nInner inner\n---",
    }.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text, "utf-8")
    mine, hubs = Interfaces([tmp_path]), Interfaces()
    hubs.learn("my_msgs/Outer", mine.full_text("my_msgs/Outer"))
    assert hubs.md5("my_msgs/Outer") == mine.md5("my_msgs/Outer")
    hubs = Interfaces()
    hubs.learn_service("my_msgs/Ask", mine.service_text("my_msgs/Ask"))
    assert hubs.service_md5("my_msgs/Ask") == mine.service_md5("my_msgs/Ask")
    hubs.learn_action("my_msgs/Go", mine.action_text("my_msgs/Go"))
    assert hubs.md5("my_msgs/GoAction") == mine.md5("my_msgs/GoAction")


def test_a_service_cannot_be_brought_with_other_fields() -> None:
    interfaces = Interfaces()
    with pytest.raises(DefinitionError, match="std_srvs/SetBoolResponse is known here with other"):
        interfaces.learn_service("std_srvs/SetBool", "bool data\n---\nbool success")
    # All fields of both sides together are the same.
    with pytest.raises(DefinitionError, match="std_srvs/TriggerRequest is known here with other"):
        interfaces.learn_service("std_srvs/Trigger", "bool success\nstring message\n---\n")
    interfaces.learn_service("new_msgs/Ask", "int32 x\n---")
    with pytest.raises(DefinitionError, match="new_msgs/AskRequest is known here with other"):
        interfaces.learn_service("new_msgs/Ask", "int64 x\n---")


def test_an_action_cannot_be_brought_with_other_fields() -> None:
    interfaces = Interfaces()
    with pytest.raises(DefinitionError, match="actionlib/TwoIntsResult is known here"):
        interfaces.learn_action("actionlib/TwoInts", "int64 a\nint64 b\n---\nint8 sum\n---")
    interfaces.learn("new_msgs/GoGoal", "int32 x")
    with pytest.raises(DefinitionError, match="new_msgs/GoGoal is known here with other"):
        interfaces.learn_action("new_msgs/Go", "int64 x\n---\n---")
    assert interfaces.learn_action("new_msgs/Go", "int32 x\n---\n---").goal.fields[0].name == "x"
    with pytest.raises(DefinitionError, match="new_msgs/GoResult is known here with other"):
        interfaces.learn("new_msgs/GoResult", "int32 x")


def test_a_nested_type_cannot_be_brought_with_other_fields() -> None:
    interfaces = Interfaces()
    other = f"{SEPARATOR}\nMSG: std_msgs/Int32\nint64 data"
    with pytest.raises(DefinitionError, match="std_msgs/Int32 is known here with other"):
        interfaces.learn_service("new_msgs/Ask", f"std_msgs/Int32 x\n---\n{other}")
    with pytest.raises(DefinitionError, match="std_msgs/Int32 is known here with other"):
        interfaces.learn_action("new_msgs/Go", f"std_msgs/Int32 x\n---\n---\n{other}")
    assert "new_msgs" not in interfaces.packages()


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("int32 x", "expected 1 lines of ---, got 0"),
        ("int32 x\n---\nint32", "line 3: expected a field"),
        (f"Point p\nNo no\n---\n{POINT}", "for package new_msgs"),
        (f"---\nNo no\n{POINT}", "for package new_msgs"),
        (f"---\n{POINT}Ours ours", "for package new_msgs"),
    ],
)
def test_a_wrong_service_or_action_teaches_nothing(text: str, fault: str) -> None:
    interfaces = Interfaces()
    with pytest.raises(DefinitionError, match=fault):
        interfaces.learn_service("new_msgs/Ask", text)
    one_more = fault.replace("1 lines", "2 lines").replace("got 0", "got 1").replace("e 3", "e 4")
    with pytest.raises(DefinitionError, match=one_more):
        interfaces.learn_action("new_msgs/Go", f"---\n{text}")
    assert "new_msgs" not in interfaces.packages()


def test_services_and_actions_count_among_what_clients_bring(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    interfaces = Interfaces()
    monkeypatch.setattr(client_definitions, "MOST", 2)
    interfaces.learn_service("new_msgs/Ask", f"Point p\n---\n{POINT}")
    for _ in range(2):
        interfaces.learn_service("new_msgs/Ask", f"Point p\n---\n{POINT}")
        with pytest.raises(InterfaceError, match="to add new_msgs/Tell "):
            interfaces.learn_service("new_msgs/Tell", "---")
    monkeypatch.setattr(client_definitions, "MOST", 9)
    with pytest.raises(InterfaceError, match="to add new_msgs/Go "):
        interfaces.learn_action("new_msgs/Go", "---\n---")
    assert interfaces.messages("new_msgs") == ["new_msgs/Point"]
    monkeypatch.setattr(client_definitions, "MOST", 10)
    for _ in range(2):
        interfaces.learn_action("new_msgs/Go", "---\n---")
    for learn in (interfaces.learn_service, interfaces.learn_action):
        with pytest.raises(InterfaceError, match="limit is 262144 characters"):
            learn("new_msgs/Long", "#" * 300_000)


def test_learned_services_and_actions_outlive_a_new_folder(tmp_path: Path) -> None:
    interfaces = Interfaces()
    interfaces.learn_service("new_msgs/Ask", "int32 x\n---")
    interfaces.learn_action("new_msgs/Go", "int32 x\n---\n---")
    interfaces.add_folder(tmp_path)
    assert interfaces.service("new_msgs/Ask").request.fields == (Field("x", "int32"),)
    assert interfaces.action("new_msgs/Go").goal.fields == (Field("x", "int32"),)


@pytest.mark.parametrize("line", ["float64[65537] x", "Big[2] x", "Big x\nbool y"])
def test_a_client_cannot_bring_long_fixed_arrays(line: str) -> None:
    interfaces = Interfaces()
    big = f"{SEPARATOR}\nMSG: new_msgs/Big\nuint8[65536] data"
    with pytest.raises(InterfaceError, match=r"new_msgs/\w+ has \d+ values .* 65536$"):
        interfaces.learn("new_msgs/Long", f"{line}\n{big}")
    with pytest.raises(InterfaceError, match=r"65536$"):
        interfaces.learn_service("new_msgs/Ask", f"---\n{line}\n{big}")
    with pytest.raises(InterfaceError, match=r"65536$"):
        interfaces.learn_action("new_msgs/Go", f"---\n---\n{line}\n{big}")
    assert "new_msgs" not in interfaces.packages()
    interfaces.learn("new_msgs/Fits", f"Big[] x\n{big}")


def test_the_users_own_types_may_have_longer_ones(tmp_path: Path) -> None:
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Long.msg").write_text("uint8[4000000] x")
    interfaces = Interfaces([tmp_path])
    assert interfaces.learn("my_msgs/Long", "uint8[4000000] x") == interfaces.message(
        "my_msgs/Long"
    )


def test_all_that_clients_bring_has_only_so_many_fields(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_definitions, "MOST_FIELDS", 10)
    interfaces = Interfaces()
    interfaces.learn("new_msgs/Three", "int8 x\nint8 Y=1\nint8 z")
    interfaces.learn("new_msgs/Four", "Three three\nint8 x")
    with pytest.raises(InterfaceError, match=r"fields and constants .*limit is 10 "):
        interfaces.learn("new_msgs/More", "Four four")
    with pytest.raises(InterfaceError, match="to add new_msgs/Ask "):
        interfaces.learn_service("new_msgs/Ask", "Four four\n---")
    with pytest.raises(InterfaceError, match="to add new_msgs/Go "):
        interfaces.learn_action("new_msgs/Go", "int8 x\n---\n---")
    interfaces.learn("new_msgs/Time", "time t")
    with pytest.raises(InterfaceError, match="to add new_msgs/One "):
        interfaces.learn("new_msgs/One", "int8 x")


def test_what_is_brought_again_is_not_read_again(monkeypatch: pytest.MonkeyPatch) -> None:
    interfaces = Interfaces()
    brought = {
        interfaces.learn: ("read_message", "int8 x"),
        interfaces.learn_service: ("read_service", "int8 x\n---"),
        interfaces.learn_action: ("read_action", "int8 x\n---\n---"),
    }
    for learn, (read, text) in brought.items():
        first = learn("new_msgs/Mine", text)
        with monkeypatch.context() as patch:
            patch.delattr(full_text, read)
            assert learn("new_msgs/Mine", text) == first
        with pytest.raises(DefinitionError, match="is known here with other"):
            learn("new_msgs/Mine", text.replace("int8", "int16"))
