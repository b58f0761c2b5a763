"""``fibws bag filter``: copy some of a bag's messages to a new bag."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from fibws.bags import Connection, Reader, Writer, open_writer
from fibws.cli import output
from fibws.cli.bag.bag_messages import BagMessage, BagType, open_bag
from fibws.cli.bag.progress import Progress
from fibws.cli.common_options import examples
from fibws.cli.exit_handling import clean_exit
from fibws.errors import InvalidValue
from fibws.files import replacing
from fibws.values.expressions import FUNCTIONS, Expression, Value

_SECONDS = ("to_sec", "to_nsec", "secs", "nsecs")


@click.command()
@click.argument("source", metavar="INBAG", type=click.Path(path_type=Path))
@click.argument("target", metavar="OUTBAG", type=click.Path(path_type=Path))
@click.argument("expression", required=False)
@click.option(
    "--topic", "topics", metavar="TOPIC", multiple=True, help="Copy only TOPIC; may be repeated."
)
@click.option(
    "-s", "--start", metavar="SEC", type=float, help="Copy from SEC seconds after the bag's start."
)
@click.option(
    "--end", metavar="SEC", type=float, help="Copy until SEC seconds after the bag's start."
)
@click.option(
    "-p", "--print", "shown", metavar="EXPRESSION", help="Print an expression for each message."
)
@click.option("-q", "--quiet", is_flag=True, help="Do not show the progress.")
@examples(
    "{bag filter} lab.bag turns.bag \"topic == '/cmd_vel' and m.angular.z != 0\"",
    '{bag filter} lab.bag part.bag "t.secs >= 1700000000 and t.to_sec() < 1700000060.5"',
    "{bag filter} lab.bag scans.mcap --topic /scan --start 10 --end 20",
)
def command(
    source: Path,
    target: Path,
    expression: str | None,
    topics: tuple[str, ...],
    start: float | None,
    end: float | None,
    shown: str | None,
    quiet: bool,
) -> None:
    """Copy the messages of INBAG for which a Python EXPRESSION is true to OUTBAG.

    EXPRESSION may use topic, the name of the topic; m, the message; and t, its time: t.secs,
    t.nsecs, t.to_sec(). Its syntax is that of Python, without anything that could reach beyond the
    message. A name that ends in .mcap makes an MCAP file.
    """
    with clean_exit():
        condition = Condition(expression) if expression is not None else None
        pattern = Condition(shown) if shown is not None else None
        if target.exists() and source.exists() and source.samefile(target):
            raise click.UsageError(f"Cannot use same file as input and output [{source}]")
        if condition is None and not topics and start is None and end is None:
            raise click.UsageError("You must specify an expression, --topic, --start or --end.")
        with open_bag(source) as reader, replacing(target) as new:
            unknown = set(topics) - {each.topic for each in reader.connections}
            if unknown:
                known = ", ".join(sorted({each.topic for each in reader.connections}))
                fault = f"the bag has no topic {min(unknown)}; it has {known or 'none'}"
                raise click.UsageError(f"--topic: {fault}")
            compression = reader.compression
            if compression == "bz2" and target.suffix == ".mcap":
                compression = "zstd"  # Each format has one that the other one lacks.
            elif compression == "zstd" and target.suffix != ".mcap":
                compression = "bz2"
            with open_writer(new, compression) as writer, Progress(target, quiet=quiet) as progress:
                copy = Copy(reader, writer, condition, pattern)
                copy.run(
                    progress,
                    topics or None,
                    None if start is None else reader.start + round(start * 1e9),
                    None if end is None else reader.start + round(end * 1e9),
                )


class Copy:
    """Copies messages from a bag to another one.

    Args:
        condition: which messages to copy; all if None.
        pattern: what to print for each message.
    """

    def __init__(
        self,
        reader: Reader,
        writer: Writer,
        condition: Condition | None = None,
        pattern: Condition | None = None,
    ) -> None:
        self._reader = reader
        self._writer = writer
        self._condition = condition
        self._pattern = pattern
        self._types: dict[int, BagType] = {}
        self._connections: dict[int, Connection] = {}

    def run(
        self,
        progress: Progress,
        topics: tuple[str, ...] | None = None,
        start: int | None = None,
        end: int | None = None,
    ) -> None:
        """Copy the messages of some topics and times (ns)."""
        progress.begin(sum(chunk.size for chunk in self._reader.chunks))
        for connection, time, data in self._reader.messages(topics, start, end):
            if self._passes(connection, time, data):
                if connection.id not in self._connections:
                    copied = self._writer.copy_connection(connection)
                    self._connections[connection.id] = copied
                self._writer.write(self._connections[connection.id], time, data)
            progress.add(len(data))
        progress.finish()

    def _passes(self, connection: Connection, time: int, data: bytes) -> bool:
        if self._condition is None and self._pattern is None:
            return True
        if connection.id not in self._types:
            self._types[connection.id] = BagType(connection)
        message = BagMessage(connection, time, data, self._types[connection.id])
        passes = self._condition is None or bool(self._condition.value(message))
        if self._pattern is not None:
            output.line(f"{'MATCH' if passes else 'NO MATCH'} {self._pattern.value(message)}")
        return passes


class Condition:
    """An expression on a topic, a message ``m`` and its time ``t``, in the syntax of Python.

    Raises:
        InvalidValue: the text is not an expression, or uses something else.
    """

    def __init__(self, text: str) -> None:
        self._expression = Expression(_without_calls(text), FUNCTIONS, self._variable)

    def value(self, message: BagMessage) -> Any:
        """Return the value for a message.

        Raises:
            InvalidValue: a field does not exist, or an operation is impossible.
            BagError: the message is needed, and cannot be decoded.
        """
        try:
            return self._expression.value(message)
        except InvalidValue as error:
            place = f"{message.connection.topic} ({message.connection.type})"
            raise InvalidValue(f"the expression failed for a message on {place}: {error}") from None

    def _variable(self, expression: ast.expr) -> Value | None:
        match expression:
            case ast.Name("topic"):
                return lambda message: message.connection.topic
            case ast.Name("m"):
                return lambda message: message.fields
            case ast.Attribute(ast.Name("t"), name) if name in _SECONDS:
                return lambda message: _seconds(message.time, name)
            case ast.Attribute(value, name) if above := self._variable(value):
                return _of(above, lambda value: _attribute(value, name))
            case ast.Subscript(value, index) if above := self._variable(value):
                number = _number(index)
                if number is not None:
                    return _of(above, operator.itemgetter(number))
        return None


def _of(above: Value, function: Callable[[Any], Any]) -> Value:
    """Return what computes a part of another value."""
    return lambda message: function(above(message))


def _number(expression: ast.expr) -> int | None:
    """Return a number in the brackets of an expression; other ones are computed elsewhere."""
    match expression:
        case ast.Constant(int(number)):
            return number
        case ast.UnaryOp(ast.USub(), ast.Constant(int(number))):
            return -number
    return None


def _without_calls(text: str) -> str:
    """Return an expression in which the methods of times are attributes: ``t.to_sec``."""
    try:
        tree = ast.parse(text.strip(), mode="eval")
        return ast.unparse(_Calls().visit(tree))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return text  # The expression reports it.


class _Calls(ast.NodeTransformer):
    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        match node:
            case ast.Call(ast.Attribute(_, "to_sec" | "to_nsec") as function, [], []):
                return function
        return node


def _attribute(value: Any, name: str) -> Any:
    """Return a field of a message, or a part of a time."""
    if not isinstance(value, dict):
        raise InvalidValue(f"no field {name} in a {type(value).__name__}")
    if name in value:
        found = value[name]
        return list(found) if isinstance(found, bytes) else found
    if name in _SECONDS and value.keys() == {"secs", "nsecs"}:
        return _seconds(value["secs"] * 1_000_000_000 + value["nsecs"], name)
    raise InvalidValue(f"no field {name}; expected {', '.join(value) or 'none'}")


def _seconds(time: int, name: str) -> float | int:
    parts: dict[str, Callable[[], float | int]] = {
        "to_sec": lambda: time / 1e9,
        "to_nsec": lambda: time,
        "secs": lambda: time // 1_000_000_000,
        "nsecs": lambda: time % 1_000_000_000,
    }
    return parts[name]()
