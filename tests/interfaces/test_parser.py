"""The parser accepts what genmsg and rosidl accept, and reports errors with line and reason."""

import pytest

from fibws.errors import DefinitionError
from fibws.interfaces.definition import Array, Constant, Field, MessageDefinition
from fibws.interfaces.parser import (
    parse_action,
    parse_message,
    parse_service,
)


def parse(text: str) -> MessageDefinition:
    return parse_message(text, "my_msgs", "Mine", "Mine.msg")


@pytest.mark.parametrize(
    ("line", "field"),
    [
        ("int32 data", Field("data", "int32")),
        ("  int32\tdata  # the number", Field("data", "int32")),
        ("int32 data\r", Field("data", "int32")),
        ("byte b", Field("b", "byte")),
        ("time stamp", Field("stamp", "time")),
        ("float32[] ranges", Field("ranges", "float32", Array())),
        ("float64[36] covariance", Field("covariance", "float64", Array(36))),
        ("int8[<=3] few", Field("few", "int8", Array(3, bounded=True))),
        ("string<=10 name", Field("name", "string", limit=10)),
        ("string<=10[<=5] names", Field("names", "string", Array(5, bounded=True), limit=10)),
        ("wstring name", Field("name", "wstring")),
        ("Header header", Field("header", "std_msgs/Header")),
        ("Other other", Field("other", "my_msgs/Other")),
        ("std_msgs/Int32 number", Field("number", "std_msgs/Int32")),
        ("std_msgs/msg/Int32[] numbers", Field("numbers", "std_msgs/Int32", Array())),
        ("builtin_interfaces/Time stamp", Field("stamp", "time")),
        ("builtin_interfaces/msg/Duration span", Field("span", "duration")),
        ("int32 x 5", Field("x", "int32", default=5)),
        ("uint8 x 0x10", Field("x", "uint8", default=16)),
        ("bool x true", Field("x", "bool", default=True)),
        ("float64 x 1.5 # half", Field("x", "float64", default=1.5)),
        ('string x "a # b"', Field("x", "string", default="a # b")),
        ("string x 'it'", Field("x", "string", default="it")),
        ("string x plain", Field("x", "string", default="plain")),
        ("int32[] x [1, -2]", Field("x", "int32", Array(), default=(1, -2))),
        ('string[<=2] x ["a"]', Field("x", "string", Array(2, bounded=True), default=("a",))),
        ("bool[2] x [true, false]", Field("x", "bool", Array(2), default=(True, False))),
    ],
)
def test_line_declares_a_field(line: str, field: Field) -> None:
    assert parse(line).fields == (field,)


@pytest.mark.parametrize(
    ("line", "constant"),
    [
        ("int32 X=5", Constant("X", "int32", 5, "5")),
        ("uint8 X = 007 # agent", Constant("X", "uint8", 7, "007")),
        ("byte X=-1", Constant("X", "byte", -1, "-1")),
        ("bool X=True", Constant("X", "bool", True, "True")),
        ("float32 X=1.5", Constant("X", "float32", 1.5, "1.5")),
        ("string X=  a # b  ", Constant("X", "string", "a # b", "a # b")),
        ("string X=it's", Constant("X", "string", "it's", "it's")),
        ("string X=", Constant("X", "string", "", "")),
        ("wstring<=3 X=a", Constant("X", "string", "a", "a")),
        ("int64 X=-0x1F", Constant("X", "int64", -31, "-31")),
        ("int64 X=1_000 # many", Constant("X", "int64", 1000, "1000")),
        ("bool X=true", Constant("X", "bool", True, "True")),
    ],
)
def test_line_declares_a_constant(line: str, constant: Constant) -> None:
    assert parse(line).constants == (constant,)


def test_empty_lines_and_comments_declare_nothing() -> None:
    definition = parse('\n  # it\'s "nothing"\n\r\n')
    assert not definition.fields
    assert not definition.constants


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("int32", "expected a field"),
        ("int32 x y z", "'y z' is not a int32"),
        ("int32 x; int32 y", "expected a field"),
        ('string x "open', "expected a field"),
        ("int32 9x", "invalid name 9x"),
        ("int32 _x", "invalid name _x"),
        ("int32 _X=5", "invalid name _X"),
        ("a/b/c x", "a/b/c is not a type"),
        ("int32<=5 x", "only strings can be bounded"),
        ("int32[<=] x", "bound of the array is missing"),
        ("int32[9999999999] x", "expected a field"),
        ("int32 X=five", "'five' is not a int32"),
        ("uint8 X=256", "256 is not in 0..255"),
        ("int8 X=\u0663", "'\u0663' is not a int8"),
        ("int8 X=3\x1c", "is not a int8"),
        ("int8 x\x1c", "expected a field"),
        ("\u0085", "expected a field"),
        ("int8[003] x", "expected a field"),
        ("float32 X=nan", "a constant must be finite, such as float32 X=1.5, got nan"),
        ("float64 X=-Infinity", "finite, such as float64 X=1.5, got -Infinity"),
        ("int8<=3 X=1", "only strings can be bounded"),
        ("float32 X=one", "'one' is not a float32"),
        ("bool X=2", "'2' is not a bool"),
        ("time X=5", "a constant cannot be of type time"),
        ("Other X=5", "a constant cannot be of type Other"),
        ("time x 5", "time cannot have a default"),
        ("int32[] x 5", "must be in brackets"),
        ("int32[] x [1", "must be in brackets"),
        ("string[] x ['a]", "expected a field"),
        ("string[] x ['a' b]", "expected strings with commas between them"),
        ("string x 'a' b'", "expected a field"),
        ("int32[2] x [1]", "default of int32[2] has 1 elements"),
        ("int32[<=2] x [1, 2, 3]", "default of int32[<=2] has 3 elements"),
        ("int32[] x ['1']", "is not a int32"),
        ("string<=2 x abc", "more than 2 characters"),
        ('string<=2[] x ["abc"]', "more than 2 characters"),
    ],
)
def test_error_names_file_line_text_and_reason(line: str, fault: str) -> None:
    with pytest.raises(DefinitionError) as caught:
        parse(f"# first\n{line}\n")
    assert (caught.value.source, caught.value.line, caught.value.text) == ("Mine.msg", 2, line)
    assert fault in caught.value.fault


@pytest.mark.parametrize("text", ["int32 x\nint32 x", "int32 x\nint32 x=1", "int8 x=1\nint8 x=1"])
def test_two_members_cannot_share_a_name(text: str) -> None:
    with pytest.raises(DefinitionError, match="line 2: duplicate name x"):
        parse(text)


def test_text_is_normalized_to_ros_1_syntax() -> None:
    ours = "# hello\nstd_msgs/Int32 a # one\nint32 X = 5\n"
    assert parse(ours).text == ours
    ros_2 = "# hello\nstd_msgs/msg/Int32[<=3] a # one\nwstring<=4 b\nint32 c 5\nint32 D=5"
    assert parse(ros_2).text == "# hello\nstd_msgs/Int32[] a\nstring b\nint32 c\nint32 D=5"
    assert parse("builtin_interfaces/Time t").text == "time t"
    assert parse("wstring<=9 W= a # b\nuint8 X=0x10 # c").text == "string W=a # b\nuint8 X=16"
    assert parse("bool B = false\nint64 X=0_0").text == "bool B=False\nint64 X=0"


def test_service_has_a_request_and_a_response() -> None:
    service = parse_service("int64 a\n---\nint64 sum\n", "my_msgs", "Add")
    assert (service.type, service.request.type) == ("my_msgs/Add", "my_msgs/AddRequest")
    assert service.response.fields == (Field("sum", "int64"),)


def test_action_has_three_parts_and_seven_messages() -> None:
    action = parse_action("int32 order\n---\n---\nint32[] sequence", "my_msgs", "Count")
    assert action.type == "my_msgs/Count"
    assert [message.name for message in action.messages()] == [
        "CountAction",
        "CountActionGoal",
        "CountActionResult",
        "CountActionFeedback",
        "CountGoal",
        "CountResult",
        "CountFeedback",
    ]
    assert action.messages()[1].fields[2] == Field("goal", "my_msgs/CountGoal")
    assert action.messages()[1].has_header


@pytest.mark.parametrize(
    ("text", "line", "fault"),
    [
        ("int64 a\n", 1, "1 line of ---, got 0"),
        ("int64 a\n--\nint8 b", 2, "1 line of ---, got 0: '--'"),
        ("int64 a\n ---\nint8 b", 2, "1 line of ---, got 0: '---'"),
        ("---\n---\nint8 x", 2, "1 line of ---, got 2"),
        ("int64 a\n---\nint64", 3, "expected a field"),
    ],
)
def test_error_in_a_service_names_the_line_of_the_file(text: str, line: int, fault: str) -> None:
    with pytest.raises(DefinitionError, match=fault) as caught:
        parse_service(text, "my_msgs", "Add")
    assert (caught.value.line, caught.value.source) == (line, "my_msgs/Add")


def test_action_with_two_parts_is_refused() -> None:
    with pytest.raises(DefinitionError, match="2 lines of ---, got 1"):
        parse_action("---", "my_msgs", "Count")
