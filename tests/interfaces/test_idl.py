"""IDL: what rosidl makes of ROS 2's definitions, and what people write."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fibws.errors import DefinitionError, UnknownType
from fibws.interfaces import Interfaces, parser
from fibws.interfaces.definition import Array, Field, MessageDefinition
from fibws.interfaces.idl import MOST_CONSTANTS, IdlFile, full_text

from .rosidl_idl import ANSWERS, DEFINITIONS, PACKAGE

RECORDED: dict[str, str] = json.loads(ANSWERS.read_text("utf-8"))


def message(text: str, name: str = "Thing") -> MessageDefinition:
    return IdlFile(f"module a_msgs {{ module msg {{ {text} }}; }};", "x.idl").messages()[
        f"a_msgs/{name}"
    ]


def thing(members: str) -> MessageDefinition:
    return message(f"struct Thing {{ {members} }};")


def parts(text: str, kind: str, name: str) -> tuple[MessageDefinition, ...]:
    """Return the messages of a file of ``.msg``, ``.srv`` or ``.action``."""
    match kind:
        case "msg":
            return (parser.parse_message(text, PACKAGE, name, ros2=True),)
        case "srv":
            service = parser.parse_service(text, PACKAGE, name, ros2=True)
            return service.request, service.response
    action = parser.parse_action(text, PACKAGE, name, ros2=True)
    return action.goal, action.result, action.feedback


def parts_of_idl(text: str, kind: str, name: str) -> tuple[MessageDefinition, ...]:
    found = IdlFile(text, "x.idl")
    match kind:
        case "msg":
            return (found.messages()[f"{PACKAGE}/{name}"],)
        case "srv":
            service = found.service(PACKAGE, name)
            assert service is not None
            return service.request, service.response
    action = found.action(PACKAGE, name)
    assert action is not None
    return action.goal, action.result, action.feedback


def content(found: MessageDefinition) -> tuple[object, ...]:
    """Return what matters: the spelling of a constant need not be the same."""
    constants = {(each.name, each.type, each.value) for each in found.constants}
    return found.type, found.fields, constants


def test_recorded_answers_are_those_of_the_definitions() -> None:
    assert RECORDED.keys() == DEFINITIONS.keys()


@pytest.mark.parametrize("path", DEFINITIONS)
def test_idl_of_rosidl_means_the_same_as_its_source(path: str) -> None:
    kind, _, name = path.partition("/")
    expected = parts(DEFINITIONS[path], kind, name)
    found = parts_of_idl(RECORDED[path], kind, name)
    assert list(map(content, found)) == list(map(content, expected))


def test_text_of_a_message_is_read_as_the_message() -> None:
    for path in ("msg/Arrays", "msg/Numbers", "msg/Constants"):
        name = path.removeprefix("msg/")
        (found,) = parts_of_idl(RECORDED[path], "msg", name)
        again = parser.parse_message(found.text, PACKAGE, name)
        assert [each.ros1_type for each in again.fields] == [
            each.ros1_type for each in found.fields
        ]
        assert [each.value for each in again.constants] == [each.value for each in found.constants]


def test_types_of_hand_written_idl() -> None:
    found = thing(
        "unsigned long long a; long long b; short c, d; int8 e; octet f; char g; "
        "sequence<string<10>> h; sequence<sensor_msgs::msg::Image, 4> i; a_msgs::Other j; "
        "string<3> k[2];"
    )
    assert [each.full_type for each in found.fields] == [
        *("uint64", "int64", "int16", "int16", "int8", "byte", "char", "string<=10[]"),
        *("sensor_msgs/Image[<=4]", "a_msgs/Other", "string<=3[2]"),
    ]


def test_typedefs_constants_and_enums_are_resolved() -> None:
    found = message("""
        const long SIZE = 0x4; const unsigned long MORE = SIZE;
        typedef double Row[SIZE]; typedef sequence<string<SIZE>, 2> Names;
        typedef Row Alias;
        enum Mode { OFF, ON, @value(7) SELF_TEST };
        struct Part { Mode mode; };
        module Thing_Constants { const Mode BEST = ON; const string HELLO = "a" "b\\"c"; };
        struct Thing {
            Alias row; Names names; @default(value=SELF_TEST) Mode mode; Part parts[MORE];
            @key @unit("m") @default(-1.5) float x; sequence<Mode> modes;
        };
    """)
    assert found.fields == (
        Field("row", "float64", Array(4)),
        Field("names", "string", Array(2, True), 4),
        Field("mode", "uint32", default=7),
        Field("parts", "a_msgs/Part", Array(4)),
        Field("x", "float32", default=-1.5),
        Field("modes", "uint32", Array()),
    )
    assert {each.name: each.value for each in found.constants} == {
        **{"BEST": 1, "HELLO": 'ab"c', "OFF": 0, "ON": 1, "SELF_TEST": 7}
    }


@pytest.mark.parametrize(
    ("members", "construct"),
    [
        ("union", "union"),
        ("long double x;", "long double"),
        ("wchar x;", "wchar"),
        ("any x;", "any"),
        ("fixed x;", "fixed"),
        ("map<string, long> x;", "map"),
        ("sequence<sequence<long>> x;", "sequence of sequences"),
        ("long x[2][3];", "array of arrays"),
        ("sequence<long> x[2];", "array of arrays"),
        ("@optional long x;", "@optional"),
        ("long x[1 + 1];", "expressions"),
        ("@default(value=1 << 2) long x;", "expressions"),
        ("unknown x;", "unknown is not a type"),
        ("a::b::c::d x;", "package::msg"),
        ("long x; long x;", "duplicate name x"),
        ("@default(value=300) uint8 x;", "300"),
        ('@default(value="no") long x;', "'no' is not a int32"),
        ("@default(value=1) a_msgs::Other x;", "cannot have a default"),
        ("long x", "expected ;"),
        ("long x[-1];", "a size must be"),
        ("long x[999999999999];", "a size must be"),
        ("string<TRUE> x;", "a size must be"),
        ("long $;", "'\\$'"),
        ("sequence<" * 5000, "sequence of sequences"),
        ("long x[" + "-" * 5000 + "1];", "expected a value"),
    ],
)
def test_what_cannot_be_read_is_named_with_its_line(members: str, construct: str) -> None:
    text = f"module a_msgs {{\n module msg {{\n struct Thing {{\n{members}\n}}; }}; }};"
    with pytest.raises(DefinitionError, match=construct) as caught:
        IdlFile(text, "x.idl")
    assert str(caught.value).startswith("x.idl")
    assert caught.value.line in (4, 5)


@pytest.mark.parametrize(
    ("text", "construct"),
    [
        ("struct A : B { long x; };", "inherits"),
        ("interface A { };", "interface"),
        ("union U switch(long) { case 1: long x; };", "union"),
        ("bitmask B { a };", "bitmask"),
        ("#define X 1\n", "#define"),
        ("#ifdef X\n", "#ifdef"),
        ("module a { struct B { long x; };", "expected"),
        ("module a " + "{ module a" * 5000, "nested too deeply"),
        ("const long X = Y;", "Y is not a constant"),
        ('const string X = "a\\nb";', "several lines"),
        ("/* no end", "got /"),
        ("struct B { long x; };", "package::msg"),
        ("enum E { A, A };", "duplicate name A"),
    ],
)
def test_declarations_that_cannot_be_read_are_named(text: str, construct: str) -> None:
    with pytest.raises(DefinitionError, match=construct):
        IdlFile(text, "x.idl")


def test_constants_of_enums_are_bounded() -> None:
    names = ", ".join(f"E{number}" for number in range(1000))
    structs = "".join(f"struct S{number} {{ E e; }};" for number in range(11))
    found = IdlFile(f"module a {{ enum E {{ {names} }}; {structs} }};", "x.idl")
    with pytest.raises(DefinitionError, match=str(MOST_CONSTANTS)):
        found.messages()


def test_schema_of_several_files_is_a_full_text() -> None:
    title = "=" * 80
    text = (
        "module a_msgs { module msg { struct Part { float x; }; }; };\n"
        f"{title}\nIDL: a_msgs/msg/Thing\n"
        "module a_msgs { module msg { struct Thing { Part part; string name; }; }; };\n"
    )
    assert full_text("a_msgs/Thing", text).splitlines() == [
        *("a_msgs/Part part", "string name", title, "MSG: a_msgs/Part", "float32 x"),
    ]
    with pytest.raises(DefinitionError, match="a_msgs/Other"):
        full_text("a_msgs/Other", text)


# Folders.


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for path, text in RECORDED.items():
        kind, _, name = path.partition("/")
        (tmp_path / PACKAGE / kind).mkdir(parents=True, exist_ok=True)
        (tmp_path / PACKAGE / kind / f"{name}.idl").write_text(text)
    return tmp_path


def test_folder_may_have_idl_files_alone(folder: Path) -> None:
    interfaces = Interfaces([folder])
    for kind in ("msg", "srv", "action"):
        names = {path.partition("/")[2] for path in DEFINITIONS if path.startswith(kind)}
        assert {f"{PACKAGE}/{name}" for name in names} <= {*interfaces.types(PACKAGE, kind)}
    assert interfaces.message(f"{PACKAGE}/Arrays").fields[4].type == f"{PACKAGE}/Numbers"
    assert interfaces.service(f"{PACKAGE}/srv/Water").response.fields[0].name == "done"
    assert interfaces.action(f"{PACKAGE}/Dig").goal.fields[0].default == 0.5
    assert interfaces.message(f"{PACKAGE}/DigGoal").fields[0].name == "depth"
    assert len(interfaces.md5(f"{PACKAGE}/Arrays")) == 32
    with pytest.raises(UnknownType):
        interfaces.message(f"{PACKAGE}/None")


def test_msg_file_counts_where_there_are_both(folder: Path) -> None:
    (folder / PACKAGE / "msg" / "Numbers.msg").write_text("int8 other\n")
    assert [each.name for each in Interfaces([folder]).message(f"{PACKAGE}/Numbers").fields] == [
        "other"
    ]


def test_files_may_include_others_and_hold_several_structs(tmp_path: Path) -> None:
    messages = tmp_path / "a_msgs" / "msg"
    messages.mkdir(parents=True)
    (messages / "Common.idl").write_text(
        "#ifndef COMMON_IDL\n#define COMMON_IDL\n#pragma once\n"
        "module a_msgs { module msg { typedef double Row[3]; struct Helper { Row row; }; }; };"
        "\n#endif  // COMMON_IDL\n"
    )
    (messages / "Thing.idl").write_text(
        '#include "a_msgs/msg/Common.idl"\n#include "Near.idl"\n#include <no_msgs/msg/None.idl>\n'
        "module a_msgs { module msg { struct Thing { Row row; Near near; Helper helper; }; }; };"
    )
    (messages / "Near.idl").write_text(
        "module a_msgs { module msg { enum Near { LEFT, RIGHT }; }; };"
    )
    (messages / "Bad.idl").write_text("union")
    interfaces = Interfaces([tmp_path])
    found = interfaces.message("a_msgs/Thing")
    assert [each.full_type for each in found.fields] == ["float64[3]", "uint32", "a_msgs/Helper"]
    assert interfaces.message("a_msgs/Helper").fields[0].full_type == "float64[3]"
    with pytest.raises(DefinitionError, match=r"Bad\.idl.*union"):
        interfaces.message("a_msgs/Bad")
