"""``fibws topic hz``; `test_side_by_side` compares its output with rostopic's."""

from __future__ import annotations

import json
import re
import signal

from hub_in_thread import HubThread, Publish, Run
from running_programs import Start


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
