"""Full texts of definitions: the same as genmsg's, and readable again."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.errors import DefinitionError
from fibws.interfaces import Interfaces
from fibws.interfaces.client_definitions import ClientDefinitions
from fibws.interfaces.definition import Field
from fibws.interfaces.full_text import read_action, read_message, read_service

SEPARATOR = "=" * 80
STANDARD = Interfaces()


def types(kind: str) -> list[str]:
    listing = {"msg": STANDARD.messages, "srv": STANDARD.services, "action": STANDARD.actions}[kind]
    return [name for package in STANDARD.packages() for name in listing(package)]


def test_full_text_has_each_nested_type_once_depth_first() -> None:
    parts = STANDARD.full_text("geometry_msgs/PoseStamped").split(f"\n{SEPARATOR}\n")
    assert [part.partition("\n")[0] for part in parts] == [
        "Header header",
        "MSG: std_msgs/Header",
        "MSG: geometry_msgs/Pose",
        "MSG: geometry_msgs/Point",
        "MSG: geometry_msgs/Quaternion",
    ]
    assert parts[1] == "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"


def test_full_text_of_a_flat_type_is_its_text() -> None:
    assert STANDARD.full_text("std_msgs/Int32") == "int32 data\n"
    assert STANDARD.service_text("rospy_tutorials/AddTwoInts") == (
        "int64 a\nint64 b\n---\nint64 sum\n"
    )
    assert STANDARD.service_text("std_srvs/Empty") == "---\n"
    assert STANDARD.action_text("actionlib/TwoInts") == "int64 a\nint64 b\n---\nint64 sum\n---\n"


def test_types_of_equal_short_names_are_distinguished() -> None:
    own = " Pose[2] a # Pose b\nPose b\ngeometry_msgs/Pose c\nString d"
    nested = [f"{SEPARATOR}\nMSG: my_msgs/{name}\nint8 x" for name in ("Pose", "String")]
    brought = "\n".join([own, *nested])
    definition = ClientDefinitions(STANDARD).read("msg", "my_msgs/Poses", brought, "/client")
    assert definition is not None
    text = definition.full_text("my_msgs/Poses")
    assert text.split(f"\n{SEPARATOR}\n")[0] == (
        " my_msgs/Pose[2] a # Pose b\nmy_msgs/Pose b\ngeometry_msgs/Pose c\nString d"
    )


def test_full_text_of_a_service_has_the_types_of_both_sides(tmp_path: Path) -> None:
    folder = tmp_path / "my_msgs"
    (folder / "msg").mkdir(parents=True)
    (folder / "srv").mkdir()
    (folder / "msg" / "Mine.msg").write_text("int32 x")
    (folder / "srv" / "Ask.srv").write_text("# both\nMine mine\n---\ntime t\nMine[<=3] all\n")
    text = Interfaces([tmp_path]).service_text("my_msgs/Ask")
    own, nested = text.split(f"\n{SEPARATOR}\n")
    assert own == "# both\nMine mine\n---\ntime t\nmy_msgs/Mine[] all\n"
    assert nested == "MSG: my_msgs/Mine\nint32 x"


def test_every_standard_message_is_read_back() -> None:
    for name in types("msg"):
        read = read_message(STANDARD.full_text(name), name)
        assert read == {type_: STANDARD.message(type_) for type_ in read}, name
        assert next(iter(read)) == name


def test_every_standard_service_is_read_back() -> None:
    for name in types("srv"):
        service, nested = read_service(STANDARD.service_text(name), name)
        assert service == STANDARD.service(name), name
        assert nested == {type_: STANDARD.message(type_) for type_ in nested}, name


def test_every_standard_action_is_read_back() -> None:
    for name in types("action"):
        action, nested = read_action(STANDARD.action_text(name), name)
        assert action == STANDARD.action(name), name
        assert nested == {type_: STANDARD.message(type_) for type_ in nested}, name


def test_full_text_holds_several_messages() -> None:
    text = f"Inner inner\n{SEPARATOR}\nMSG: my_msgs/msg/Inner\nint32 x\n"
    outer, inner = read_message(text, "my_msgs/Outer").values()
    assert outer.fields == (Field("inner", "my_msgs/Inner"),)
    assert (inner.type, inner.fields) == ("my_msgs/Inner", (Field("x", "int32"),))


@pytest.mark.parametrize(("end", "line"), [("", 3), ("\nint32 x", 3), ("\nMSG: x\nint32 y", 3)])
def test_each_part_of_a_full_text_names_its_type(end: str, line: int) -> None:
    with pytest.raises(DefinitionError, match="expected MSG: package/Type") as caught:
        read_message(f"int32 a\n{SEPARATOR}{end}", "my_msgs/Outer")
    assert caught.value.line == line


def test_error_names_the_line_of_the_whole_text() -> None:
    text = f"Inner inner\n---\n{SEPARATOR}\nMSG: my_msgs/Inner\nint32"
    with pytest.raises(DefinitionError, match="the definition of my_msgs/Ask, line 5: "):
        read_service(text, "my_msgs/Ask")
    with pytest.raises(
        DefinitionError, match="the definition of my_msgs/Go, line 1: expected 2 lines of"
    ):
        read_action("int32 x", "my_msgs/Go")
