"""Messages from standard input, as they are piped in."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from typing import Any, TextIO

import click
import pytest

from fibws.cli.topic import pipe
from fibws.cli.topic.publisher import Publisher
from fibws.client.hub_client import HubClient
from fibws.errors import InvalidValue, OperationRejected


@pytest.fixture
def publisher(client: HubClient) -> Publisher:
    return Publisher(client, "/number", "std_msgs/Int32", latch=False)


@pytest.fixture
def piped(monkeypatch: pytest.MonkeyPatch) -> Iterator[TextIO]:
    """What is written to it comes on standard input."""
    reading, writing = os.pipe()
    with open(reading, encoding="utf-8") as stdin, open(writing, "w", encoding="utf-8") as written:
        monkeypatch.setattr(sys, "stdin", stdin)
        yield written


def test_a_message_ends_with_three_hyphens(publisher: Publisher, piped: TextIO) -> None:
    documents = pipe.documents(publisher)
    print("data: 1\n---\ndata:", file=piped, end="", flush=True)
    assert next(documents) == {"data": 1}
    print(" 2\n---", file=piped, flush=True)
    assert next(documents) == {"data": 2}
    print("data: 3", file=piped)
    piped.close()
    assert list(documents) == [{"data": 3}]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows cannot wait for a pipe and a socket")
def test_the_hub_is_heeded_meanwhile(publisher: Publisher, piped: TextIO) -> None:
    publisher.client.send({"op": "publish", "topic": "/number", "msg": {"data": "x"}})
    with pytest.raises(OperationRejected):
        next(pipe.documents(publisher))


def test_what_is_no_file_of_the_system_is_read_whole(
    publisher: Publisher, monkeypatch: pytest.MonkeyPatch
) -> None:
    stdin: Any = io.StringIO("---\ndata: 1\n---\n\n")
    monkeypatch.setattr(sys, "stdin", stdin)
    assert list(pipe.documents(publisher)) == [None, {"data": 1}]


def test_what_is_no_yaml_is_an_error(publisher: Publisher, piped: TextIO) -> None:
    print("{", file=piped)
    piped.close()
    with pytest.raises(InvalidValue, match="Invalid YAML"):
        list(pipe.documents(publisher))


@pytest.mark.parametrize("text", ["data: 5", "data: 5\n", "data:\n  5"])
def test_what_has_no_end_is_not_kept_for_ever(
    text: str, publisher: Publisher, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pipe, "MOST_CHARACTERS", 1_000)
    taken = 0

    def endless(publisher: Publisher) -> Iterator[str]:
        nonlocal taken
        while True:
            yield text
            taken += len(text)

    monkeypatch.setattr(pipe, "_texts", endless)
    with pytest.raises(click.UsageError, match="more than 1000 characters: write a line of ---"):
        list(pipe.documents(publisher))
    assert taken <= 1_000


def test_many_messages_may_have_more_than_one_may(
    publisher: Publisher, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pipe, "MOST_CHARACTERS", 10)
    stdin: Any = io.StringIO("data: 1\n---\n" * 5)
    monkeypatch.setattr(sys, "stdin", stdin)
    assert list(pipe.documents(publisher)) == [{"data": 1}] * 5
