"""Texts are those of Debian's rostopic and genpy."""

from __future__ import annotations

import json
import math
import random
import struct
import subprocess
import tempfile
from base64 import b64encode
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeAlias

import click
import pytest
from click.testing import CliRunner
from hub_in_thread import Publish, Run
from patience import PATIENCE
from recorded_answers import Answers

from fibws.cli import output
from fibws.cli.topic.rates import Delay
from fibws.errors import InvalidValue
from fibws.hub.rosapi.typedefs import TypeDefs
from fibws.interfaces import Interfaces
from fibws.interfaces.definition import Field as DefinedField
from fibws.values import csv_rows, parsing
from fibws.values import rates as windows
from fibws.values.field_paths import Path as FieldPath
from fibws.values.rates import Bandwidth, MessageRate, bandwidth_text, delay_text, poll, rates_text
from fibws.values.typedefs import TypedefField, Typedefs
from fibws.values.yaml_text import Style, message_text, value_text

PYTHON = "/usr/bin/python3"
SCRIPT = Path(__file__).with_name("rostopic_says.py")
NOW = 1_700_000_000_123_456_789

Ask: TypeAlias = Callable[..., Any]

INTERFACES = Interfaces()
TYPEDEFS = TypeDefs(INTERFACES)
TYPES = [
    name
    for package in ("std_msgs", "geometry_msgs", "sensor_msgs", "nav_msgs", "diagnostic_msgs")
    for name in INTERFACES.messages(package)
] + ["visualization_msgs/Marker", "actionlib_msgs/GoalStatusArray", "rosgraph_msgs/Log"]

TEXTS = [
    *("", "hello", "two words", "  spaces ", 'a "quoted" word', "back\\slash", "it's", "a: b"),
    *("- item", "# no comment", "yes", "null", "~", "12", "1.5", "1e5", "=", "<<", "2020-01-01"),
    *("line\nbreak", "tab\there", "\x1b[31mred", "\0", "\x85\xa0", "grüße", "€", "🤖", "\u2028"),
    *("joint_1", "/base_link", "{x: 1}", "[1]", "&a", "*a", "!t", "|", ">", "%", "@", "`", "a,b"),
    "long " * 40,
    "x" * 100,
    "ü" * 50,
    "x" * 70 + " y z " * 5,
]
FLOATS = [0.0, -0.0, 1.0, -1.5, 1 / 3, 1e-7, 1e16, 1e300, 123456.789, math.nan]


class RealRostopic:
    """Debian's rostopic, whose functions are called in a process of its own."""

    def __init__(self, folder: str) -> None:
        self._process = subprocess.Popen(
            [PYTHON, "-I", SCRIPT],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={"PATH": "/usr/bin:/bin", "HOME": folder, "LANG": "C.UTF-8"},
        )
        assert self._process.stdin is not None and self._process.stdout is not None
        self._stdin, self._stdout = self._process.stdin, self._process.stdout

    def call(self, function: str, arguments: dict[str, Any]) -> Any:
        """Call a function of `rostopic_says`."""
        print(json.dumps([function, arguments]), file=self._stdin, flush=True)
        return json.loads(self._stdout.readline())

    def close(self) -> None:
        """End the process."""
        self._stdin.close()
        assert self._process.wait(PATIENCE) == 0
        self._stdout.close()


@pytest.fixture(scope="module")
def real_rostopic() -> Iterator[RealRostopic]:
    """Debian's rostopic, needed for recording only."""
    with tempfile.TemporaryDirectory() as home:
        rostopic = RealRostopic(home)
        yield rostopic
        rostopic.close()


@pytest.fixture
def ask(answers: Answers, request: pytest.FixtureRequest) -> Ask:
    """Return what a function of `rostopic_says` returns."""

    def ask(function: str, **arguments: Any) -> Any:
        question = {key: value for key, value in arguments.items() if key != "full_text"}
        return answers.of(
            f"{function} {json.dumps(question)}",
            lambda: request.getfixturevalue("real_rostopic").call(function, arguments),
        )

    return ask


def typedefs(type_: str) -> Typedefs:
    return Typedefs(type_, json.loads(TYPEDEFS.message(type_))["typedefs"])


def example(type_: str, choose: random.Random) -> dict[str, Any]:
    """A message as the hub's JSON has it."""
    return {
        field.name: _array(field, choose) if field.array else _element(field.type, choose)
        for field in INTERFACES.message(type_).fields
    }


def _array(field: DefinedField, choose: random.Random) -> Any:
    number = field.fixed_size or choose.choice([0, 1, 3])
    elements = [_element(field.type, choose) for _ in range(number)]
    return b64encode(bytes(elements)).decode() if field.is_bytes else elements


def _element(type_: str, choose: random.Random) -> Any:
    match type_:
        case "string":
            return choose.choice(TEXTS)
        case "bool":
            return choose.random() < 0.5
        case "float32" | "float64":
            value = choose.choice(FLOATS)
            if type_ == "float32":
                value = struct.unpack("f", struct.pack("f", value % 1e30))[0]
            return None if math.isnan(value) else value
        case "time":
            return {"secs": choose.randrange(2**31), "nsecs": choose.choice([0, 7, 123456789])}
        case "duration":
            return {"secs": choose.randrange(-5, 5), "nsecs": choose.choice([0, 7, 999999999])}
        case _ if "/" in type_:
            return example(type_, choose)
        case _:
            return choose.choice([0, 1, 42, 127])


def asked(type_: str, value: dict[str, Any]) -> dict[str, Any]:
    return {"type_": type_, "full_text": INTERFACES.full_text(type_), "value": value}


# Where a type's arrays are of char or of a fixed length, rostopic shows Python's own spelling of
# bytes, and half a bracket: see the tests below.
def _is_odd(type_: str) -> bool:
    return any(
        field.array is not None and field.type == "char"
        for field in INTERFACES.message(type_).fields
    )


@pytest.mark.parametrize("type_", [type_ for type_ in TYPES if not _is_odd(type_)])
def test_messages_are_printed_as_by_rostopic(ask: Ask, type_: str) -> None:
    choose = random.Random(type_)
    for _ in range(4):
        value = example(type_, choose)
        found = typedefs(type_)
        assert message_text(value, found) == ask("echo", **asked(type_, value))
        style = Style(width=choose.choice([2, 5, 9]), offset=choose.choice([None, NOW]))
        printed = value_text(value, TypedefField("", type_), found, style)
        given = {"width": style.width, "offset": style.offset}
        assert printed == ask("echo", **asked(type_, value), **given)


@pytest.mark.parametrize(
    "type_", ["sensor_msgs/JointState", "rosgraph_msgs/Log", "std_msgs/String"]
)
def test_lengths_are_printed_as_by_rostopic(ask: Ask, type_: str) -> None:
    value = example(type_, random.Random(8))
    for noarr, nostr in ((True, False), (False, True), (True, True)):
        style = Style(noarr, nostr)
        mine = value_text(value, TypedefField("", type_), typedefs(type_), style)
        assert mine == ask("echo", **asked(type_, value), noarr=noarr, nostr=nostr)


@pytest.mark.parametrize("text", TEXTS)
def test_strings_are_printed_as_by_rostopic(ask: Ask, text: str) -> None:
    for type_, value in (
        ("std_msgs/String", {"data": text}),
        ("diagnostic_msgs/KeyValue", {"key": text, "value": text}),
    ):
        assert message_text(value, typedefs(type_)) == ask("echo", **asked(type_, value))


def test_lists_of_strings_are_printed_as_by_rostopic(ask: Ask) -> None:
    stamp = {"secs": 1, "nsecs": 2}
    header = {"seq": 1, "stamp": stamp, "frame_id": ""}
    for names in ([text] for text in TEXTS):
        names = [*names, "joint_2"]
        value = {"header": header, "name": names, "position": [], "velocity": [], "effort": []}
        type_ = "sensor_msgs/JointState"
        assert message_text(value, typedefs(type_)) == ask("echo", **asked(type_, value))


@pytest.mark.parametrize(
    ("type_", "path"),
    [
        ("geometry_msgs/PoseStamped", "/pose/position"),
        ("geometry_msgs/PoseStamped", "/pose/position/x"),
        ("geometry_msgs/PoseStamped", "/header/stamp"),
        ("geometry_msgs/PoseStamped", "/header/stamp/secs"),
        ("geometry_msgs/PoseWithCovariance", "/covariance"),
        ("geometry_msgs/PoseWithCovariance", "/covariance[3]"),
        ("geometry_msgs/PoseWithCovariance", "/covariance[-2:]"),
        ("geometry_msgs/PoseWithCovariance", "/covariance[::7]"),
        ("geometry_msgs/Polygon", "/points"),
        ("geometry_msgs/Polygon", "/points[1]"),
        ("geometry_msgs/Polygon", "/points[1]/y"),
        ("geometry_msgs/Polygon", "/points[:]/y"),
        ("sensor_msgs/JointState", "/name[0]"),
    ],
)
def test_fields_are_found_as_by_rostopic(ask: Ask, type_: str, path: str) -> None:
    choose = random.Random(1)
    value = example(type_, choose)
    while any(each == [] for each in value.values()):
        value = example(type_, choose)
    found, way = typedefs(type_), FieldPath(path)
    mine = value_text(way.pick(value, found), way.field(found), found)
    assert mine == ask("field", **asked(type_, value), path=path)


@pytest.mark.parametrize(
    "type_",
    [
        "std_msgs/Int32",
        "std_msgs/Bool",
        "std_msgs/String",
        "geometry_msgs/PoseStamped",
        "geometry_msgs/PolygonStamped",
        "sensor_msgs/JointState",
        "sensor_msgs/LaserScan",
        "nav_msgs/Path",
    ],
)
def test_rows_are_those_of_rostopic(ask: Ask, type_: str) -> None:
    choose = random.Random(2)
    for noarr, nostr in ((False, False), (True, False), (False, True)):
        value = example(type_, choose)
        rows = csv_rows.Rows(typedefs(type_), TypedefField("", type_), noarr=noarr, nostr=nostr)
        mine = [rows.head(value), rows.row(value, now=NOW)]
        assert mine == ask("plot", **asked(type_, value), now=NOW, noarr=noarr, nostr=nostr)


@pytest.mark.parametrize(
    ("type_", "words"),
    [
        ("std_msgs/Int32", ["5"]),
        ("std_msgs/Int32", ["data: 5"]),
        ("std_msgs/Int32", ["{data: 5}"]),
        ("std_msgs/Int32", ["{}"]),
        ("std_msgs/Int32", ["{dada: 5}"]),
        ("std_msgs/Int32", ["5", "6"]),
        ("std_msgs/String", ["hello"]),
        ("std_msgs/String", ["data: "]),
        ("std_msgs/String", ["5"]),
        ("std_msgs/String", ["'5'"]),
        ("std_msgs/Time", ["[1, 2]"]),
        ("std_msgs/Time", ["{secs: 1}"]),
        ("std_msgs/Time", ["1500000000"]),
        ("std_msgs/Time", ["data: tomorrow"]),
        ("std_msgs/Float64", ["1"]),
        ("std_msgs/Float64", [".nan"]),
        ("std_msgs/UInt8MultiArray", ["{data: [1, 2, 3]}"]),
        ("std_msgs/Int32MultiArray", ["{dim: [], data_offset: 0}", "[1, 2]"]),
        ("std_msgs/Int32MultiArray", ["{layout: {dim: [{label: a, size: 1}]}, data: [1]}"]),
        ("std_msgs/Int32MultiArray", ["{data: 5}"]),
        ("geometry_msgs/Twist", ["[1, 2, 3]", "[0, 0, 0.5]"]),
        ("geometry_msgs/Twist", ["{linear: {x: 1.5}, angular: {z: -2}}"]),
        ("geometry_msgs/Twist", ["[1, 2]", "[0, 0, 0.5]"]),
        ("geometry_msgs/Twist", ["[1, 2, 3]"]),
        ("geometry_msgs/PoseStamped", ["{header: {frame_id: map}, pose: {position: {x: 1}}}"]),
        ("geometry_msgs/PoseStamped", ["{header: never}"]),
        ("geometry_msgs/Polygon", ["[[1, 2, 3], {x: 4}]"]),
        ("geometry_msgs/Polygon", ["{points: [1]}"]),
        ("geometry_msgs/PoseWithCovariance", ["{covariance: [1, 2]}"]),
    ],
)
def test_arguments_are_parsed_as_by_rostopic(ask: Ask, type_: str, words: list[str]) -> None:
    theirs = ask("read", type_=type_, full_text=INTERFACES.full_text(type_), words=words)
    if "fault" in theirs:
        with pytest.raises(InvalidValue):
            parsing.message(words, typedefs(type_))
    else:
        mine = message_text(parsing.message(words, typedefs(type_)), typedefs(type_))
        # What is whole is a float here once the hub has read it.
        assert _as_floats(mine) == _as_floats(theirs["text"])


def _as_floats(text: str) -> str:
    return text.replace(".0", "")


def _print_rates(rates: dict[str, MessageRate]) -> None:
    output.line(rates_text(poll(rates), len(rates)))


def test_rate_is_reported_as_by_rostopic(ask: Ask) -> None:
    deltas = [0.101, 0.099, 0.1003, 0.25]
    rate = MessageRate()
    for moment in (0, *(sum(deltas[: i + 1]) for i in range(len(deltas)))):
        rate.add(moment)
    assert _printed(lambda: _print_rates({"/x": rate})) == ask("hz", topics={"/x": deltas})


def test_rates_are_reported_as_by_rostopic(ask: Ask) -> None:
    topics = {"/x": [0.5, 0.25], "/a_longer_name": [0.001, 0.0023]}
    rates = {name: MessageRate() for name in topics}
    for name, deltas in topics.items():
        for moment in (0, deltas[0], sum(deltas)):
            rates[name].add(moment)
    assert _printed(lambda: _print_rates(rates)) == ask("hz", topics=topics)


def test_missing_messages_are_reported_as_by_rostopic(ask: Ask) -> None:
    assert _printed(lambda: _print_rates({"/x": MessageRate()})) == ask("hz", topics={"/x": []})


def test_delays_are_reported_as_by_rostopic(ask: Ask) -> None:
    delays = [0.25, 0.5, 0.001]
    mine = Delay()
    for each in delays:
        mine.add(each)
    polled = mine.poll()
    assert polled is not None
    # rostopic counts one more than it has.
    theirs = ask("delay", delays=delays).replace("window: 4", "window: 3")
    assert f"{delay_text(*polled)}\n" == theirs


@pytest.mark.parametrize("size", [7, 700, 700_000])
def test_bandwidth_is_reported_as_by_rostopic(ask: Ask, size: int) -> None:
    bandwidth = Bandwidth()
    sizes, times = [size, size + 1, size + 5], [10.0, 10.5, 11.0]
    for each, now in zip(sizes, times, strict=True):
        bandwidth.add(each, now)
    polled = bandwidth.at(11.5)
    assert polled is not None
    assert f"{bandwidth_text(*polled)}\n" == ask("bw", sizes=sizes, times=times, now=11.5)


def _printed(show: Callable[[], None]) -> str:
    return CliRunner().invoke(click.Command("show", callback=show)).output


@pytest.mark.parametrize("options", [[], ["-v"], ["-p"], ["-s"], ["-v", "-p"], ["-v", "-s"]])
def test_topics_are_listed_as_by_rostopic(
    ask: Ask, run: Run, publish: Publish, options: list[str]
) -> None:
    client = publish("/chatter", "std_msgs/String", {"data": "hello"})
    client.subscribe("/ns/heard")
    client.subscribe("/chatter")
    client.call("/rosapi/get_time")
    log, node = "rosgraph_msgs/Log", ["/pub"]
    published = [
        ("/chatter", "std_msgs/String", node),
        ("/client_count", "std_msgs/Int32", ["/rosbridge_websocket"]),
        ("/connected_clients", "rosbridge_msgs/ConnectedClients", ["/rosbridge_websocket"]),
        ("/rosout", log, ["/rosapi", "/rosbridge_websocket"]),
        ("/rosout_agg", log, ["/rosout"]),
    ]
    subscribed = [
        ("/chatter", "std_msgs/String", node),
        ("/ns/heard", "unknown type", node),
        ("/rosout", log, ["/rosout"]),
    ]
    theirs = ask(
        "listed",
        published=published,
        subscribed=subscribed,
        publishers_only="-p" in options,
        subscribers_only="-s" in options,
        verbose="-v" in options,
    )
    assert run("topic", "list", *options).output.replace(client.node, "/pub") == theirs


def test_info_is_printed_as_by_rostopic(ask: Ask, run: Run, publish: Publish) -> None:
    client = publish("/chatter", "std_msgs/String", {"data": "hello"})
    theirs = ask(
        "info",
        topic="/chatter",
        type_="std_msgs/String",
        publishers=["/pub"],
        subscribers=[],
    )
    mine = run("topic", "info", "/chatter").output.replace(client.node, "/pub")
    address = mine.partition("(")[2].partition(")")[0]
    assert mine.replace(address, "address") == theirs


def test_differences_from_rostopic() -> None:
    covariance = {"covariance": [0.0] * 36}
    type_ = "geometry_msgs/PoseWithCovariance"
    short = value_text(covariance, TypedefField("", type_), typedefs(type_), Style(noarr=True))
    assert short.endswith('covariance: "<array type: float64, length: 36>"')
    assert windows.MAX_WINDOW == 50_000
