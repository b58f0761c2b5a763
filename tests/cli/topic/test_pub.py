"""``fibws topic pub``."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hub_in_thread import HubThread, Publish, Run
from running_programs import Start

from fibws.cli.topic import pub
from fibws.client.hub_client import HubClient


@pytest.fixture
def heard(client: HubClient) -> Callable[[], list[Any]]:
    """Gives what was published on /number since the last time."""
    client.subscribe("/number")
    client.call("/rosapi/get_time")

    def heard() -> list[Any]:
        client.call("/rosapi/get_time")
        return [message["data"] for message in client.messages("/number", 0)]

    return heard


@pytest.fixture(autouse=True)
def no_lingering(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pub, "LINGER", 0.01)


def test_one_message_is_published(run: Run, heard: Callable[[], list[Any]]) -> None:
    result = run("topic", "pub", "-1", "number", "std_msgs/Int32", "data: 8")
    assert result.exit_code == 0
    assert result.output == "publishing and latching message for 0.01 seconds\n"
    assert heard() == [8]


def test_verbose_prints_the_message(run: Run) -> None:
    result = run("topic", "pub", "-1", "-v", "/number", "std_msgs/Int32", "8")
    assert result.output == "publishing and latching [data: 8] for 0.01 seconds\n"


def test_values_may_begin_with_a_minus(run: Run, heard: Callable[[], list[Any]]) -> None:
    assert run("topic", "pub", "-1", "/number", "std_msgs/Int32", "--", "-8").exit_code == 0
    assert heard() == [-8]


async def test_it_stays_and_latches_until_ctrl_c(
    start: Start, hub: HubThread, publish: Publish, client: HubClient
) -> None:
    words = ("topic", "pub", "/number", "std_msgs/Int32", "8")
    program = await start("fibws", *words, FIBWS_HUB=hub.url)
    said = "publishing and latching message. Press ctrl-C to terminate\n"
    assert await program.line() == said
    client.subscribe("/number")
    assert next(client.messages("/number", 20)) == {"data": 8}
    program.send(signal.SIGINT)
    assert await program.end() == (0, "", "")


async def test_at_a_rate_it_goes_on_and_on(start: Start, hub: HubThread, client: HubClient) -> None:
    words = ("topic", "pub", "-r", "100", "-v", "/time", "std_msgs/Time", "now", "-s")
    program = await start("fibws", *words, FIBWS_HUB=hub.url)
    assert await program.line() == "publishing data: \n"
    client.subscribe("/time")
    messages = client.messages("/time", 20)
    assert next(messages) != next(messages), "-s reads now anew"
    program.send(signal.SIGINT)
    code, _, errors = await program.end()
    assert (code, errors) == (0, "")


def test_without_values_they_are_piped_in(run: Run, heard: Callable[[], list[Any]]) -> None:
    words = ("topic", "pub", "-r", "1000", "/number", "std_msgs/Int32")
    result = run(*words, input="data: 1\n---\n[2]\n---\n3\n")
    assert (result.exit_code, result.output) == (0, "")
    assert heard() == [1, 2, 3]


def test_what_echo_prints_can_be_piped_in(
    run: Run, publish: Publish, heard: Callable[[], list[Any]]
) -> None:
    publish("/source", "std_msgs/Int32", {"data": 8})
    printed = run("topic", "echo", "-n", "1", "/source").output
    assert run("topic", "pub", "/number", "std_msgs/Int32", input=printed).exit_code == 0
    assert heard() == [8]


def test_of_several_one_is_published_once(run: Run, heard: Callable[[], list[Any]]) -> None:
    words = ("topic", "pub", "-1", "/number", "std_msgs/Int32")
    assert run(*words, input="data: 1\n---\ndata: 2\n").exit_code == 0
    assert heard() == [1]


def test_a_file_has_messages(run: Run, heard: Callable[[], list[Any]], tmp_path: Path) -> None:
    file = tmp_path / "messages.yaml"
    file.write_text("data: 1\n---\ndata: 2\n", "utf-8")
    words = ("topic", "pub", "-r", "1000", "-f", str(file), "/number", "std_msgs/Int32")
    assert run(*words).exit_code == 0
    assert heard() == [1, 2]
    file.write_text("", "utf-8")
    assert "There is no message in" in run(*words).output


async def test_the_only_message_of_a_file_is_repeated(
    start: Start, hub: HubThread, client: HubClient, tmp_path: Path
) -> None:
    file = tmp_path / "message.yaml"
    file.write_text("data: 8\n", "utf-8")
    words = ("topic", "pub", "-r", "100", "-f", str(file), "/number", "std_msgs/Int32")
    program = await start("fibws", *words, FIBWS_HUB=hub.url)
    assert await program.line() == "Got one message and a rate, publishing repeatedly\n"
    client.subscribe("/number")
    messages = client.messages("/number", 20)
    assert next(messages) == next(messages) == {"data": 8}


def test_a_message_with_no_fields_needs_no_values(run: Run) -> None:
    assert run("topic", "pub", "-1", "/go", "std_msgs/Empty").exit_code == 0


@pytest.mark.parametrize(
    ("words", "code", "fact"),
    [
        (["/x", "std_msgs/Strin", "a"], 1, "did you mean std_msgs/String?"),
        (["/x", "String", "a"], 2, "did you mean std_msgs/String?"),
        (["/x", "std_msgs/Int32", "-5"], 2, "-5 is taken for options: write -- before the"),
        (["/x", "std_msgs/Int32", "3000000000"], 1, "for field data"),
        (["/rosout", "std_msgs/Int32", "1"], 1, "already established with type"),
        (["/x y", "std_msgs/Int32", "1"], 1, "is not a legal name"),
        (["/x-y", "std_msgs/Int32", "1"], 1, "is not a legal name"),
        (["/x", "std_msgs/Int32", "{dta: 1}"], 2, "did you mean data?"),
        (["/x", "std_msgs/Int32", "{"], 2, "Invalid YAML"),
        (["/x", "std_msgs/Int32", "1", "-r", "0"], 2, "0.0 is not in the range"),
        (["/x", "std_msgs/Int32", "1", "-1", "-r", "1"], 2, "both -r and -1"),
        (["/x", "std_msgs/Int32", "1", "-f", __file__], 2, "args conflict with -f"),
    ],
)
def test_errors_are_reported(run: Run, words: list[str], code: int, fact: str) -> None:
    result = run("topic", "pub", *words)
    assert result.exit_code == code
    assert fact in result.stderr
    assert result.stderr.splitlines()[-1].startswith("Error: ")
