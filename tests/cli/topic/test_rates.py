"""``fibws topic hz``, ``bw`` and ``delay``; `test_side_by_side` compares them with rostopic."""

from __future__ import annotations

import json
import re
import signal
import struct
import threading
import time
from types import SimpleNamespace
from typing import cast

import pytest
from client.servers import websocket_server
from hub_in_thread import HubThread, Publish, Run
from running_programs import Start
from websockets.sync.server import ServerConnection

from fibws.cli.topic import rates
from fibws.cli.topic.rates import Delay, json_stamp, serialized_stamp
from fibws.client.hub_client import HubClient, RawMessage
from fibws.errors import OperationRejected
from fibws.values.rates import Bandwidth, Summary, bandwidth_text


def test_messages_are_received_between_reports(
    hub: HubThread, publish: Publish, capsys: pytest.CaptureFixture[str]
) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    received: list[RawMessage] = []
    with HubClient("tool", hub.url) as tool:
        rates.subscribe(tool, "/number", received.append)
        assert capsys.readouterr().out == "subscribed to [/number]\n"
        shown: list[list[RawMessage]] = []
        rates.report(tool, lambda: shown.append(list(received)), 2)
    assert shown == [[RawMessage(b"\x08\0\0\0", "std_msgs/Int32")]] * 2


def test_nothing_is_printed_when_quiet(
    hub: HubThread, publish: Publish, capsys: pytest.CaptureFixture[str]
) -> None:
    publish("/number", "std_msgs/Int32")
    with HubClient("tool", hub.url) as tool:
        rates.subscribe(tool, "/number", lambda message: None, quiet=True)
    assert capsys.readouterr().out == ""


def test_refused_operation_is_an_error(hub: HubThread) -> None:
    with HubClient("tool", hub.url) as tool, pytest.raises(OperationRejected):
        tool.send({"op": "subscribe", "topic": "/rosout", "type": "std_msgs/Int33"})
        rates.report(tool, lambda: None)


def test_missed_reports_are_skipped(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = 0.0
    stops = iter([8.25])
    shown: list[float] = []

    def process(seconds: float) -> None:
        nonlocal now
        now += next(stops, seconds)

    monkeypatch.setattr(rates, "PERIOD", 1.0)
    monkeypatch.setattr(rates, "time", SimpleNamespace(monotonic=lambda: now))
    client = cast(HubClient, SimpleNamespace(process=process))
    rates.report(client, lambda: shown.append(now), 3)
    assert shown == [8.25, 9.25, 10.25]


def test_slow_report_does_not_delay_the_next(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = 0.0
    shown: list[float] = []

    def process(seconds: float) -> None:
        nonlocal now
        now += seconds

    def show() -> None:
        nonlocal now
        shown.append(now)
        now += 0.25

    monkeypatch.setattr(rates, "PERIOD", 1.0)
    monkeypatch.setattr(rates, "time", SimpleNamespace(monotonic=lambda: now))
    rates.report(cast(HubClient, SimpleNamespace(process=process)), show, 3)
    assert shown == [1.0, 2.0, 3.0]


def test_hz_reports_missing_messages(run: Run, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32")
    result = run("topic", "hz", "-n", "1", "/number")
    assert (result.exit_code, result.output) == (0, "subscribed to [/number]\nno new messages\n")
    assert run("topic", "hz", "-n", "1", "--json", "/number").output == ""


async def test_rate_is_reported_until_ctrl_c(start: Start, hub: HubThread) -> None:
    words = ("topic", "pub", "-r", "50", "/number", "std_msgs/Int32", "8")
    await start("fibws", *words, FIBWS_HUB=hub.url)
    program = await start("fibws", "topic", "hz", "-w", "20", "/number", FIBWS_HUB=hub.url)
    warning = "WARNING: topic [/number] does not appear to be published yet\n"
    assert await program.line() == "subscribed to [/number]\n"
    lines = [await program.line() for _ in range(4)]
    while not lines[-2].startswith("average"):
        lines.append(await program.line())
    assert re.fullmatch(r"average rate: \d+\.\d{3}\n", lines[-2])
    assert re.fullmatch(
        r"\tmin: \d\.\d{3}s max: \d\.\d{3}s std dev: \d\.\d{5}s window: \d+\n", lines[-1]
    )
    program.send(signal.SIGINT)
    code, _, errors = await program.end()
    assert code == 0
    assert errors in ("", warning)


@pytest.mark.long
async def test_each_of_several_topics_is_reported(start: Start, hub: HubThread) -> None:
    for name in ("/a", "/b"):
        words = ("topic", "pub", "-r", "50", name, "std_msgs/Int32", "8")
        await start("fibws", *words, FIBWS_HUB=hub.url)
    program = await start("fibws", "topic", "hz", "--json", "/a", "/b", FIBWS_HUB=hub.url)
    reports = [json.loads(await program.line()) for _ in range(4)]
    assert {each["topic"] for each in reports} == {"/a", "/b"}
    assert reports[0].keys() == {"topic", "rate", "min", "max", "std_dev", "window"}


def test_field_is_refused(run: Run, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32")
    result = run("topic", "hz", "/number/data")
    assert result.exit_code == 2
    assert "/number/data is a field of /number" in result.output


def test_bandwidth_is_bytes_divided_by_the_time_since_the_oldest() -> None:
    bandwidth = Bandwidth()
    for moment in (10.0, 11.0):
        bandwidth.add(100, moment)
    measured = bandwidth.at(12.0)
    assert measured is not None
    rate, sizes, number = measured
    assert (rate, sizes.mean, number) == (100.0, 100.0, 2)


def test_one_message_has_no_bandwidth() -> None:
    bandwidth = Bandwidth()
    bandwidth.add(2, 0.0)
    assert bandwidth.at(1e9) is None


def test_only_the_latest_sizes_are_measured() -> None:
    bandwidth = Bandwidth(2)
    for size, moment in ((1000, 0.0), (10, 1.0), (20, 2.0)):
        bandwidth.add(size, moment)
    measured = bandwidth.at(2.0)
    assert measured is not None
    assert (measured[0], measured[2]) == (30.0, 2)


@pytest.mark.parametrize(
    ("rate", "printed"),
    [
        (12.0, "average: 12.00B/s\n\tmean: 1500.00B min: 1000.00B max: 2000.00B window: 2"),
        (5340.0, "average: 5.34KB/s\n\tmean: 1.50KB min: 1.00KB max: 2.00KB window: 2"),
        (2.5e6, "average: 2.50MB/s\n\tmean: 0.00MB min: 0.00MB max: 0.00MB window: 2"),
    ],
)
def test_all_numbers_have_the_same_unit(rate: float, printed: str) -> None:
    assert bandwidth_text(rate, Summary(1500, 1000, 2000, 500), 2) == printed


def test_bytes_of_serialized_messages_are_counted(run: Run, publish: Publish) -> None:
    client = publish("/number", "std_msgs/Int32", {"data": 8})

    def publish_more() -> None:
        while not client.call("/rosapi/subscribers", {"topic": "/number"})["subscribers"]:
            pass
        for _ in range(3):
            client.send({"op": "publish", "topic": "/number", "msg": {"data": 8}})

    thread = threading.Thread(target=publish_more)
    thread.start()
    result = run("topic", "bw", "-n", "1", "--json", "/number")
    thread.join(60)
    found = json.loads(result.output)
    assert found["mean"] == found["min"] == found["max"] == 4
    assert 2 <= found["window"] <= 4
    assert found["rate"] > 0


def test_bytes_of_json_are_counted_with_a_plain_rosbridge_server(run: Run) -> None:
    def reply(connection: ServerConnection) -> None:
        for text in connection:
            request = json.loads(text)
            if request["op"] == "subscribe":
                assert "compression" not in request
                for _ in range(2):
                    connection.send('{"op":"publish","topic":"/number","msg":{"data":8}}')
            elif request["op"] == "call_service":
                is_known = request["service"] == "/rosapi/topic_type"
                response = {"op": "service_response", "id": request["id"], "result": is_known}
                response["values"] = {"type": "std_msgs/Int32"} if is_known else "unknown"
                connection.send(json.dumps(response))

    with websocket_server(reply) as url:
        result = run("topic", "bw", "-n", "1", "--json", "--hub", url, "/number")
    found = json.loads(result.output)
    assert found["mean"] == found["min"] == found["max"] == len('{"data":8}')
    assert found["window"] == 2


@pytest.mark.parametrize(
    "message",
    [
        b'{"header":{"seq":1,"stamp":{"secs":2,"nsecs":3},"frame_id":""},"point":null}',
        b'{"header":{"stamp":{"secs":2,"nsecs":3},"frame_id":""},"point":null}',
        b'{"point":null,"header":{"stamp":{"nsecs":3,"secs":2}}}',
    ],
)
def test_stamp_is_read_from_json(message: bytes) -> None:
    assert json_stamp(message) == json_stamp(memoryview(message)) == 2_000_000_003


@pytest.mark.parametrize("message", [b'{"data":8}', b'{"header":8}', b'{"header":{}}'])
def test_json_without_a_stamp_has_none(message: bytes) -> None:
    assert json_stamp(message) is None


def test_stamp_is_read_from_a_serialized_header() -> None:
    message = struct.pack("<IIII", 1, 2, 3, 0)
    assert serialized_stamp(memoryview(message)) == 2_000_000_003
    assert serialized_stamp(message[:11]) is None
    assert serialized_stamp(memoryview(message)[4:], has_seq=False) == 2_000_000_003
    assert serialized_stamp(message[:7], has_seq=False) is None


def test_serialized_messages_of_another_type_are_ignored() -> None:
    delay = Delay()
    delay.type = "std_msgs/Header"
    message = struct.pack("<IIII", 1, 2, 3, 0)
    delay.receive(RawMessage(message, "shape_msgs/Plane"))
    assert delay.poll() is None
    delay.receive(RawMessage(message, "std_msgs/Header"))
    assert delay.poll() is not None


def test_poll_returns_nothing_without_new_messages() -> None:
    delay = Delay()
    assert delay.poll() is None
    delay.add(0.5)
    delay.add(1.5)
    polled = delay.poll()
    assert polled is not None
    assert (polled[0].mean, polled[1]) == (1.0, 2)
    assert delay.poll() is None


def test_delay_is_the_time_since_the_stamp(run: Run, publish: Publish) -> None:
    header = {"stamp": {"secs": int(time.time()) - 100, "nsecs": 0}}
    publish("/point", "geometry_msgs/PointStamped", {"header": header})
    result = run("topic", "delay", "-n", "1", "/point")
    head, average, rest = result.output.splitlines()
    assert head == "subscribed to [/point]"
    assert 99 <= float(average.removeprefix("average delay: ")) < 199
    assert rest.startswith("\tmin: 1")
    found = json.loads(run("topic", "delay", "-n", "1", "--json", "/point").output)
    assert found.keys() == {"topic", "delay", "min", "max", "std_dev", "window"}


def test_delay_reports_missing_messages(run: Run, publish: Publish) -> None:
    publish("/point", "geometry_msgs/PointStamped")
    result = run("topic", "delay", "-n", "2", "/point")
    assert result.output.splitlines()[-1] == "no new messages"


def test_type_without_a_header_is_an_error(run: Run, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    result = run("topic", "delay", "/number")
    assert result.exit_code == 1
    assert "header: std_msgs/Int32" in result.stderr
