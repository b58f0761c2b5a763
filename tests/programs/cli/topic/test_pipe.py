"""Messages from standard input, as they are piped in."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from typing import Any, TextIO

import click
import pytest

from fibws.cli.link import Link
from fibws.cli.topic import pipe
from fibws.cli.topic.publisher import Publisher
from fibws.errors import OperationRejected


@pytest.fixture
def publisher(link: Link) -> Publisher:
    return Publisher(link, "/number", "std_msgs/Int32", latch=False)


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
    publisher.link.send({"op": "publish", "topic": "/number", "msg": {"data": "x"}})
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
    with pytest.raises(click.UsageError, match="no YAML"):
        list(pipe.documents(publisher))
