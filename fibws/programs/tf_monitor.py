"""Prints the delays of transforms and the rates of their broadcasters."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import click

import fibws
from fibws.cli import node_program
from fibws.msg.tf2_msgs import TFMessage
from fibws.tf.buffer import MAX_FRAMES, Buffer, frame_id
from fibws.tf.errors import InvalidTransform, TransformError
from fibws.tf.history import LATEST
from fibws.tf.listener import TransformListener

PERIOD = 0.2
"""Seconds between two reports."""
PAUSE = 0.01
MOST = 1000
"""Delays of each frame that are averaged."""


def _delays() -> deque[float]:
    return deque(maxlen=MOST)


@dataclass(slots=True)
class _Broadcaster:
    delays: deque[float] = field(default_factory=_delays)
    times: deque[float] = field(default_factory=_delays)


class Monitor:
    """The delays of frames and broadcasters: the ages of transforms when they arrive."""

    def __init__(self) -> None:
        self._frames: dict[str, tuple[str, deque[float]]] = {}
        self._broadcasters: dict[str, _Broadcaster] = {}

    def add(self, message: TFMessage, broadcaster: str, now: float) -> None:
        """Note a message.

        Args:
            broadcaster: the node that sent it.
            now: the current time in seconds.
        """
        delays = []
        for transform in message.transforms:
            delays.append(now - transform.header.stamp.to_nanoseconds() / 1e9)
            frame = transform.child_frame_id
            if frame in self._frames or len(self._frames) < MAX_FRAMES:
                _, known = self._frames.get(frame, ("", _delays()))
                known.append(delays[-1])
                self._frames[frame] = (broadcaster, known)
        if broadcaster in self._broadcasters or len(self._broadcasters) < MAX_FRAMES:
            entry = self._broadcasters.setdefault(broadcaster, _Broadcaster())
            entry.delays.append(sum(delays) / max(1, len(delays)))
            entry.times.append(now)

    def report(self, frames: Sequence[str] | None = None) -> str:
        """Return the delays of some frames, or of all, and of all broadcasters."""
        lines = ["", "Frames:"]
        for frame, (broadcaster, delays) in sorted(self._frames.items()):
            if frames is None or frame.removeprefix("/") in frames:
                lines.append(f"Frame: {frame} published by {broadcaster} {_summary(delays)}")
        lines += ["", "All Broadcasters:"]
        for name, entry in sorted(self._broadcasters.items()):
            rate = len(entry.times) / max(1e-8, entry.times[-1] - entry.times[0])
            lines.append(f"Node: {name} {rate:g} Hz, {_summary(entry.delays)}")
        return "\n".join(lines)


class Chain:
    """The delay of the transform between two frames: average and maximum."""

    def __init__(self, buffer: Buffer, first: str, second: str) -> None:
        self._buffer = buffer
        self._first, self._second = first, second
        self._average = self._longest = 0.0
        self.frames: list[str] = []

    def find(self) -> bool:
        """Find the frames of the chain; return whether there is one."""
        try:
            self.frames = self._buffer.chain(
                self._second, LATEST, self._first, LATEST, self._second
            )
        except TransformError:
            return False
        return True

    def measure(self, now: float) -> None:
        """Note the current delay."""
        try:
            stamp = self._buffer.latest_common_time(self._first, self._second)
        except TransformError:
            return
        delay = now - stamp / 1e9 if stamp else 0.0
        self._average = 0.01 * delay + 0.99 * self._average
        self._longest = max(self._longest, delay)

    def report(self) -> str:
        """Return the frames and the delays."""
        return (
            f"RESULTS: for {self._first} to {self._second}\n"
            f"Chain is: {' -> '.join(self.frames)}\n"
            f"Net delay     avg = {self._average:g}: max = {self._longest:g}"
        )


async def monitor(node: fibws.Node, frames: Sequence[str], report: Callable[..., None]) -> None:
    """Print the delays until the node ends.

    Args:
        frames: the two ends of a chain, or none for all frames.
        report: prints a text; ``nl=False`` without a line's end.
    """
    buffer, delays = Buffer(), Monitor()
    messages = node.subscribe("/tf", TFMessage, queue_size=100, headers=True)

    async def receive() -> None:
        async for message in messages:
            name = messages.connection_header.get("callerid", "unknown")
            delays.add(message, name, _now(node))

    async def print_reports() -> None:
        chain = Chain(buffer, *frames) if frames else None
        if chain is not None:
            report(
                f"Waiting for transform chain to become available between {frames[0]} and "
                f"{frames[1]} ",
                nl=False,
            )
            tries = 0
            while not chain.find():
                tries += 1
                if tries % round(1 / PAUSE) == 0:
                    report(".", nl=False)
                await asyncio.sleep(PAUSE)
            report("")
        while True:
            for _ in range(round(PERIOD / PAUSE)):
                await asyncio.sleep(PAUSE)
                if chain is not None:
                    chain.measure(_now(node))
            head = "RESULTS: for all Frames" if chain is None else chain.report()
            shown = None if chain is None else chain.frames
            report(f"\n\n\n{head}\n{delays.report(shown)}")

    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(TransformListener(node, buffer).run())
        printing = tasks.create_task(print_reports())
        await receive()
        printing.cancel()


def _now(node: fibws.Node) -> float:
    return node.now().to_nanoseconds() / 1e9


def _summary(delays: Sequence[float]) -> str:
    average, longest = sum(delays) / len(delays), max(0.0, *delays)
    return f"Average Delay: {average:g} Max Delay: {longest:g}"


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("tf_monitor", arguments="[SOURCE_FRAME TARGET_FRAME]")
def command(node: fibws.Node, arguments: tuple[str, ...]) -> None:
    """Print how late transforms arrive, and how often each node sends some.

    With two frames, only the frames between them are listed.
    """
    if len(arguments) not in (0, 2):
        raise click.UsageError(
            f"expected no frames, or SOURCE_FRAME TARGET_FRAME, got {len(arguments)} arguments"
        )
    try:
        frames = [frame_id(argument) for argument in arguments]
    except InvalidTransform as error:
        raise click.UsageError(str(error)) from None

    async def program() -> None:
        async with node:
            await monitor(node, frames, click.echo)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.tf_monitor")
