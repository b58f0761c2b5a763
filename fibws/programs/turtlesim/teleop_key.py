"""Drives a turtle with the keys of a terminal."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Iterator

import click

import fibws
from fibws.cli import node_program
from fibws.cli.keyboard import reading_keys
from fibws.msg.geometry_msgs import Twist, Vector3

HELP = """Reading from keyboard
---------------------------
Use arrow keys to move the turtle. 'q' to quit."""
LINEAR, ANGULAR = 2.0, 2.0
"""Meters and radians per second, unless the parameters say otherwise."""
DIRECTIONS = {"up": (1.0, 0.0), "down": (-1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}
"""The direction of each key: forwards, and to the left."""
_ARROWS = ("up", "down", "right", "left")
_SEQUENCES = {
    f"{start}{letter}": key
    for start, letters in (("\x1b[", "ABCD"), ("\x1bO", "ABCD"), ("\xe0", "HPMK"))
    for letter, key in zip(letters, _ARROWS, strict=True)
}
"""The arrow keys of terminals: ECMA-48's cursor sequences, and those of Windows."""


def keys(text: str) -> Iterator[str]:
    """Yield the keys in what a terminal sends: ``up``, ``left`` and so on, and characters."""
    while text:
        sequence = text[: 2 if text[0] == "\xe0" else 3]
        key = _SEQUENCES.get(sequence)
        yield key or text[0]
        text = text[len(sequence) if key else 1 :]


async def drive(node: fibws.Node) -> None:
    """Publish a velocity for each arrow key, until ``q`` or the end of the input.

    Raises:
        ClickException: the standard input is not a terminal.
    """
    if not sys.stdin.isatty():
        raise click.ClickException("turtle_teleop_key reads keys: start it in a terminal")
    linear = float(await node.params.get("scale_linear", LINEAR))
    angular = float(await node.params.get("scale_angular", ANGULAR))
    velocities = await node.advertise("turtle1/cmd_vel", Twist, queue_size=1)
    typed: asyncio.Queue[str | None] = asyncio.Queue()
    with reading_keys(typed.put_nowait):
        click.echo(HELP)
        while (text := await typed.get()) is not None:
            for key in keys(text):
                if key in ("q", "Q", "\x04"):
                    return
                if key in DIRECTIONS:
                    forwards, left = DIRECTIONS[key]
                    twist = Twist(Vector3(x=linear * forwards), Vector3(z=angular * left))
                    await velocities.publish(twist)


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("teleop_turtle", anonymous=False)
def command(node: fibws.Node) -> None:
    """Drive turtle1 with the arrow keys; q ends the program.

    The parameters scale_linear and scale_angular are its speeds (2 m/s and 2 rad/s). To drive
    another turtle: turtle1/cmd_vel:=turtle2/cmd_vel.
    """

    async def program() -> None:
        async with node:
            await drive(node)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.turtlesim.teleop_key")
