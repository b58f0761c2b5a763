"""Words of a command line as messages; genpy's own view of them is in `test_side_by_side`."""

from __future__ import annotations

import io
import math
import time
from typing import Any

import pytest

from fibws.client.hub_client import HubClient
from fibws.errors import InvalidValue
from fibws.values import parsing
from fibws.values.typedefs import Typedefs


def fault(words: list[str], typedefs: Typedefs) -> str:
    with pytest.raises(InvalidValue) as caught:
        parsing.message(words, typedefs)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("words", [["data: 5"], ["{data: 5}"], ["5"]])
def test_a_message_is_an_object_or_its_values_in_order(client: HubClient, words: list[str]) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/Int32")
    assert parsing.message(words, typedefs) == {"data": 5}


def test_messages_in_it_may_be_lists(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "geometry_msgs/Twist")
    assert parsing.message(["[1, 2, 3]", "{z: 0.5}"], typedefs) == {
        "linear": {"x": 1, "y": 2, "z": 3},
        "angular": {"z": 0.5},
    }


def test_a_number_that_yaml_takes_for_a_text_is_one(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/Float64")
    assert parsing.message(["1e3"], typedefs) == {"data": 1000.0}
    assert parsing.message(["one"], typedefs) == {"data": "one"}, "the hub says what is wrong"
    assert parsing.message([".nan"], typedefs) == {"data": None}
    assert parsing.message([".inf"], typedefs) == {"data": math.inf}


def test_a_colon_without_its_blank_is_told(client: HubClient) -> None:
    told = "YAML wants a blank after the colon: 'data: 5'"
    assert fault(["data:5"], Typedefs.of_message(client, "std_msgs/Int32")) == told
    text = Typedefs.of_message(client, "std_msgs/String")
    assert parsing.message(["data:5"], text) == {"data": "data:5"}


def test_now_and_auto_are_the_time(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "geometry_msgs/PoseStamped")
    before = time.time_ns()
    stamps = [
        parsing.message([word], typedefs)["header"]["stamp"]
        for word in ("header: auto", "header: {stamp: now}")
    ]
    for stamp in stamps:
        assert before <= stamp["secs"] * 10**9 + stamp["nsecs"] <= time.time_ns()


@pytest.mark.parametrize("word", ["{secs: 1, nsecs: 5}", "[1, 5]", "1000000005"])
def test_a_time_has_several_spellings(client: HubClient, word: str) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/Time")
    assert parsing.message([f"data: {word}"], typedefs) == {"data": {"secs": 1, "nsecs": 5}}


def test_times_of_which_nothing_is_said_are_0_as_in_ros(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "geometry_msgs/PoseStamped")
    zero = {"secs": 0, "nsecs": 0}
    assert parsing.message(["{}"], typedefs) == {"header": {"stamp": zero}}
    said = parsing.message(["header: {frame_id: map}"], typedefs)
    assert said == {"header": {"frame_id": "map", "stamp": zero}}


def test_bytes_may_be_binary(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/UInt8MultiArray")
    assert parsing.message(["data: !!binary AQI="], typedefs)["data"] == "AQI="


def test_a_message_that_nobody_defined_is_taken_as_it_is() -> None:
    typedefs = Typedefs("nobodys_msgs/Type")
    assert parsing.message(["{a: [1, {b: x}]}"], typedefs) == {"a": [1, {"b": "x"}]}
    assert "The fields of nobodys_msgs/Type are not known" in fault(["1"], typedefs)


@pytest.mark.parametrize(
    ("type_", "words", "said"),
    [
        ("std_msgs/Int32", ["{dta: 5}"], "No field name [dta]: did you mean data?"),
        ("std_msgs/Int32", ["{xyz: 5}"], "No field name [xyz]: there are data"),
        ("geometry_msgs/Point", ["1", "2"], "Not enough arguments: given [1, 2], expected x, y, z"),
        ("std_msgs/Int32", ["1", "2"], "Too many arguments: given [1, 2], expected data"),
        ("std_msgs/Int32", ["{data: "], "This is no YAML: "),
        ("std_msgs/Int32", ["data: [1]"], "Field [data] must be an int32 instead of [1]"),
        ("std_msgs/String", ["data: 5"], "Field [data] must be a text instead of 5"),
        ("std_msgs/Int64", ["2020-01-01"], "Field [data] is a date to YAML"),
        ("std_msgs/Time", ["data: soon"], "Field [data] must be now, {secs: 1, nsecs: 0} or whole"),
        ("std_msgs/Int32MultiArray", ["data: 5"], "Field [data] must be a list of int32"),
        ("geometry_msgs/Twist", ["linear: 5"], "Field [linear] must be x, y, z"),
        ("geometry_msgs/Twist", ["linear: {w: 5}"], "No field name [linear.w]"),
        ("geometry_msgs/Twist", ["linear: [1]"], "Not enough arguments for [linear]"),
        (
            "geometry_msgs/PoseWithCovariance",
            ["covariance: [1, 2]"],
            "Field [covariance] has incorrect number of elements: 2 instead of 36",
        ),
        ("geometry_msgs/Polygon", ["points: [{x: 1}, {w: 2}]"], "No field name [points[1].w]"),
    ],
)
def test_an_error_names_the_field_and_what_would_be_right(
    client: HubClient, type_: str, words: list[str], said: str
) -> None:
    assert fault(words, Typedefs.of_message(client, type_)).startswith(said)


def test_yaml_makes_no_objects_of_python(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/String")
    assert "no YAML" in fault(["!!python/object/apply:os.getcwd []"], typedefs)


def test_a_file_may_have_several_documents() -> None:
    stream: Any = io.StringIO("data: 1\n---\ndata: 2\n")
    assert list(parsing.documents(stream)) == [{"data": 1}, {"data": 2}]
    with pytest.raises(InvalidValue, match="no YAML"):
        list(parsing.documents(io.StringIO("{")))


BOMB = "\n".join(
    ["a0: &a0 [0, 0, 0, 0, 0, 0, 0, 0, 0, 0]"]
    + [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 12)]
)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (BOMB, "more than 5000000 values"),
        ("a: &a [*a]", "too many values in each other"),
        ("a: &a {b: *a}", "too many values in each other"),
        (f"a: 1{':59' * 5_000}", "no field has room for"),
        ("a: !!timestamp x", "This is no YAML"),
    ],
)
def test_what_would_never_end_is_refused(text: str, fault: str) -> None:
    with pytest.raises(InvalidValue, match=fault):
        parsing.parse(text)
    with pytest.raises(InvalidValue, match=fault):
        list(parsing.documents(text))


def test_what_is_said_of_a_long_word_is_short() -> None:
    with pytest.raises(InvalidValue) as refused:
        parsing.parse("9" * 5_000)
    assert len(str(refused.value)) < 500
