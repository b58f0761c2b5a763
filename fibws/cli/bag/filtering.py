"""``fibws bag filter``: copy some of a bag's messages to a new bag."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from fibws.bags import Connection, Reader, Writer, open_writer
from fibws.bags.ros2_messages import CDR, ROS1, with_encoding
from fibws.bags.rosbag2 import MCAP_SUFFIX
from fibws.cli import output
from fibws.cli.bag.bag_messages import BagMessage, BagType, check_new_name, open_bag, warn
from fibws.cli.bag.progress import Progress
from fibws.cli.common_options import examples
from fibws.cli.exit_handling import clean_exit, exit_on_signals
from fibws.errors import BagError, InvalidValue
from fibws.files import replacing
from fibws.suggestions import suggestion
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
@click.option(
    "--encoding",
    type=click.Choice([ROS1, CDR]),
    help="Convert messages to those of ROS 1, or to cdr, those of ROS 2. The default is ros1 for "
    ".bag; for .mcap, messages are copied as they are.",
)
@click.option("-q", "--quiet", is_flag=True, help="Print warnings and errors only.")
@examples(
    "{bag filter} lab.bag turns.bag \"topic == '/cmd_vel' and m.angular.z != 0\"",
    '{bag filter} lab.bag part.bag "t.secs >= 1700000000 and t.to_sec() < 1700000060.5"',
    "{bag filter} lab.bag scans.mcap --topic /scan --start 10 --end 20",
    ("{bag filter} rosbag2_folder lab.bag True", "from ROS 2 to ROS 1"),
    ("{bag filter} lab.bag lab.mcap True --encoding cdr", "from ROS 1 to ROS 2"),
)
def command(
    source: Path,
    target: Path,
    expression: str | None,
    topics: tuple[str, ...],
    start: float | None,
    end: float | None,
    shown: str | None,
    encoding: str | None,
    quiet: bool,
) -> None:
    """Copy the messages of INBAG for which a Python EXPRESSION is true to OUTBAG.

    INBAG is a file, or a folder that rosbag2 of ROS 2 has recorded.

    EXPRESSION may use topic, the name of the topic; m, the message; and t, its time: t.secs,
    t.nsecs, t.to_sec(). Its syntax is that of Python, without anything that could reach beyond the
    message. A name that ends in .mcap makes an MCAP file.
    """
    with clean_exit():
        condition = Condition(expression) if expression is not None else None
        pattern = Condition(shown, "--print") if shown is not None else None
        check_new_name(target)
        if target.is_dir():
            raise click.UsageError(f"{target} is a folder; name a file, such as {target}.bag")
        if target.exists() and source.exists() and source.samefile(target):
            raise click.UsageError(f"Cannot use same file as input and output [{source}]")
        if condition is None and not topics and start is None and end is None and not encoding:
            raise click.UsageError(
                "You must specify an expression, --topic, --start or --end; True copies all."
            )
        if target.suffix != MCAP_SUFFIX:
            if encoding == CDR:
                raise click.UsageError("--encoding cdr needs an OUTBAG that ends in .mcap.")
            encoding = ROS1
        with exit_on_signals(), open_bag(source) as original, replacing(target) as new:
            _check_topics(topics, original)
            _check_times(start, end, original)
            reader = original if encoding is None else with_encoding(original, encoding)
            copied = [
                each
                for each in reader.connections
                if each.id not in reader.not_converted and (not topics or each.topic in topics)
            ]
            _report_conversion(reader, topics)
            if original.others:
                others = output.counted(original.others, "other record")
                warn(f"{source} has {others} (attachments, metadata); only messages are copied")
            with (
                open_writer(
                    new, _compression(reader, target), profile=_profile(copied), name=target
                ) as writer,
                Progress(target, quiet=quiet) as progress,
            ):
                copy = Copy(reader, writer, condition, pattern)
                copy.run(
                    progress,
                    copied,
                    None if start is None else reader.start + round(start * 1e9),
                    None if end is None else reader.start + round(end * 1e9),
                )
            hint = "" if condition is None else condition.unknown_topic(original)
            total = output.counted(reader.message_count, "message")
        if not copy.count:
            warn(f"no message passed the filter, {target} is empty{hint}")
        elif not quiet:
            click.echo(output.visible(f"{target}: {copy.count} of {total}"), err=True)


def _check_topics(topics: tuple[str, ...], reader: Reader) -> None:
    """Raise a UsageError for a topic that a bag does not have."""
    known = {each.topic for each in reader.connections}
    for topic in topics:
        if topic not in known:
            listed = ", ".join(sorted(known)) or "none"
            fault = f"the bag has no topic {topic}{suggestion(topic, known)}; it has {listed}"
            raise click.UsageError(f"--topic: {fault}")


def _check_times(start: float | None, end: float | None, reader: Reader) -> None:
    """Raise a UsageError for times between which a bag cannot have messages."""
    seconds = (reader.end - reader.start) / 1e9 if reader.message_count else 0.0
    if start is not None and start > seconds:
        raise click.UsageError(f"--start must be within the {seconds:.3f} s of the bag")
    if end is not None and end < max(0.0, start or 0.0):
        raise click.UsageError("--end must not be before --start; both count from the bag's start")


def _report_conversion(reader: Reader, topics: tuple[str, ...]) -> None:
    """Say which topics are left out, and which types are not those of ROS 1."""
    found = {each.id: each for each in reader.connections if not topics or each.topic in topics}
    left_out = [id_ for id_ in reader.not_converted if id_ in found]
    if left_out and len(left_out) == len(found):
        raise BagError(f"nothing can be converted: {reader.not_converted[left_out[0]]}")
    for id_ in left_out:
        warn(f"left out: {reader.not_converted[id_]}")
    for each in reader.differences:
        warn(f"{each}: nodes with ROS 1's definition cannot receive it")


def _compression(reader: Reader, target: Path) -> str:
    """Return the compression for a copy: that of the bag, if the format has it."""
    if reader.compression == "bz2" and target.suffix == MCAP_SUFFIX:
        return "zstd"  # Each format has one that the other one lacks.
    if reader.compression == "zstd" and target.suffix != MCAP_SUFFIX:
        return "bz2"
    return reader.compression


def _profile(connections: Sequence[Connection]) -> str:
    """Return the profile of an MCAP file with the messages of some connections."""
    encodings = {each.encoding for each in connections} or {ROS1}
    return {CDR: "ros2", ROS1: "ros1"}.get(encodings.pop(), "") if len(encodings) == 1 else ""


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
        self.count = 0
        """How many messages have been copied."""

    def run(
        self,
        progress: Progress,
        connections: Sequence[Connection] | None = None,
        start: int | None = None,
        end: int | None = None,
    ) -> None:
        """Copy the messages of some connections, or of all, and of some times (ns)."""
        progress.begin(sum(chunk.size for chunk in self._reader.chunks))
        for connection, time, data in self._reader.messages(
            None, start, end, connections=connections
        ):
            if self._passes(connection, time, data):
                if connection.id not in self._connections:
                    copied = self._writer.copy_connection(connection)
                    self._connections[connection.id] = copied
                self._writer.write(self._connections[connection.id], time, data)
                self.count += 1
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

    Args:
        name: names the expression in errors.

    Raises:
        InvalidValue: the text is not an expression, or uses something else.
    """

    def __init__(self, text: str, name: str = "the expression") -> None:
        self._text, self._name = text, name
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
            raise InvalidValue(f"{self._name} failed for a message on {place}: {error}") from None

    def unknown_topic(self, reader: Reader) -> str:
        """Return a hint if the expression compares with a name that no topic of a bag has."""
        known = {each.topic for each in reader.connections}
        for node in ast.walk(ast.parse(self._text.strip(), mode="eval")):
            match node:
                case ast.Constant(str(name)) if name.startswith("/") and name not in known:
                    return f": the bag has no topic {name}{suggestion(name, known)}"
        return ""

    def _variable(self, expression: ast.expr) -> Value | None:
        match expression:
            case ast.Name("topic"):
                return lambda message: message.connection.topic
            case ast.Name("m"):
                return lambda message: message.fields
            case ast.Attribute(ast.Name("t"), name) if name in _SECONDS:
                return lambda message: _seconds(message.time, name)
            case ast.Name("t"):
                raise InvalidValue("t is a time: write t.to_sec(), t.secs or t.nsecs")
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
