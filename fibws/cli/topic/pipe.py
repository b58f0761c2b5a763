"""Messages from standard input, as they are piped in."""

from __future__ import annotations

import os
import select
import sys
from codecs import getincrementaldecoder
from collections.abc import Iterator
from typing import Any

import click

from fibws.cli.topic.publisher import Publisher
from fibws.values import parsing

MOST_CHARACTERS = 2**26
"""Of one message: no hub takes longer ones, unless it is set to."""
_CHUNK = 2**16


def documents(publisher: Publisher) -> Iterator[Any]:
    """The YAML values that come on standard input, each once its end is known.

    It ends with a line of ``---`` or with the input. Meanwhile what the hub sends is processed: it
    disconnects clients that answer no pings.

    Raises:
        UsageError: it is no YAML, or there is no end of it.
        OperationRejected: the hub has refused something.
        HubLost: there is no hub any more.
    """
    lines: list[str] = []
    size = 0
    for line in _lines(publisher):
        if line.strip() == "---":
            yield parsing.parse("".join(lines))
            lines, size = [], 0
        else:
            lines.append(line)
            size = _more(size, line)
    if any(line.strip() for line in lines):
        yield parsing.parse("".join(lines))


def _lines(publisher: Publisher) -> Iterator[str]:
    begun: list[str] = []
    size = 0
    for text in _texts(publisher):
        *ends, rest = text.split("\n")
        for end in ends:
            yield "".join([*begun, end, "\n"])
            begun, size = [], 0
        begun.append(rest)
        size = _more(size, rest)
    yield "".join(begun)


def _more(size: int, text: str) -> int:
    """The size with that of a text; one that is too large raises `UsageError`."""
    size += len(text)
    if size > MOST_CHARACTERS:
        raise click.UsageError(
            f"A message has more than {MOST_CHARACTERS} characters: "
            "write a line of --- between one message and the next"
        )
    return size


def _texts(publisher: Publisher) -> Iterator[str]:
    try:
        number = sys.stdin.fileno()
    except OSError:  # It is no file of the system's, so nobody needs to wait for it.
        yield sys.stdin.read()
        return
    decoder = getincrementaldecoder("utf-8")("replace")
    while True:
        # Windows cannot wait for a pipe in this way.
        ready = [number]
        if sys.platform != "win32":
            ready, _, _ = select.select([number, publisher.client], [], [])
        if publisher.client in ready:
            publisher.client.process(0)
        if number in ready:
            data = os.read(number, _CHUNK)
            yield decoder.decode(data, final=not data)
            if not data:
                return
