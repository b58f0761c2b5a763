"""``fibws topic pub``."""

from __future__ import annotations

import io
import os
import signal
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import repeat
from pathlib import Path
from types import SimpleNamespace
from typing import Any, TextIO

import click
import pytest
from hub_in_thread import HubThread, Publish, Run
from running_programs import Start

from fibws.cli.topic import pub
from fibws.cli.topic.pub import TopicPublisher
from fibws.client.hub_client import HubClient
from fibws.errors import InvalidValue, OperationRejected


@pytest.fixture
def received(client: HubClient) -> Callable[[], list[Any]]:
    """Return the data published on /number since the last call."""
    client.subscribe("/number")
    client.call("/rosapi/get_time")

    def received() -> list[Any]:
        client.call("/rosapi/get_time")
        return [message["data"] for message in client.messages("/number", 0)]

    return received


@pytest.fixture(autouse=True)
def no_lingering(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pub, "LINGER", 0.01)


def test_one_message_is_published(run: Run, received: Callable[[], list[Any]]) -> None:
    result = run("topic", "pub", "-1", "number", "std_msgs/Int32", "data: 8")
    assert result.exit_code == 0
    assert result.output == "publishing and latching message for 0.01 seconds\n"
    assert received() == [8]


def test_verbose_prints_the_message(run: Run) -> None:
    result = run("topic", "pub", "-1", "-v", "/number", "std_msgs/Int32", "8")
    assert result.output == "publishing and latching [data: 8] for 0.01 seconds\n"


def test_values_may_begin_with_a_minus(run: Run, received: Callable[[], list[Any]]) -> None:
    assert run("topic", "pub", "-1", "/number", "std_msgs/Int32", "--", "-8").exit_code == 0
    assert received() == [-8]


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
    assert next(messages) != next(messages), "-s reads now again for each message"
    program.send(signal.SIGINT)
    code, _, errors = await program.end()
    assert (code, errors) == (0, "")


def test_values_are_read_from_standard_input(run: Run, received: Callable[[], list[Any]]) -> None:
    words = ("topic", "pub", "-r", "1000", "/number", "std_msgs/Int32")
    result = run(*words, input="data: 1\n---\n[2]\n---\n3\n")
    assert (result.exit_code, result.output) == (0, "")
    assert received() == [1, 2, 3]


def test_output_of_echo_can_be_published(
    run: Run, publish: Publish, received: Callable[[], list[Any]]
) -> None:
    publish("/source", "std_msgs/Int32", {"data": 8})
    printed = run("topic", "echo", "-n", "1", "/source").output
    assert run("topic", "pub", "/number", "std_msgs/Int32", input=printed).exit_code == 0
    assert received() == [8]


def test_once_publishes_the_first_message(run: Run, received: Callable[[], list[Any]]) -> None:
    words = ("topic", "pub", "-1", "/number", "std_msgs/Int32")
    assert run(*words, input="data: 1\n---\ndata: 2\n").exit_code == 0
    assert received() == [1]


def test_file_has_messages(run: Run, received: Callable[[], list[Any]], tmp_path: Path) -> None:
    file = tmp_path / "messages.yaml"
    file.write_text("data: 1\n---\ndata: 2\n", "utf-8")
    words = ("topic", "pub", "-r", "1000", "-f", str(file), "/number", "std_msgs/Int32")
    assert run(*words).exit_code == 0
    assert received() == [1, 2]
    file.write_text("", "utf-8")
    assert "contains no message" in run(*words).output


async def test_only_message_of_a_file_is_repeated(
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


def test_message_with_no_fields_needs_no_values(run: Run) -> None:
    assert run("topic", "pub", "-1", "/go", "std_msgs/Empty").exit_code == 0


@pytest.mark.parametrize(
    ("words", "code", "fact"),
    [
        (["/x", "std_msgs/Strin", "a"], 1, "did you mean std_msgs/String?"),
        (["/x", "String", "a"], 2, "did you mean std_msgs/String?"),
        (["/x", "std_msgs/Int32", "-5"], 2, "-- -5"),
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


@pytest.fixture
def subscriber(hub: HubThread, client: HubClient) -> HubClient:
    """A client that subscribes to /number."""
    client.subscribe("/number")
    client.call("/rosapi/get_time")
    return client


def test_publish_waits_for_the_hub(hub: HubThread, subscriber: HubClient) -> None:
    with HubClient("pub", hub.url) as client:
        publisher = TopicPublisher(client, "/number", "std_msgs/Int32", latch=False)
        publisher.publish({"data": 8})
        subscriber.call("/rosapi/get_time")
        assert next(subscriber.messages("/number", 0)) == {"data": 8}


def test_messages_are_published_at_a_rate(hub: HubThread, subscriber: HubClient) -> None:
    with HubClient("pub", hub.url) as client:
        publisher = TopicPublisher(client, "/number", "std_msgs/Int32", latch=False)
        began = time.monotonic()
        publisher.publish_all(repeat({"data": 8}, 5), 50)
        assert time.monotonic() - began >= 0.1
        subscriber.call("/rosapi/get_time")
        assert len(list(subscriber.messages("/number", 0))) == 5


def test_pause_between_messages_is_not_made_up_for(
    publisher: TopicPublisher, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A burst of all that should have been sent meanwhile would surprise a robot."""
    now = 0.0
    published: list[float] = []

    def process(seconds: float) -> None:
        nonlocal now
        now += max(0.0, seconds)

    def messages() -> Iterator[dict[str, Any]]:
        nonlocal now
        for number in range(10):
            if number == 5:
                now += 100  # Such as for a line of standard input.
            yield {"data": number}

    monkeypatch.setattr(pub, "time", SimpleNamespace(monotonic=lambda: now))
    monkeypatch.setattr(publisher.client, "send", lambda _: published.append(now))
    monkeypatch.setattr(publisher.client, "process", process)
    monkeypatch.setattr(publisher.client, "call", lambda _: None)
    publisher.publish_all(messages(), 10)
    assert published[:6] == pytest.approx([0, 0.1, 0.2, 0.3, 0.4, 100.5])
    assert max(Counter(published).values()) <= 2
    assert published[-1] == pytest.approx(100.8)


def test_refused_operations_are_errors(hub: HubThread) -> None:
    messages: list[dict[str, Any]] = [{"data": 1}, {"data": "x"}]
    with HubClient("pub", hub.url) as client:
        with pytest.raises(OperationRejected, match="did you mean std_msgs/String"):
            TopicPublisher(client, "/x", "std_msgs/Strin", latch=False)
        publisher = TopicPublisher(client, "/number", "std_msgs/Int32", latch=False)
        with pytest.raises(OperationRejected, match="field data"):
            publisher.publish({"data": "x"})
        with pytest.raises(OperationRejected, match="field data"):
            publisher.publish_all(iter(messages), 1000)


def test_unknown_type_is_a_warning(hub: HubThread, capsys: pytest.CaptureFixture[str]) -> None:
    with HubClient("pub", hub.url) as client:
        TopicPublisher(client, "/odd", "unknown_msgs/Type", latch=False).publish({"a": 1})
    assert "unknown_msgs/Type" in capsys.readouterr().err


@pytest.fixture
def publisher(client: HubClient) -> TopicPublisher:
    return TopicPublisher(client, "/number", "std_msgs/Int32", latch=False)


@pytest.fixture
def stdin(monkeypatch: pytest.MonkeyPatch) -> Iterator[TextIO]:
    """Write to standard input."""
    reading, writing = os.pipe()
    with open(reading, encoding="utf-8") as stdin, open(writing, "w", encoding="utf-8") as written:
        monkeypatch.setattr(sys, "stdin", stdin)
        yield written


def test_line_of_hyphens_ends_a_message(publisher: TopicPublisher, stdin: TextIO) -> None:
    documents = pub.documents_from_stdin(publisher)
    print("data: 1\n---\ndata:", file=stdin, end="", flush=True)
    assert next(documents) == {"data": 1}
    print(" 2\n---", file=stdin, flush=True)
    assert next(documents) == {"data": 2}
    print("data: 3", file=stdin)
    stdin.close()
    assert list(documents) == [{"data": 3}]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows cannot wait for a pipe and a socket")
def test_hub_s_messages_are_processed_meanwhile(publisher: TopicPublisher, stdin: TextIO) -> None:
    publisher.client.send({"op": "publish", "topic": "/number", "msg": {"data": "x"}})
    with pytest.raises(OperationRejected):
        next(pub.documents_from_stdin(publisher))


def test_input_without_a_file_descriptor_is_read_whole(
    publisher: TopicPublisher, monkeypatch: pytest.MonkeyPatch
) -> None:
    stdin: Any = io.StringIO("---\ndata: 1\n---\n\n")
    monkeypatch.setattr(sys, "stdin", stdin)
    assert list(pub.documents_from_stdin(publisher)) == [None, {"data": 1}]


def test_invalid_yaml_is_an_error(publisher: TopicPublisher, stdin: TextIO) -> None:
    print("{", file=stdin)
    stdin.close()
    with pytest.raises(InvalidValue, match="Invalid YAML"):
        list(pub.documents_from_stdin(publisher))


@pytest.mark.parametrize("text", ["data: 5", "data: 5\n", "data:\n  5"])
def test_endless_messages_are_refused(
    text: str, publisher: TopicPublisher, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pub, "MAX_CHARACTERS", 1_000)
    taken = 0

    def endless(publisher: TopicPublisher) -> Iterator[str]:
        nonlocal taken
        while True:
            yield text
            taken += len(text)

    monkeypatch.setattr(pub, "_chunks", endless)
    with pytest.raises(click.UsageError, match="limit: 1000 "):
        list(pub.documents_from_stdin(publisher))
    assert taken <= 1_000


def test_limit_is_that_of_one_message(
    publisher: TopicPublisher, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pub, "MAX_CHARACTERS", 10)
    stdin: Any = io.StringIO("data: 1\n---\n" * 5)
    monkeypatch.setattr(sys, "stdin", stdin)
    assert list(pub.documents_from_stdin(publisher)) == [{"data": 1}] * 5
