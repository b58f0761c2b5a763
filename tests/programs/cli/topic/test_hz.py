"""``fibws topic hz``; rostopic's own text is in `test_side_by_side`."""

from __future__ import annotations

import json
import re
import signal

from fibws.cli.topic.hz import Rate, table

from ...conftest import Start
from ..conftest import HubThread, Publish, Run


def test_a_rate_is_of_the_time_between_messages() -> None:
    rate = Rate()
    for moment in (1.0, 1.5, 2.0):
        rate.take(moment)
    news = rate.news()
    assert news is not None
    hz, deltas, number = news
    assert (hz, deltas.least, deltas.most, number) == (2.0, 0.5, 0.5, 3)


def test_what_was_told_is_no_news() -> None:
    rate = Rate()
    assert rate.news() is None
    rate.take(1.0)
    assert rate.news() is None, "one message has no rate"
    rate.take(2.0)
    assert rate.news() is not None
    assert rate.news() is None
    rate.take(3.0)
    assert rate.news() is not None


def test_only_the_newest_messages_count() -> None:
    rate = Rate(window=2)
    for moment in (0.0, 10.0, 11.0):
        rate.take(moment)
    news = rate.news()
    assert news is not None
    assert (news[0], news[2]) == (1.0, 2)


def test_messages_at_one_moment_have_no_rate() -> None:
    rate = Rate()
    rate.take(1.0)
    rate.take(1.0)
    news = rate.news()
    assert news is not None
    assert news[0] == 0.0


def test_a_table_has_its_columns_in_line() -> None:
    assert table([["/x", "1.0", "1.0", "1.0", "0.0", "2"]]).splitlines() == [
        "topic   rate   min_delta   max_delta   std_dev   window",
        "=" * 55,
        "/x      1.0    1.0         1.0         0.0       2     ",
    ]


def test_silence_is_told(run: Run, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32")
    result = run("topic", "hz", "-n", "1", "/number")
    assert (result.exit_code, result.output) == (0, "subscribed to [/number]\nno new messages\n")
    assert run("topic", "hz", "-n", "1", "--json", "/number").output == ""


async def test_the_rate_is_told_until_ctrl_c(start: Start, hub: HubThread) -> None:
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


async def test_several_topics_make_a_table(start: Start, hub: HubThread) -> None:
    for name in ("/a", "/b"):
        words = ("topic", "pub", "-r", "50", name, "std_msgs/Int32", "8")
        await start("fibws", *words, FIBWS_HUB=hub.url)
    program = await start("fibws", "topic", "hz", "--json", "/a", "/b", FIBWS_HUB=hub.url)
    rates = [json.loads(await program.line()) for _ in range(4)]
    assert {rate["topic"] for rate in rates} == {"/a", "/b"}
    assert rates[0].keys() == {"topic", "rate", "min", "max", "std_dev", "window"}


def test_a_field_has_no_rate(run: Run, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32")
    result = run("topic", "hz", "/number/data")
    assert result.exit_code == 2
    assert "/number/data is a field of /number: name a topic." in result.output
