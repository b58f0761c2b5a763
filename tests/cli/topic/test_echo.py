"""``fibws topic echo``."""

from __future__ import annotations

import asyncio
import json
import os
import pty
import signal
import struct
import subprocess
import sys
import threading
from math import nan
from pathlib import Path
from typing import Any

import pytest
from hub_in_thread import HubThread, Publish, Run
from running_programs import Start

from fibws.bags import open_writer
from fibws.client.hub_client import HubClient
from fibws.interfaces import Interfaces, Validators
from fibws.interfaces.serialization import Serializers

CURVE = {"layout": {"dim": [], "data_offset": 0}, "data": [1, 2, 3]}


def test_messages_are_printed_as_yaml(run: Run, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    result = run("topic", "echo", "-n", "1", "/number")
    assert (result.exit_code, result.output) == (0, "data: 8\n---\n")


@pytest.mark.parametrize(
    ("options", "printed"),
    [
        (["/curve/data"], "[1, 2, 3]\n---\n"),
        (["/curve/data[-1]"], "3\n---\n"),
        (["/curve/data[0]", "-w", "4"], "   1\n---\n"),
        (["/curve/data", "--noarr"], '"<array type: int32, length: 3>"\n---\n'),
        (["/curve/data", "--json"], "[1,2,3]\n"),
        (["/curve/layout/dim", "-c"], "[]\n---\n"),
    ],
)
def test_options_change_the_output(
    run: Run, publish: Publish, options: list[str], printed: str
) -> None:
    publish("/curve", "std_msgs/Int32MultiArray", CURVE)
    assert run("topic", "echo", "-n", "1", *options).output == printed


@pytest.mark.parametrize(
    ("type_", "message", "yaml", "row", "json_"),
    [
        ("Float64", '{"data":1e999}', "data: inf", "inf", "1e999"),
        ("Float64", '{"data":-1e999}', "data: -inf", "-inf", "-1e999"),
        ("Float32", '{"data":-1e999}', "data: -inf", "-inf", "-1e999"),
        ("Float64", '{"data":null}', "data: nan", "nan", "null"),
        ("Float64", '{"data":-0.0}', "data: -0.0", "-0.0", "-0.0"),
        ("Float64", '{"data":5e-324}', "data: 5e-324", "5e-324", "5e-324"),
        ("Int64", f'{{"data":{-(2**63)}}}', f"data: {-(2**63)}", f"{-(2**63)}", f"{-(2**63)}"),
        ("UInt64", f'{{"data":{2**64 - 1}}}', f"data: {2**64 - 1}", f"{2**64 - 1}", f"{2**64 - 1}"),
    ],
)
def test_numbers_are_printed_as_they_were_sent(
    run: Run,
    publish: Publish,
    tmp_path: Path,
    type_: str,
    message: str,
    yaml: str,
    row: str,
    json_: str,
) -> None:
    type_ = f"std_msgs/{type_}"
    publish("/x", type_, json.loads(message))
    serialized = (
        Serializers(Interfaces())
        .of(type_)
        .serialize(Validators(Interfaces(), lambda: 0).of(type_).validate(json.loads(message)))
    )
    path = tmp_path / "it.bag"
    with open_writer(path) as writer:
        text = Interfaces().full_text(type_)
        writer.write(writer.connection("/x", type_, Interfaces().md5(type_), text), 1, serialized)
    for source in ([], ["-b", str(path)]):
        arguments = ["topic", "echo", *source, "-n", "1", "/x"]
        assert run(*arguments).output == f"{yaml}\n---\n"
        assert run(*arguments, "-p").output.splitlines()[1].split(",")[1] == row
        assert run(*arguments, "--json").output == f'{{"data":{json_}}}\n'


@pytest.mark.parametrize("name", ["/a-b", "/übung/x.y"])
def test_topic_with_an_invalid_name_is_printed(run: Run, publish: Publish, name: str) -> None:
    publish(name, "std_msgs/Int32", {"data": 8})
    assert run("topic", "echo", "-n", "1", name).output == "data: 8\n---\n"
    assert run("topic", "echo", "-n", "1", f"{name}/data").output == "8\n---\n"
    assert run("topic", "type", name).output == "std_msgs/Int32\n"
    assert "Type: std_msgs/Int32" in run("topic", "info", name).output
    assert name in run("topic", "list").output.splitlines()


def test_json_prints_a_message_per_line(run: Run, publish: Publish) -> None:
    publish("/curve", "std_msgs/Int32MultiArray", CURVE)
    assert json.loads(run("topic", "echo", "--json", "-n", "1", "/curve").output) == CURVE
    styled = run("topic", "echo", "--json", "--noarr", "-n", "1", "/curve")
    assert styled.exit_code == 2
    assert "--noarr" in styled.output


def test_filter_selects_messages(run: Run, publish: Publish) -> None:
    client = publish("/number", "std_msgs/Int32", {"data": 1})

    def publish_more() -> None:
        while not client.call("/rosapi/subscribers", {"topic": "/number"})["subscribers"]:
            pass
        for number in (7, 3, 9):
            client.send({"op": "publish", "topic": "/number", "msg": {"data": number}})
        client.call("/rosapi/get_time")

    thread = threading.Thread(target=publish_more)
    thread.start()
    result = run("topic", "echo", "-n", "2", "--filter", "m.data > 5", "/number/data")
    thread.join(60)
    assert (result.exit_code, result.output) == (0, "7\n---\n9\n---\n")


@pytest.mark.parametrize(
    ("condition", "fact"),
    [
        ("m.data > 'x'", "--filter"),
        ("m.date > 5", "date"),
        ("data > 5", "m.data > 5"),
    ],
)
def test_invalid_filter_is_wrong_usage(
    run: Run, publish: Publish, condition: str, fact: str
) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    result = run("topic", "echo", "--filter", condition, "/number")
    assert result.exit_code == 2 and fact in result.output.partition("Error: ")[2], result.output


@pytest.fixture
def bag(tmp_path: Path) -> str:
    """A bag of numbers and points, one of which is NaN."""
    path = tmp_path / "it.bag"
    interfaces = Interfaces()
    with open_writer(path) as writer:
        numbers, points = (
            writer.connection(topic, type_, interfaces.md5(type_), interfaces.full_text(type_))
            for topic, type_ in (
                ("/number", "std_msgs/Int32"),
                ("/point", "geometry_msgs/PointStamped"),
            )
        )
        for number in range(3):
            stamp = (1_700_000_000 + number) * 10**9
            writer.write(numbers, stamp, struct.pack("<i", number))
            point = (0, 5 + number, 0, 0, number or nan, 1, 2)
            writer.write(points, stamp, struct.pack("<IIII3d", *point))
    return str(path)


def test_bags_need_no_hub(bag: str, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "ws://127.0.0.1:1")
    result = run("topic", "echo", "-b", bag, "number")
    assert (result.exit_code, result.output) == (0, "data: 0\n---\ndata: 1\n---\ndata: 2\n---\n")
    assert run("topic", "echo", "-b", bag, "-a").output.count("---") == 6
    lines = run("topic", "echo", "-b", bag, "-a", "--json").output.splitlines()
    assert len(lines) == 6
    time = {"secs": 1_700_000_000, "nsecs": 0}
    assert json.loads(lines[0]) == {"topic": "/number", "time": time, "message": {"data": 0}}
    assert (
        run("topic", "echo", "-b", bag, "-n", "2", "/point/point/x").output
        == "nan\n---\n1.0\n---\n"
    )
    output = run("topic", "echo", "-b", bag, "--json", "/point/point").output
    assert [json.loads(line)["x"] for line in output.splitlines()] == [None, 1, 2]
    output = run("topic", "echo", "-b", bag, "--filter", "m.data > 1", "/number").output
    assert output == "data: 2\n---\n"


def test_rows_of_bags_begin_with_the_time_of_the_recording(bag: str, run: Run) -> None:
    output = run("topic", "echo", "-b", bag, "-p", "/point").output
    assert [row.partition(",")[0] for row in output.splitlines()] == [
        "%time",
        *(f"{1_700_000_000 + number}000000000" for number in range(3)),
    ]


@pytest.mark.parametrize(
    ("words", "fact"),
    [
        (("-b", "{bag}", "/nmber"), "/number"),
        (("-b", "{bag}", "/number/date"), "data"),
        (("-b", "{bag}"), "TOPIC"),
        (("-a",), "--bag"),
        (("-b", "{bag}", "--filter", "m.date > 5", "/number"), "data"),
    ],
)
def test_wrong_usage_with_bags(bag: str, run: Run, words: tuple[str, ...], fact: str) -> None:
    result = run("topic", "echo", *(word.replace("{bag}", bag) for word in words))
    assert result.exit_code == 2
    assert fact in result.output.partition("Error: ")[2]


def test_missing_bag_is_an_error(run: Run) -> None:
    result = run("topic", "echo", "-b", "missing.bag", "/number")
    assert result.exit_code == 1
    assert "missing.bag" in result.output


def test_comma_separated_values_have_a_head(run: Run, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    head, row = run("topic", "echo", "-p", "-n", "1", "/number").output.splitlines()
    assert head == "%time,field.data"
    assert row.endswith(",8")


def test_times_can_be_relative(run: Run, publish: Publish) -> None:
    publish("/time", "std_msgs/Time", {"data": "now"})
    printed = run("topic", "echo", "-n", "1", "--offset", "/time").output
    secs = int(printed.splitlines()[1].removeprefix("  secs: "))
    assert -20 < secs <= 0


def test_messages_with_too_short_arrays_are_skipped(run: Run, publish: Publish) -> None:
    client = publish("/curve", "std_msgs/Int32MultiArray", {"data": [1]})

    def publish_longer() -> None:
        while len(client.call("/rosapi/subscribers", {"topic": "/curve"})["subscribers"]) == 0:
            pass
        client.send({"op": "publish", "topic": "/curve", "msg": CURVE})
        client.call("/rosapi/get_time")

    thread = threading.Thread(target=publish_longer)
    thread.start()
    result = run("topic", "echo", "-n", "1", "/curve/data[2]")
    thread.join(60)
    assert result.stdout == "3\n---\n"
    assert "data has only 1 " in result.stderr


def test_message_of_an_unknown_type_is_printed(run: Run, publish: Publish) -> None:
    publish("/odd", "unknown_msgs/Type", {"a": 1, "b": [{"c": "x"}]})
    assert run("topic", "echo", "-n", "1", "/odd").output == 'a: 1\nb: \n  - \n    c: "x"\n---\n'


@pytest.mark.parametrize(
    ("before", "after", "type_", "printed"),
    [
        ({"data": 8}, {}, "geometry_msgs/Point", "x: 0.0\ny: 0.0\nz: 0.0\n"),
        ({"data": 8}, {"data": "8"}, "std_msgs/String", 'data: "8"\n'),
        ({"data": 8}, {"data": "AQI="}, "std_msgs/UInt8MultiArray", "data: [1, 2]\n"),
    ],
)
async def test_type_of_a_topic_may_change(
    start: Start,
    hub: HubThread,
    client: HubClient,
    before: dict[str, int],
    after: dict[str, str],
    type_: str,
    printed: str,
) -> None:
    program = await start("fibws", "topic", "echo", "-n", "2", "/x", FIBWS_HUB=hub.url)
    assert await program.error_line()
    publish_latched(client, "std_msgs/Int32", before)
    assert await program.line() == "data: 8\n"
    client.send({"op": "unadvertise", "topic": "/x"})
    publish_latched(client, type_, after)
    code, out, err = await program.end()
    assert (code, err) == (0, "")
    assert out.startswith("---\n")
    assert out.endswith(f"{printed}---\n")


async def test_field_may_be_missing_in_another_type(
    start: Start, hub: HubThread, client: HubClient
) -> None:
    publish_latched(client, "std_msgs/Int32", {"data": 8})
    program = await start("fibws", "topic", "echo", "-n", "2", "/x/data", FIBWS_HUB=hub.url)
    assert await program.line() == "8\n"
    client.send({"op": "unadvertise", "topic": "/x"})
    publish_latched(client, "geometry_msgs/Point", {})
    assert "no field" in await program.error_line()
    client.send({"op": "unadvertise", "topic": "/x"})
    publish_latched(client, "std_msgs/String", {"data": "8"})
    assert await program.end() == (0, '---\n"8"\n---\n', "")


def publish_latched(client: HubClient, type_: str, message: dict[str, Any]) -> None:
    """Advertise /x with a type, and publish a latched message."""
    client.send({"op": "advertise", "topic": "/x", "type": type_, "latch": True})
    client.send({"op": "publish", "topic": "/x", "msg": message})


async def test_ctrl_c_ends_without_an_error(start: Start, hub: HubThread, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    program = await start("fibws", "topic", "echo", "/number", FIBWS_HUB=hub.url)
    assert await program.line() == "data: 8\n"
    assert await program.line() == "---\n"
    program.send(signal.SIGINT)
    assert await program.end() == (0, "", "")


async def test_closed_pipe_ends_without_an_error(
    start: Start, hub: HubThread, publish: Publish
) -> None:
    client = publish("/number", "std_msgs/Int32", {"data": 8})
    program = await start("fibws", "topic", "echo", "/number", FIBWS_HUB=hub.url)
    await program.line()
    program.stop_reading()
    while client.call("/rosapi/subscribers", {"topic": "/number"})["subscribers"]:
        client.send({"op": "publish", "topic": "/number", "msg": {"data": 8}})
        await asyncio.sleep(0)
    code, _, errors = await program.end()
    assert (code, errors) == (0, "")


async def test_unpublished_topic_is_awaited(start: Start, hub: HubThread, publish: Publish) -> None:
    publish("/later", "std_msgs/Int32")
    program = await start("fibws", "topic", "echo", "-n", "1", "/late", FIBWS_HUB=hub.url)
    warning = "WARNING: topic [/late] does not appear to be published yet"
    assert await program.error_line() == f"{warning}; did you mean /later?\n"
    publish("/late", "std_msgs/Int32", {"data": 8})
    assert await program.end() == (0, "data: 8\n---\n", "")


async def test_without_a_hub_the_error_says_how_to_start_one(start: Start) -> None:
    program = await start("fibws", "topic", "echo", "/x", FIBWS_HUB="ws://127.0.0.1:1")
    code, printed, errors = await program.end()
    assert (code, printed) == (1, "")
    assert "ws://127.0.0.1:1" in errors and "fibws hub" in errors


async def test_lost_hub_is_an_error(start: Start, hub: HubThread, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    program = await start("fibws", "topic", "echo", "/number", FIBWS_HUB=hub.url)
    await program.line()
    hub.stop()
    code, _, errors = await program.end()
    assert code == 1
    assert hub.url in errors


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="there are no terminals of this kind")
def test_screen_is_cleared_on_a_terminal_only(hub: HubThread, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    mine, theirs = pty.openpty()
    command = ["-m", "fibws", "topic", "echo", "-c", "-n", "1", "/number", "--hub", hub.url]
    try:
        subprocess.run([sys.executable, *command], stdout=theirs, check=True, timeout=60)
        printed = os.read(mine, 1000)
    finally:
        os.close(mine)
        os.close(theirs)
    assert printed == b"\x1b[2J\x1b[;Hdata: 8\r\n---\r\n"
