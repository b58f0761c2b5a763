"""The catalogue finds types by name, the user's before the standard ones, and learns new ones."""

from pathlib import Path

import pytest

from fibws.errors import (
    DefinitionError,
    InterfaceError,
    InvalidTypeName,
    UnknownPackage,
    UnknownType,
)
from fibws.interfaces import Interfaces
from fibws.interfaces.definition import Field


def write(folder: Path, **files: str) -> Path:
    """Write definitions into a folder: ``my_msgs__msg__Mine="int32 x"``."""
    for name, text in files.items():
        package, kind, short = name.split("__")
        path = folder / package / kind / f"{short}.{kind}"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    return folder


@pytest.mark.parametrize(
    ("name", "canonical"),
    [
        ("std_msgs/Int32", "std_msgs/Int32"),
        ("std_msgs/msg/Int32", "std_msgs/Int32"),
        ("std_srvs/srv/Empty", "std_srvs/Empty"),
        ("my_msgs/action/Count", "my_msgs/Count"),
    ],
)
def test_name_has_one_canonical_form(name: str, canonical: str) -> None:
    assert Interfaces.canonical(name) == canonical


@pytest.mark.parametrize(
    "name",
    [
        "",
        "Int32",
        "/std_msgs/Int32",
        "std_msgs/",
        "a/b/C",
        "std_msgs/Int32 ",
        "1/A",
        "a/" + "B" * 999,
    ],
)
def test_invalid_type_names_are_refused(name: str) -> None:
    with pytest.raises(InvalidTypeName, match="is not a valid type string") as caught:
        Interfaces().message(name)
    assert len(str(caught.value)) < 300


def test_standard_types_are_found_by_either_spelling() -> None:
    interfaces = Interfaces()
    assert interfaces.message("std_msgs/Int32").fields == (Field("data", "int32"),)
    assert interfaces.message("std_msgs/msg/Int32") is interfaces.message("std_msgs/Int32")
    service = interfaces.service("rospy_tutorials/AddTwoInts")
    assert service.response.fields == (Field("sum", "int64"),)
    assert service is interfaces.service("rospy_tutorials/srv/AddTwoInts")
    assert interfaces.action("actionlib_tutorials/Fibonacci").goal.fields[0].name == "order"


def test_every_standard_definition_is_valid() -> None:
    interfaces = Interfaces()
    for package in interfaces.packages():
        for name in interfaces.messages(package):
            assert interfaces.message(name).type == name
        for name in interfaces.services(package):
            assert interfaces.service(name).type == name
        for name in interfaces.actions(package):
            assert interfaces.action(name).type == name


def test_packages_list_their_types() -> None:
    interfaces = Interfaces()
    assert {"actionlib_msgs", "std_msgs", "turtlesim"} <= set(interfaces.packages())
    assert interfaces.packages() == sorted(interfaces.packages())
    assert interfaces.messages("turtlesim") == ["turtlesim/Color", "turtlesim/Pose"]
    assert interfaces.services("std_srvs") == [
        "std_srvs/Empty",
        "std_srvs/SetBool",
        "std_srvs/Trigger",
    ]
    assert interfaces.actions("example_interfaces") == ["example_interfaces/Fibonacci"]
    assert interfaces.actions("action_tutorials_interfaces") == [
        "action_tutorials_interfaces/Fibonacci"
    ]
    assert "example_interfaces/FibonacciActionGoal" in interfaces.messages("example_interfaces")


def test_unknown_package_lists_nothing() -> None:
    for listing in (Interfaces().messages, Interfaces().services, Interfaces().actions):
        with pytest.raises(UnknownPackage):
            listing("nobodys_msgs")


@pytest.mark.parametrize(
    ("wrong", "right"),
    [("std_msgs/Int23", "std_msgs/Int32"), ("std_msgs/string", "std_msgs/String")],
)
def test_unknown_type_has_a_suggestion(wrong: str, right: str) -> None:
    with pytest.raises(UnknownType, match=f"did you mean {right}\\?") as caught:
        Interfaces().message(wrong)
    assert caught.value.nearest == right


def test_unknown_type_without_similar_ones_has_no_suggestion() -> None:
    with pytest.raises(UnknownType, match="no such msg in turtlesim"):
        Interfaces().message("turtlesim/Xyzzy")
    with pytest.raises(UnknownType, match="did you mean std_srvs/SetBool"):
        Interfaces().service("std_srvs/SetBol")
    with pytest.raises(UnknownType, match="no such action in std_srvs"):
        Interfaces().action("std_srvs/Empty")


def test_unknown_package_is_another_error() -> None:
    with pytest.raises(UnknownPackage, match="package nobodys_msgs"):
        Interfaces().message("nobodys_msgs/Mine")


def test_folder_of_packages_adds_to_the_standard_ones(tmp_path: Path) -> None:
    write(tmp_path, my_msgs__msg__Mine="std_msgs/Int32 number", my_msgs__srv__Ask="---\nMine mine")
    write(tmp_path, **{"no-package__msg__Mine": "", "my_msgs__msg__no-type": ""})
    (tmp_path / "README").touch()
    interfaces = Interfaces([tmp_path])
    assert interfaces.message("my_msgs/Mine").fields[0].type == "std_msgs/Int32"
    assert interfaces.service("my_msgs/Ask").response.fields[0].type == "my_msgs/Mine"
    assert interfaces.messages("my_msgs") == ["my_msgs/Mine"]
    assert "no-package" not in interfaces.packages()
    assert interfaces.is_users("my_msgs")
    assert not interfaces.is_users("std_msgs")
    assert not interfaces.is_users("nobodys_msgs")


def test_folder_may_be_one_package(tmp_path: Path) -> None:
    write(tmp_path, my_msgs__action__Count="int32 to\n---\n---\n")
    interfaces = Interfaces([tmp_path / "my_msgs"])
    assert interfaces.message("my_msgs/CountGoal").fields == (Field("to", "int32"),)


def test_users_types_hide_the_standard_ones_one_by_one(tmp_path: Path) -> None:
    write(tmp_path, std_msgs__msg__Int32="int64 data")
    interfaces = Interfaces()
    assert not interfaces.is_users("std_msgs")
    assert interfaces.message("std_msgs/Int32").fields[0].type == "int32"
    interfaces.add_folder(tmp_path)
    interfaces.add_folder(tmp_path)
    assert interfaces.is_users("std_msgs")
    assert interfaces.message("std_msgs/Int32").fields[0].type == "int64"
    assert interfaces.messages("std_msgs") == Interfaces().messages("std_msgs")
    assert interfaces.message("std_msgs/Header").fields[0].name == "seq"


def test_last_of_the_users_packages_of_one_name_counts(tmp_path: Path) -> None:
    write(tmp_path / "a", my_msgs__msg__One="int8 x", my_msgs__msg__Two="int8 x")
    write(tmp_path / "b", my_msgs__msg__One="int16 x")
    interfaces = Interfaces([tmp_path / "a", tmp_path / "b"])
    assert interfaces.messages("my_msgs") == ["my_msgs/One"]
    assert interfaces.message("my_msgs/One").fields[0].type == "int16"


def test_users_message_hides_the_one_that_is_made_of_a_standard_action(tmp_path: Path) -> None:
    write(tmp_path, actionlib_tutorials__msg__FibonacciGoal="int64 order")
    interfaces = Interfaces([tmp_path])
    assert interfaces.message("actionlib_tutorials/FibonacciGoal").fields[0].type == "int64"
    assert interfaces.message("actionlib_tutorials/AveragingGoal").fields[0].type == "int32"


@pytest.mark.parametrize(
    ("manifest", "value"),
    [
        ("<package format='3'><build_depend>rosidl_default_generators</build_depend>", "abc"),
        ("<package format='3'><build_depend>message_generation</build_depend>", '"abc"'),
        (None, '"abc"'),
    ],
)
def test_package_tells_whether_its_files_are_of_ros_2(
    tmp_path: Path, manifest: str | None, value: str
) -> None:
    line = 'string X="abc"'
    write(tmp_path, my_msgs__msg__Mine=line, my_msgs__srv__Ask=f"{line}\n---\n")
    write(tmp_path, my_msgs__action__Do=f"{line}\n---\n---\n")
    if manifest is not None:
        (tmp_path / "my_msgs" / "package.xml").write_text(manifest)
    interfaces = Interfaces([tmp_path])
    for definition in (
        interfaces.message("my_msgs/Mine"),
        interfaces.service("my_msgs/Ask").request,
        interfaces.action("my_msgs/Do").goal,
    ):
        assert definition.constants[0].value == value


def test_missing_folder_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InterfaceError, match="not found"):
        Interfaces([tmp_path / "nowhere"])


def test_comment_in_latin_1_is_accepted(tmp_path: Path) -> None:
    write(tmp_path, my_msgs__msg__Mine="")
    (tmp_path / "my_msgs/msg/Mine.msg").write_bytes("int32 x # \xb5m".encode("latin-1"))
    assert Interfaces([tmp_path]).message("my_msgs/Mine").fields == (Field("x", "int32"),)


def test_missing_nested_type_is_reported_with_its_file(tmp_path: Path) -> None:
    write(tmp_path, my_msgs__msg__Mine="int32 x\nstd_msgs/Int23[] y", my_msgs__msg__Its="No no")
    interfaces = Interfaces([tmp_path])
    with pytest.raises(DefinitionError, match="did you mean std_msgs/Int32") as caught:
        interfaces.message("my_msgs/Mine")
    assert caught.value.source == str(tmp_path / "my_msgs/msg/Mine.msg")
    assert (caught.value.line, caught.value.text) == (2, "std_msgs/Int23[] y")
    with pytest.raises(DefinitionError, match="unknown type No: "):
        interfaces.message("my_msgs/Its")


def test_missing_type_in_a_request_is_reported(tmp_path: Path) -> None:
    write(tmp_path, my_msgs__srv__Ask="\n---\nnobodys_msgs/Mine x")
    with pytest.raises(DefinitionError, match=r"line 3: .*package nobodys_msgs"):
        Interfaces([tmp_path]).service("my_msgs/Ask")


def test_type_cannot_hold_itself(tmp_path: Path) -> None:
    write(tmp_path, my_msgs__msg__A="B b", my_msgs__msg__B="int8 x\nA[] a")
    with pytest.raises(DefinitionError, match="my_msgs/A contains itself") as caught:
        Interfaces([tmp_path]).message("my_msgs/A")
    assert caught.value.source.endswith("B.msg")


def test_depth_of_nested_types_is_limited(tmp_path: Path) -> None:
    for number in range(60):
        write(tmp_path, **{f"my_msgs__msg__T{number}": f"T{number + 1} x"})
    write(tmp_path, my_msgs__msg__T60="int32 x")
    with pytest.raises(DefinitionError, match=r"too deeply .*50"):
        Interfaces([tmp_path]).message("my_msgs/T0")


@pytest.mark.parametrize("array", ["[100]", ""])
def test_huge_fixed_array_is_refused(tmp_path: Path, array: str) -> None:
    for number in range(40):
        text = f"T{number + 1}{array} x\nT{number + 1}{array} y"
        write(tmp_path, **{f"my_msgs__msg__T{number}": text})
    write(tmp_path, my_msgs__msg__T40="int32 x")
    with pytest.raises(DefinitionError, match="the message becomes too large"):
        Interfaces([tmp_path]).message("my_msgs/T0")


def test_byte_order_mark_is_ignored(tmp_path: Path) -> None:
    write(tmp_path, my_msgs__msg__Mine="\ufeffint32 x\r\n")
    assert Interfaces([tmp_path]).message("my_msgs/Mine").fields == (Field("x", "int32"),)


def test_types_with_floats_are_known() -> None:
    interfaces = Interfaces()
    found = {
        name: interfaces.has_floats(interfaces.message(name))
        for name in ("std_msgs/Int32", "std_msgs/Header", "std_msgs/Float32", "nav_msgs/Path")
    }
    assert list(found.values()) == [False, False, True, True]
    assert not interfaces.has_floats(interfaces.service("rospy_tutorials/AddTwoInts").request)


@pytest.mark.parametrize(
    ("field", "unknown", "meant"),
    [
        ("flaot32 x", "type flaot32", "float32"),
        ("Flot64[3] x", "type Flot64", "float64"),
        ("Twist x", "type Twist", "geometry_msgs/Twist"),
        ("geometry_msgs/Image x", "type geometry_msgs/Image", "sensor_msgs/Image"),
        ("geometry_msg/Twist x", "package geometry_msg", "geometry_msgs"),
        ("new_msgs/Twist x", "package new_msgs", None),
        ("Nothing x", "type Nothing", None),
    ],
)
def test_unknown_type_of_a_field_gets_a_suggestion(
    tmp_path: Path, field: str, unknown: str, meant: str | None
) -> None:
    file = tmp_path / "robot" / "msg" / "State.msg"
    file.parent.mkdir(parents=True)
    file.write_text(f"int32 first\n{field}\n")
    with pytest.raises(DefinitionError) as caught:
        Interfaces([tmp_path]).message("robot/State")
    text = str(caught.value)
    assert f"{file}, line 2: unknown {unknown}" in text and repr(field) in text
    assert (f"did you mean {meant}?" in text) if meant else ("did you mean" not in text)
