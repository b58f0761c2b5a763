"""Prints the transform between two frames, again and again."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from math import degrees, inf
from typing import NamedTuple

import click

import fibws
from fibws.cli import node_program
from fibws.tf.buffer import Buffer, frame_id
from fibws.tf.errors import InvalidTransform, TransformError
from fibws.tf.history import LATEST, Sample, seconds
from fibws.tf.listener import TransformListener
from fibws.tf.transform import roll_pitch_yaw

PATIENCE = 1.0
"""Seconds to wait for the first transform before a failure is printed, as in tf."""


def text_of(sample: Sample, precision: int = 3) -> str:
    """Return a transform as tf_echo prints it: translation, quaternion and angles."""

    def numbers(*values: float) -> str:
        return ", ".join(f"{value:.{precision}f}" for value in values)

    (x, y, z), rotation = sample.transform
    angles = roll_pitch_yaw(rotation)
    return (
        f"At time {sample.stamp / 1e9:.3f}\n"
        f"- Translation: [{numbers(x, y, z)}]\n"
        f"- Rotation: in Quaternion [{numbers(*rotation)}]\n"
        f"            in RPY (radian) [{numbers(*angles)}]\n"
        f"            in RPY (degree) [{numbers(*map(degrees, angles))}]"
    )


class Moment(NamedTuple):
    """Which transform to look up: by default the latest."""

    offset: float | None = None
    """Seconds from now."""
    time: float | None = None
    """Seconds since 1970."""

    def stamp(self, node: fibws.Node) -> int:
        """Return the time in nanoseconds; 0 for the latest."""
        if self.time is not None:
            return int(self.time * 1e9)
        if self.offset is not None:
            return node.now().to_nanoseconds() + int(self.offset * 1e9)
        return LATEST


LATEST_MOMENT = Moment()


async def echo(
    node: fibws.Node,
    buffer: Buffer,
    target: str,
    source: str,
    rate: float,
    report: Callable[[str], None],
    moment: Moment = LATEST_MOMENT,
    count: float = inf,
    precision: int = 3,
) -> None:
    """Print the transform of ``source`` in ``target`` until the node ends.

    Args:
        buffer: an empty buffer.
        rate: how often, in Hz of the node's time.
        report: prints a text.
        moment: which transform.
        count: end after so many texts.
        precision: decimals of the numbers.
    """
    async with TransformListener(node, buffer) as listener:
        with suppress(TransformError):
            await listener.wait(target, source, timeout=PATIENCE)
        async for _ in node.rate(rate):
            listener.check()
            try:
                report(text_of(buffer.lookup(target, source, moment.stamp(node)), precision))
            except TransformError as error:
                report(
                    f"Failure at {seconds(node.now().to_nanoseconds())}\n"
                    f"Exception thrown:{error}\n"
                    f"The current list of frames is:\n{buffer.listing()}"
                )
            count -= 1
            if count <= 0:
                break


@click.command(context_settings=node_program.SETTINGS)
@click.option("-r", "--rate", type=float, help="Transforms per second.  [default: 1]")
@click.option("-c", "--cache_time", type=float, help="Seconds to keep.  [default: 10]")
@click.option("-o", "--offset", type=float, help="Look up the time so many seconds from now.")
@click.option("-t", "--time", type=float, help="Look up this time, in seconds since 1970.")
@click.option("-l", "--limit", type=click.IntRange(1), help="Number of transforms to print.")
@click.option(
    "-p",
    "--precision",
    type=click.IntRange(1, 15),
    default=3,
    show_default=True,
    help="Decimals to print.",
)
@node_program.node("tf_echo", arguments="SOURCE_FRAME TARGET_FRAME [RATE]")
def command(
    node: fibws.Node,
    arguments: tuple[str, ...],
    rate: float | None,
    cache_time: float | None,
    offset: float | None,
    time: float | None,
    limit: int | None,
    precision: int,
) -> None:
    """Print where TARGET_FRAME is in SOURCE_FRAME, RATE times a second (default: 1).

    A point in TARGET_FRAME is turned and then moved by these numbers, to be one in SOURCE_FRAME.
    Without --offset and --time, the latest transform is printed.
    """
    if not 2 <= len(arguments) <= 3:
        raise click.UsageError(
            f"expected SOURCE_FRAME TARGET_FRAME [RATE], got {len(arguments)} arguments"
        )
    target, source, *rest = arguments
    try:
        frame_id(target)
        frame_id(source)
        rate = float(rest[0]) if rest else 1.0 if rate is None else rate
    except InvalidTransform as error:
        raise click.UsageError(str(error)) from None
    except ValueError:
        raise click.UsageError(f"RATE must be a number, got {rest[0]!r}") from None
    for name, number in (("RATE", rate), ("--cache_time", cache_time)):
        if number is not None and not 0 < number < inf:
            raise click.UsageError(f"{name} must be > 0, got {number:g}")
    moment = Moment(offset=offset, time=time)
    buffer = Buffer() if cache_time is None else Buffer(cache_time)

    async def program() -> None:
        async with node:
            await echo(
                node, buffer, target, source, rate, click.echo, moment, limit or inf, precision
            )

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.tf_echo")
