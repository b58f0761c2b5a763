"""``fibws topic hz``; `test_side_by_side` compares its output with rostopic's."""

from __future__ import annotations

import json
import re
import signal

from fibws.cli.topic.hz import Rate, table

from ...conftest import Start
from ..conftest import HubThread, Publish, Run


def test_rate_is_computed_from_the_intervals() -> None:
    rate = Rate()
    for moment in (1.0, 1.5, 2.0):
        rate.add(moment)
    polled = rate.poll()
    assert polled is not None
    hz, deltas, number = polled
    assert (hz, deltas.least, deltas.most, number) == (2.0, 0.5, 0.5, 3)


def test_poll_returns_nothing_without_new_messages() -> None:
    rate = Rate()
    assert rate.poll() is None
    rate.add(1.0)
    assert rate.poll() is None, "one message has no rate"
    rate.add(2.0)
    assert rate.poll() is not None
    assert rate.poll() is None
    rate.add(3.0)
    assert rate.poll() is not None


def test_only_the_latest_messages_are_measured() -> None:
    rate = Rate(window=2)
    for moment in (0.0, 10.0, 11.0):
        rate.add(moment)
    polled = rate.poll()
    assert polled is not None
    assert (polled[0], polled[2]) == (1.0, 2)


def test_rate_of_simultaneous_messages_is_0() -> None:
    rate = Rate()
    rate.add(1.0)
    rate.add(1.0)
    polled = rate.poll()
    assert polled is not None
    assert polled[0] == 0.0


def test_table_columns_are_aligned() -> None:
    assert table([["/x", "1.0", "1.0", "1.0", "0.0", "2"]]).splitlines() == [
        "topic   rate   min_delta   max_delta   std_dev   window",
        "=" * 55,
        "/x      1.0    1.0         1.0         0.0       2     ",
    ]


def test_missing_messages_are_reported(run: Run, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32")
    result = run("topic", "hz", "-n", "1", "/number")
    assert (result.exit_code, result.output) == (0, "subscribed to [/number]\nno new messages\n")
    assert run("topic", "hz", "-n", "1", "--json", "/number").output == ""


async def test_rate_is_reported_until_ctrl_c(start: Start, hub: HubThread) -> None:
    words = ("topic", "pub", "-r", "50", "/number", "std_msgs/Int32", "8")
    await start("fibws", *words, FIBWS_HUB=hub.url)
    program = await start("fibws", "topic", "hz", "-w", "20", "/number", FIBWS_HUB=hub.url)
    warning = "WARNING: topic [/number] does not appear to be published yet\n"
    said = await program.line()
    assert said == "subscribed to [/number]\n"
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


async def test_each_of_several_topics_is_reported(start: Start, hub: HubThread) -> None:
    for name in ("/a", "/b"):
        words = ("topic", "pub", "-r", "50", name, "std_msgs/Int32", "8")
        await start("fibws", *words, FIBWS_HUB=hub.url)
    program = await start("fibws", "topic", "hz", "--json", "/a", "/b", FIBWS_HUB=hub.url)
    rates = [json.loads(await program.line()) for _ in range(4)]
    assert {rate["topic"] for rate in rates} == {"/a", "/b"}
    assert rates[0].keys() == {"topic", "rate", "min", "max", "std_dev", "window"}


def test_a_field_is_refused(run: Run, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32")
    result = run("topic", "hz", "/number/data")
    assert result.exit_code == 2
    assert "/number/data is a field of /number: name a topic." in result.output
