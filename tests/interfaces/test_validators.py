"""How JSON becomes a message: each row of the table that the real server was seen to keep."""

import json
import struct
import tracemalloc
from base64 import b64encode
from math import inf, isnan, nan
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic_core import from_json, to_json

from fibws.errors import InvalidMessage, UnknownType
from fibws.interfaces import Interfaces, Validators
from fibws.interfaces.client_definitions import ClientDefinitions
from fibws.interfaces.parser import parse_message
from fibws.interfaces.validators import MOST_MISSING

NOW = {"secs": 1_700_000_000, "nsecs": 123_456_789}
ZERO = {"secs": 0, "nsecs": 0}
LAYOUT = {"dim": [], "data_offset": 0}

VALIDATORS = Validators(Interfaces(), lambda: 1_700_000_000_123_456_789)


def validate(name: str, msg: object) -> dict[str, Any]:
    return VALIDATORS.of(name).validate(msg)


def fault(name: str, msg: object) -> str:
    """Return the error text of an invalid message."""
    with pytest.raises(InvalidMessage) as caught:
        validate(name, msg)
    return str(caught.value)


def validate_as(line: str, msg: object) -> Any:
    """The value of the one field that ``line`` declares."""
    definition = parse_message(line, "my_msgs", "Mine")
    return VALIDATORS.of_definition(definition).validate(msg)[definition.fields[0].name]


@pytest.mark.parametrize(
    ("name", "given", "data"),
    [
        ("std_msgs/Int32", 5, 5),
        ("std_msgs/Int64", -(2**63), -(2**63)),
        ("std_msgs/UInt64", 2**64 - 1, 2**64 - 1),
        ("std_msgs/Byte", -1, -1),
        ("std_msgs/Char", 255, 255),
        ("std_msgs/Float64", 3, 3.0),
        ("std_msgs/Float64", 0.1, 0.1),
        ("std_msgs/Float64", inf, inf),
        ("std_msgs/Float32", 0.1, 0.10000000149011612),
        ("std_msgs/Float32", 3, 3.0),
        ("std_msgs/Float32", -inf, -inf),
        ("std_msgs/Bool", True, True),
        ("std_msgs/String", "grüße", "grüße"),
        ("std_msgs/Time", {"secs": 5, "nsecs": 7}, {"secs": 5, "nsecs": 7}),
        ("std_msgs/Time", {"sec": 5, "nanosec": 7}, {"secs": 5, "nsecs": 7}),
        ("std_msgs/Time", {"sec": 5, "nsec": 7}, {"secs": 5, "nsecs": 7}),
        ("std_msgs/Time", {"secs": 5, "nsecs": 7, "else": []}, {"secs": 5, "nsecs": 7}),
        ("std_msgs/Time", {"nsecs": 7}, {"secs": 0, "nsecs": 7}),
        ("std_msgs/Time", {}, ZERO),
        ("std_msgs/Time", "now", NOW),
        ("std_msgs/Duration", {"secs": -5}, {"secs": -5, "nsecs": 0}),
    ],
)
def test_valid_value_is_accepted(name: str, given: object, data: object) -> None:
    assert validate(name, {"data": given}) == {"data": data}


@pytest.mark.parametrize(
    ("name", "given", "wanted", "found"),
    [
        ("Int32", 1.5, "int32", "float"),
        ("Int32", 2.0, "int32", "float"),
        ("Int32", True, "int32", "bool"),
        ("Int32", "5", "int32", "str"),
        ("Int32", None, "int32", "NoneType"),
        ("UInt8", 256, "uint8", "int (256 is not in 0..255)"),
        ("UInt8", -1, "uint8", "int (-1 is not in 0..255)"),
        ("Int64", 2**63, "int64", f"int ({2**63} is not in {-(2**63)}..{2**63 - 1})"),
        pytest.param("Int8", 10**5000, "int8", "int (this integer is not in -128..127)", id="huge"),
        ("Float64", "3", "float64", "str"),
        ("Float64", True, "float64", "bool"),
        ("Float64", 10**400, "float64", "int (it is too large)"),
        ("Float32", "3", "float32", "str"),
        ("Float32", 1e39, "float32", "float (1e+39 does not fit a float32)"),
        ("Bool", 1, "bool", "int"),
        ("String", 5, "string", "int"),
        ("String", b"5", "string", "bytes"),
        ("String", "\ud800", "string", "str (it contains a lone surrogate)"),
        ("Time", "then", "time", "str"),
        ("Time", 5, "time", "int"),
        ("Duration", "now", "duration", "str"),
    ],
)
def test_invalid_value_is_refused(name: str, given: object, wanted: str, found: str) -> None:
    assert fault(f"std_msgs/{name}", {"data": given}) == (
        f"std_msgs/{name} message requires {with_article(wanted)} for field data, "
        f"but got {with_article(found)}"
    )


def with_article(noun: str) -> str:
    return f"an {noun}" if noun.startswith("int") else f"a {noun}"


@pytest.mark.parametrize("name", ["std_msgs/Float32", "std_msgs/Float64"])
def test_null_is_nan_and_nan_is_null(name: str) -> None:
    for data in (None, nan):
        assert to_json(validate(name, {"data": data}), inf_nan_mode="null") == b'{"data":null}'


def test_null_in_an_array_is_nan_too() -> None:
    for name in ("std_msgs/Float32MultiArray", "std_msgs/Float64MultiArray"):
        data = validate(name, {"data": [None, nan, inf, 1]})["data"]
        assert to_json(data, inf_nan_mode="null") == b"[null,null,null,1.0]"


def test_names_of_nan_and_infinity_are_accepted() -> None:
    msg = from_json(b'{"data":[NaN,Infinity,-Infinity,1e400]}')
    data = validate("std_msgs/Float64MultiArray", msg)["data"]
    assert isnan(data[0])
    assert data[1:] == [inf, -inf, inf]


def test_arrays_of_float32_are_rounded_as_a_whole() -> None:
    data = validate("std_msgs/Float32MultiArray", {"data": [0.1, None, 2, inf]})["data"]
    assert data[0] == 0.10000000149011612
    assert isnan(data[1])
    assert data[2:] == [2.0, inf]
    assert "but got a list (1e+39 does not fit a float32)" in fault(
        "std_msgs/Float32MultiArray", {"data": [None, 1e39]}
    )


@pytest.mark.parametrize("msg", [None, 5, "{}", [], [{}]])
def test_message_must_be_an_object(msg: object) -> None:
    assert fault("std_msgs/Int32", msg) == (
        f"Expected a JSON object for type std_msgs/Int32 but received a {type(msg).__name__}"
    )


@pytest.mark.parametrize(
    ("name", "msg", "path"),
    [
        ("std_msgs/Int32", {"data": 1, "bogus": 2}, "bogus"),
        ("std_msgs/Int32", {"#whole": 2}, "#whole"),
        ("std_msgs/Int32", {5: 2}, "5"),
        ("geometry_msgs/Twist", {"linear": {"w": 1}}, "linear.w"),
        ("sensor_msgs/PointCloud", {"points": [{}, {"w": 1}]}, "points[1].w"),
        ("sensor_msgs/PointCloud", {"points": [{5: 1}]}, "points[0].5"),
        ("std_msgs/Int32", {"x" * 10_000: 2}, "x" * 200),
    ],
)
def test_unknown_field_is_named(name: str, msg: object, path: str) -> None:
    assert fault(name, msg) == f"Message type {name} does not have a field {path}"


@pytest.mark.parametrize(
    ("name", "msg", "meant"),
    [
        ("std_msgs/String", {"dta": "x"}, "data"),
        ("geometry_msgs/Twist", {"liner": {}}, "linear"),
        ("geometry_msgs/PoseStamped", {"pose": {"positon": {}}}, "position"),
        ("nav_msgs/Path", {"poses": [{}, {"heder": {}}]}, "header"),
    ],
)
def test_misspelled_field_gets_a_suggestion(name: str, msg: object, meant: str) -> None:
    assert fault(name, msg).endswith(f"; did you mean {meant}?")


@pytest.mark.parametrize(
    ("name", "msg", "text"),
    [
        (
            "geometry_msgs/Twist",
            {"linear": 5},
            "a geometry_msgs/Vector3 for field linear, but got an int",
        ),
        (
            "geometry_msgs/Twist",
            {"linear": {"x": "3"}},
            "a float64 for field linear.x, but got a str",
        ),
        (
            "sensor_msgs/PointCloud",
            {"points": [{}, {}, {"x": []}]},
            "a float32 for field points[2].x, but got a list",
        ),
        (
            "sensor_msgs/PointCloud",
            {"points": [{}, 5]},
            "a geometry_msgs/Point32 for field points[1], but got an int",
        ),
        (
            "sensor_msgs/PointCloud",
            {"points": {}},
            "a geometry_msgs/Point32[] for field points, but got a dict",
        ),
        (
            "geometry_msgs/PoseWithCovariance",
            {"covariance": [0]},
            "a float64[36] for field covariance, but got a list (it has 1 elements, not 36)",
        ),
        (
            "std_msgs/Header",
            {"stamp": {"secs": -1}},
            "a uint32 for field stamp.secs, but got an int (-1 is not in 0..4294967295)",
        ),
        (
            "actionlib_msgs/GoalID",
            {"stamp": {"nsec": 1.5}},
            "a uint32 for field stamp.nsec, but got a float",
        ),
    ],
)
def test_error_names_the_path_of_its_field(name: str, msg: object, text: str) -> None:
    assert fault(name, msg) == f"{name} message requires {text}"


def test_many_errors_are_only_counted() -> None:
    msg = {str(number): None for number in range(2000)}
    assert fault("std_msgs/Int32", msg) == (
        "Message type std_msgs/Int32 does not fit in 2000 places"
    )
    assert "data[0]" in fault("std_msgs/Int32MultiArray", {"data": [None] * 2000})


@pytest.mark.parametrize(
    ("line", "given", "data"),
    [
        ("uint8[] x", "AQID", "AQID"),
        ("uint8[] x", [1, 2, 3], "AQID"),
        ("uint8[] x", b"\1\2\3", "AQID"),
        ("uint8[] x", bytearray(b"\1\2\3"), "AQID"),
        ("uint8[] x", "", ""),
        ("uint8[] x", [], ""),
        ("uint8[] x", "QR==", "QQ=="),
        ("char[] x", [255], "/w=="),
        ("uint8[3] x", "AQID", "AQID"),
        ("uint8[<=3] x", [1], "AQ=="),
        ("int8[] x", [1, -2], [1, -2]),
        ("byte[] x", [1, -2], [1, -2]),
        ("int32[<=3] x", [1], [1]),
        ("string<=3 x", "abc", "abc"),
        ("string<=3[] x", ["abc"], ["abc"]),
        ("wstring x", "abc", "abc"),
        ("time[] x", ["now", {}], [NOW, ZERO]),
        ("time[] x", [None, "now"], [ZERO, NOW]),
    ],
)
def test_arrays_within_their_bounds_are_accepted(line: str, given: object, data: object) -> None:
    assert validate_as(line, {"x": given}) == data


@pytest.mark.parametrize(
    ("line", "given", "text"),
    [
        ("uint8[] x", "A", "uint8[] for field x, but got a str (bad base64: "),
        ("uint8[] x", "AQI D", "but got a str (bad base64: "),
        ("uint8[] x", "AQ", "but got a str (bad base64: "),
        ("uint8[] x", "é", "but got a str (bad base64: "),
        ("uint8[] x", [256], "uint8 for field x[0], but got an int (256 is not in 0..255)"),
        ("uint8[] x", [True], "uint8 for field x[0], but got a bool"),
        ("uint8[] x", 5, "uint8[] for field x, but got an int"),
        ("uint8[3] x", "AQ==", "uint8[3] for field x, but got a str (it has 1 elements, not 3)"),
        ("uint8[3] x", [1] * 4, "but got a list (it has 4 elements, not 3)"),
        ("uint8[<=3] x", [1] * 4, "but got a list (it has 4 elements, not at most 3)"),
        ("int8[<=3] x", [1] * 4, "but got a list (it has 4 elements, not at most 3)"),
        ("int8[3] x", [1] * 4, "but got a list (it has 4 elements, not 3)"),
        ("int8[] x", "AQID", "int8[] for field x, but got a str"),
        ("string<=3 x", "abcd", "string<=3 for field x, but got a str (it has 4 characters, not "),
        ("time[] x", [5], "time for field x[0], but got an int"),
    ],
)
def test_arrays_outside_their_bounds_are_refused(line: str, given: object, text: str) -> None:
    with pytest.raises(InvalidMessage) as caught:
        validate_as(line, {"x": given})
    assert text in str(caught.value)


@pytest.mark.parametrize(
    ("line", "data"),
    [
        ("int32 x", 0),
        ("float32 x", 0.0),
        ("bool x", False),
        ("string x", ""),
        ("time x", ZERO),
        ("duration x", ZERO),
        ("int32[] x", []),
        ("int32[3] x", [0, 0, 0]),
        ("bool[2] x", [False, False]),
        ("string[2] x", ["", ""]),
        ("uint8[] x", ""),
        ("uint8[3] x", "AAAA"),
        ("int32[<=3] x", []),
        ("time[2] x", [ZERO, ZERO]),
        ("std_msgs/Int8 x", {"data": 0}),
        ("std_msgs/Int8[2] x", [{"data": 0}, {"data": 0}]),
        ("std_msgs/Int8[] x", []),
        ("int32 x 5", 5),
        ("float32 x 0.1", 0.10000000149011612),
        ("string x 'a'", "a"),
        ("int32[] x [1, 2]", [1, 2]),
        ("uint8[] x [1, 2, 3]", "AQID"),
    ],
)
def test_missing_field_has_its_default(line: str, data: object) -> None:
    assert validate_as(line, {}) == data


LENIENT = Validators(Interfaces(), lambda: 0, lenient=True)


@pytest.mark.parametrize(
    ("line", "given", "data"),
    [
        ("int32 x", 5.0, 5),
        ("uint8 x", 255.0, 255),
        ("int64 x", "-9223372036854775808", -(2**63)),
        ("uint64 x", "18446744073709551615", 2**64 - 1),
        ("int64 x", 5.0, 5),
        ("float64 x", "Infinity", inf),
        ("float32 x", "-Infinity", -inf),
        ("int16[] x", [1, 2.0], [1, 2]),
        ("uint64[2] x", ["1", 2], [1, 2]),
        ("float64[] x", [1, "Infinity"], [1.0, inf]),
        ("float32[] x", ["-Infinity", 2], [-inf, 2.0]),
        ("uint8[] x", [1.0, 2], "AQI="),
        ("time x", {"secs": 5.0, "nsecs": 7.0}, {"secs": 5, "nsecs": 7}),
        ("geometry_msgs/Point[] x", [{"x": "Infinity"}], [{"x": inf, "y": 0.0, "z": 0.0}]),
    ],
)
def test_numbers_of_javascript_and_matlab_are_accepted(
    line: str, given: object, data: object
) -> None:
    definition = parse_message(line, "my_msgs", "Mine")
    assert LENIENT.of_definition(definition).validate({"x": given}) == {"x": data}
    with pytest.raises(InvalidMessage):  # Python programs have all kinds of numbers.
        VALIDATORS.of_definition(definition).validate({"x": given})


def test_nan_may_be_a_string() -> None:
    for name in ("Float64", "Float32"):
        assert isnan(LENIENT.of(f"std_msgs/{name}").validate({"data": "NaN"})["data"])


@pytest.mark.parametrize(
    ("line", "given", "place"),
    [
        ("int32 x", "5", "x"),
        ("int32 x", 5.5, "x"),
        ("int32 x", nan, "x"),
        ("int32 x", True, "x"),
        ("uint8 x", 256.0, "x"),
        ("int64 x", "9223372036854775808", "x"),
        ("int64 x", "5.0", "x"),
        ("int64 x", " 5", "x"),
        ("uint64 x", "-1", "x"),
        ("float64 x", "nan", "x"),
        ("float64 x", "5", "x"),
        ("bool x", 1.0, "x"),
        ("string x", 5.0, "x"),
        ("int16[] x", [1.0, "2"], r"x\[1\]"),
        ("int16[] x", b"\1\2", "x"),
        ("float64[] x", ["Infinity", "high"], r"x\[1\]"),
    ],
)
def test_other_spellings_of_numbers_are_refused(line: str, given: object, place: str) -> None:
    definition = parse_message(line, "my_msgs", "Mine")
    with pytest.raises(InvalidMessage, match=place):
        LENIENT.of_definition(definition).validate({"x": given})


@pytest.mark.parametrize("brackets", ["[]", "[<=1000]"])
def test_defaults_in_a_list_are_bounded(brackets: str) -> None:
    """Otherwise each ``{}`` of three bytes would become a megabyte of defaults."""
    text = f"Large{brackets} all\n{'=' * 80}\nMSG: my_msgs/Large\nfloat64[50000] numbers\n"
    definition = ClientDefinitions(Interfaces()).read("msg", "my_msgs/Many", text, "/client")
    assert definition is not None
    validate = Validators(definition, lambda: 0).of("my_msgs/Many").validate
    given = {"numbers": [0.5] * 50_000}
    assert validate({"all": [given, {}]})["all"][0] == given
    with pytest.raises(InvalidMessage, match="leaves 100000 values to their defaults"):
        validate({"all": [{}, {}]})


def test_number_of_defaults_is_limited_by_the_size_of_the_message() -> None:
    validate = VALIDATORS.of("visualization_msgs/MarkerArray").validate
    points = [{"x": 1.0}] * 100_000
    some = validate({"markers": [{"points": points[:30_000]}]})
    assert len(some["markers"][0]["points"]) == 30_000
    with pytest.raises(InvalidMessage, match=r"leaves 2000\d\d values to their defaults"):
        validate({"markers": [{"points": points}]})
    full = [{"x": 1.0, "y": 2.0, "z": 3.0}] * 100_000
    assert validate({"markers": [{"points": full}]})["markers"][0]["points"] == full


def test_large_message_may_leave_out_more_values_than_a_small_one() -> None:
    validate = VALIDATORS.of("visualization_msgs/MarkerArray").validate
    flat = [{"x": 1.0, "y": 2.0}] * 80_000
    points = validate({"markers": [{"points": flat}]})["markers"][0]["points"]
    assert points[-1] == {"x": 1.0, "y": 2.0, "z": 0.0}


def test_too_many_defaults_are_refused_before_allocation() -> None:
    validate = VALIDATORS.of("tf2_msgs/TFMessage").validate
    message: dict[str, Any] = {"transforms": [{}] * 320_000}
    tracemalloc.start()
    with pytest.raises(InvalidMessage, match="the limit for a message with 1 values is 65536"):
        validate(message)
    assert tracemalloc.get_traced_memory()[1] < 100_000
    tracemalloc.stop()


@pytest.mark.parametrize("line", ["float64[4000000] x", "uint8[4000000] x", "time[4000000] x"])
def test_code_for_a_long_array_is_as_short_as_for_a_short_one(line: str) -> None:
    tracemalloc.start()
    try:
        definition = parse_message(line, "my_msgs", "Long")
        validator = Validators(Interfaces(), lambda: 0).of_definition(definition)
        assert tracemalloc.get_traced_memory()[1] < 1_000_000
    finally:
        tracemalloc.stop()
    with pytest.raises(InvalidMessage):
        validator.validate({"x": 1})


def test_defaults_are_not_shared() -> None:
    first, second = (validate("geometry_msgs/PoseArray", {}) for _ in range(2))
    first["poses"].append(1)
    first["header"]["stamp"]["secs"] = 5
    assert second["poses"] == []
    assert second["header"]["stamp"] == NOW


def test_partial_message_is_filled_in() -> None:
    assert validate("geometry_msgs/Twist", {"linear": {"x": 1}}) == {
        "linear": {"x": 1.0, "y": 0.0, "z": 0.0},
        "angular": {"x": 0.0, "y": 0.0, "z": 0.0},
    }


@pytest.mark.parametrize(
    ("header", "stamp"),
    [
        ({"frame_id": "map"}, NOW),
        ({"stamp": {}}, NOW),
        ({"stamp": "now"}, NOW),
        ({"stamp": {"secs": 5}}, {"secs": 5, "nsecs": NOW["nsecs"]}),
        ({"stamp": {"nanosec": 5}}, {"secs": NOW["secs"], "nsecs": 5}),
        ({"stamp": {"secs": 5, "nsecs": 7, "else": 1}}, {"secs": 5, "nsecs": 7}),
    ],
)
def test_unstamped_header_gets_the_current_time(
    header: dict[str, object], stamp: dict[str, int]
) -> None:
    whole = {"seq": 0, "stamp": stamp, "frame_id": header.get("frame_id", "")}
    assert validate("std_msgs/Header", header) == whole
    assert validate("geometry_msgs/PointStamped", {"header": header})["header"] == whole


def test_missing_header_gets_the_current_time() -> None:
    header = {"seq": 0, "stamp": NOW, "frame_id": ""}
    assert validate("geometry_msgs/PointStamped", {})["header"] == header
    assert VALIDATORS.of("geometry_msgs/PointStamped").validate({})["header"] == header


def test_null_time_is_one_that_is_not_given() -> None:
    stamped = {"header": {"seq": 7, "stamp": None, "frame_id": "m"}}
    header = {"seq": 7, "stamp": NOW, "frame_id": "m"}
    assert validate("geometry_msgs/PointStamped", stamped)["header"] == header
    for name in ("Time", "Duration"):
        assert validate(f"std_msgs/{name}", {"data": None}) == {"data": ZERO}


@pytest.mark.parametrize(
    ("name", "msg", "text"),
    [
        ("std_msgs/Header", {"seq": None}, "uint32 for field seq, but got a NoneType"),
        ("std_msgs/Time", {"data": {"secs": None}}, "data.secs, but got a NoneType"),
        ("std_msgs/String", {"data": None}, "string for field data, but got a NoneType"),
        ("geometry_msgs/PointStamped", {"header": None}, "header, but got a NoneType"),
    ],
)
def test_other_nulls_are_refused(name: str, msg: object, text: str) -> None:
    assert fault(name, msg).endswith(text)


def test_seconds_and_nanoseconds_of_a_stamp_are_consistent() -> None:
    moments = iter(range(0, 10**12, 999_999_999))
    validators = Validators(Interfaces(), lambda: next(moments))
    stamps = [validators.of("std_msgs/Header").validate({})["stamp"] for _ in range(3)]
    assert [stamp["secs"] * 10**9 + stamp["nsecs"] for stamp in stamps] == [
        0,
        999_999_999,
        1_999_999_998,
    ]


@pytest.mark.parametrize(
    ("name", "sequenced"),
    [
        ("geometry_msgs/PointStamped", True),
        ("std_msgs/Header", False),
        ("std_msgs/Empty", False),
        ("nav_msgs/GetMapAction", False),
    ],
)
def test_rospy_numbers_messages_whose_first_field_is_a_header(name: str, sequenced: bool) -> None:
    assert VALIDATORS.of(name).has_sequenced_header is sequenced


def test_validator_is_built_once_for_both_spellings_of_a_type() -> None:
    validator = VALIDATORS.of("std_msgs/msg/Int32")
    assert validator is VALIDATORS.of("std_msgs/Int32") is VALIDATORS.of("std_msgs/msg/Int32")
    assert validator.type == "std_msgs/Int32"
    with pytest.raises(UnknownType):
        VALIDATORS.of("std_msgs/Int23")


def test_request_is_validated_like_a_message() -> None:
    service = Interfaces().service("rospy_tutorials/AddTwoInts")
    validator = VALIDATORS.of_definition(service.request)
    assert validator.validate({"a": 1}) == {"a": 1, "b": 0}
    with pytest.raises(InvalidMessage, match="type rospy_tutorials/AddTwoIntsRequest does not"):
        validator.validate({"c": 1})


def test_missing_fields_are_listed() -> None:
    validator = VALIDATORS.of("sensor_msgs/PointCloud")
    msg = {"header": {"seq": 1, "stamp": {}}, "points": [{"x": 1, "y": 2, "z": 3}, {"z": 1}]}
    validator.validate(msg)
    assert validator.missing(msg) == ["header.frame_id", "points[1].x", "points[1].y", "channels"]
    assert validator.missing(validator.validate({})) == []


def test_default_of_every_standard_type_is_valid_json() -> None:
    interfaces = Interfaces()
    for package in interfaces.packages():
        for name in interfaces.messages(package):
            validator = VALIDATORS.of(name)
            default = validator.validate({})
            assert validator.validate(json.loads(to_json(default))) == default
            assert list(default) == [field.name for field in validator.definition.fields]


def test_fields_may_look_like_those_of_other_types() -> None:
    definition = parse_message("int32 secs\nstring stamp\nint32 data", "my_msgs", "Mine")
    assert VALIDATORS.of_definition(definition).validate({"secs": 1, "stamp": "now"}) == {
        "secs": 1,
        "stamp": "now",
        "data": 0,
    }


@given(data=st.binary())
def test_any_bytes_are_restored(data: bytes) -> None:
    text = b64encode(data).decode()
    for spelled in (text, data, list(data)):
        assert validate_as("uint8[] x", {"x": spelled}) == text


scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.integers(min_value=10**300)
    | st.floats()
    | st.text()
    | st.sampled_from(["now", "AQID"])
)
names = st.sampled_from(
    "header stamp secs nsecs sec frame_id seq points channels name values x y z data pose position "
    "covariance width is_dense fields layout dim r".split()
)
json_values = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(names | st.text(), inner, max_size=4)
    ),
    max_leaves=20,
)


@given(
    name=st.sampled_from(
        "sensor_msgs/PointCloud sensor_msgs/PointCloud2 geometry_msgs/PoseWithCovarianceStamped "
        "std_msgs/Header std_msgs/Time std_msgs/Duration std_msgs/ColorRGBA std_msgs/Float32 "
        "std_msgs/UInt8MultiArray std_msgs/String std_msgs/Int64".split()
    ),
    msg=json_values,
)
def test_any_json_is_either_a_message_or_invalid(name: str, msg: object) -> None:
    try:
        valid = validate(name, msg)
    except InvalidMessage as error:
        assert name in str(error)
        return
    assert list(valid) == [field.name for field in VALIDATORS.of(name).definition.fields]
    again = validate(name, from_json(to_json(valid, inf_nan_mode="null")))
    assert to_json(again, inf_nan_mode="null") == to_json(valid, inf_nan_mode="null")


def test_only_the_first_missing_fields_are_listed() -> None:
    found = VALIDATORS.of("sensor_msgs/PointCloud").missing({"points": [{}] * 100_000})
    assert found[:3] == ["header", "points[0].x", "points[0].y"]
    assert (len(found), found[-1]) == (MOST_MISSING + 1, "...")


def test_search_for_missing_fields_is_bounded() -> None:
    points = [{"x": 1, "y": 2, "z": 3}] * 100_000
    found = VALIDATORS.of("sensor_msgs/PointCloud").missing({"points": [*points, {}]})
    assert found == ["header", "channels"]


def float32(value: float) -> float:
    rounded: float = struct.unpack("<f", struct.pack("<f", value))[0]
    return rounded


@pytest.mark.parametrize(
    ("points", "expected"),
    [
        ([{"x": 0.1, "y": 1, "z": -2.5}, {"z": 0.3}], [[0.1, 1, -2.5], [0, 0, 0.3]]),
        ([{"x": None, "y": 0.1}, {"x": 0.1}], [[None, 0.1, 0], [0.1, 0, 0]]),
        ([], []),
    ],
)
def test_float32_values_of_many_messages_are_rounded(
    points: list[dict[str, Any]], expected: list[list[float | None]]
) -> None:
    found = validate("geometry_msgs/Polygon", {"points": points})["points"]
    rounded = [
        [
            None if value is None else struct.unpack("<f", struct.pack("<f", value))[0]
            for value in each
        ]
        for each in expected
    ]
    assert [[point[name] for name in "xyz"] for point in found] == rounded


def test_value_that_is_no_float32_is_named() -> None:
    points = [{"x": 1.0}, {"y": 1e300}]
    with pytest.raises(InvalidMessage, match=r"points\[1\].y"):
        validate("geometry_msgs/Polygon", {"points": points})
