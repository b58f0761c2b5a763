"""Messages from a command line's arguments; compared with genpy's in `test_side_by_side`."""

from __future__ import annotations

import io
import math
import re
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
def test_message_is_an_object_or_its_values_in_order(client: HubClient, words: list[str]) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/Int32")
    assert parsing.message(words, typedefs) == {"data": 5}


def test_nested_messages_may_be_lists(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "geometry_msgs/Twist")
    assert parsing.message(["[1, 2, 3]", "{z: 0.5}"], typedefs) == {
        "linear": {"x": 1, "y": 2, "z": 3},
        "angular": {"z": 0.5},
    }


def test_numbers_that_are_strings_in_yaml_are_numbers(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/Float64")
    assert parsing.message(["1e3"], typedefs) == {"data": 1000.0}
    assert parsing.message(["one"], typedefs) == {"data": "one"}, "the hub says what is wrong"
    assert parsing.message([".nan"], typedefs) == {"data": None}
    assert parsing.message([".inf"], typedefs) == {"data": math.inf}


def test_missing_space_after_a_colon_is_reported(client: HubClient) -> None:
    assert "'data: 5'" in fault(["data:5"], Typedefs.of_message(client, "std_msgs/Int32"))
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
def test_time_has_several_spellings(client: HubClient, word: str) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/Time")
    assert parsing.message([f"data: {word}"], typedefs) == {"data": {"secs": 1, "nsecs": 5}}


def test_missing_times_are_0_as_in_ros(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "geometry_msgs/PoseStamped")
    zero = {"secs": 0, "nsecs": 0}
    assert parsing.message(["{}"], typedefs) == {"header": {"stamp": zero}}
    said = parsing.message(["header: {frame_id: map}"], typedefs)
    assert said == {"header": {"frame_id": "map", "stamp": zero}}


def test_bytes_may_have_the_tag_binary(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/UInt8MultiArray")
    assert parsing.message(["data: !!binary AQI="], typedefs)["data"] == "AQI="


def test_message_of_an_unknown_type_is_not_checked() -> None:
    typedefs = Typedefs("unknown_msgs/Type")
    assert parsing.message(["{a: [1, {b: x}]}"], typedefs) == {"a": [1, {"b": "x"}]}
    assert "unknown_msgs/Type" in fault(["1"], typedefs)


@pytest.mark.parametrize(
    ("type_", "words", "facts"),
    [
        ("std_msgs/Int32", ["{dta: 5}"], r"\[dta\].*did you mean data"),
        ("std_msgs/Int32", ["{xyz: 5}"], r"\[xyz\].* data"),
        ("geometry_msgs/Point", ["1", "2"], r"Not enough arguments: .*x, y, z .*\[1, 2\]"),
        ("std_msgs/Int32", ["1", "2"], r"Too many arguments: .*data .*\[1, 2\]"),
        ("std_msgs/Int32", ["{data: "], "Invalid YAML: "),
        ("std_msgs/Int32", ["data: [1]"], r"\[data\].* int32.*\[1\]"),
        ("std_msgs/String", ["data: 5"], r"\[data\].* string.*5"),
        ("std_msgs/Int64", ["2020-01-01"], r"\[data\].* date 2020-01-01"),
        ("std_msgs/Time", ["data: soon"], r"\[data\].* now, \{secs: 1, nsecs: 0\}.*'soon'"),
        ("std_msgs/Int32MultiArray", ["data: 5"], r"\[data\].* list of int32.* 5"),
        ("geometry_msgs/Twist", ["linear: 5"], r"\[linear\].* x, y, z .* 5"),
        ("geometry_msgs/Twist", ["linear: {w: 5}"], r"\[linear\.w\]"),
        ("geometry_msgs/Twist", ["linear: [1]"], r"Not enough arguments for \[linear\]"),
        ("geometry_msgs/PoseWithCovariance", ["covariance: [1, 2]"], r"\[covariance\].* 36.* 2"),
        ("geometry_msgs/Polygon", ["points: [{x: 1}, {w: 2}]"], r"\[points\[1\]\.w\]"),
    ],
)
def test_error_names_the_field_and_what_is_expected(
    client: HubClient, type_: str, words: list[str], facts: str
) -> None:
    assert re.match(f".*{facts}", fault(words, Typedefs.of_message(client, type_)))


def test_tags_of_python_objects_are_refused(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/String")
    assert "Invalid YAML" in fault(["!!python/object/apply:os.getcwd []"], typedefs)


def test_file_may_have_several_documents() -> None:
    stream: Any = io.StringIO("data: 1\n---\ndata: 2\n")
    assert list(parsing.documents(stream)) == [{"data": 1}, {"data": 2}]
    with pytest.raises(InvalidValue, match="Invalid YAML"):
        list(parsing.documents(io.StringIO("{")))


BOMB = "\n".join(
    ["a0: &a0 [0, 0, 0, 0, 0, 0, 0, 0, 0, 0]"]
    + [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 12)]
)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (BOMB, "limit: 5000000"),
        ("a: &a [*a]", "nested too deeply"),
        ("a: &a {b: *a}", "nested too deeply"),
        ("[" * 1_000, "nested too deeply"),
        (f"a: 1{':59' * 5_000}", "limit: 1024 bits"),
        ("a: !!timestamp x", "Invalid YAML"),
    ],
)
def test_documents_without_bounds_are_refused(text: str, fault: str) -> None:
    with pytest.raises(InvalidValue, match=fault):
        parsing.parse(text)
    with pytest.raises(InvalidValue, match=fault):
        list(parsing.documents(text))


def test_errors_about_long_words_are_short() -> None:
    with pytest.raises(InvalidValue) as refused:
        parsing.parse("9" * 5_000)
    assert len(str(refused.value)) < 500
