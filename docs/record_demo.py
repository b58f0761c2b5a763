"""Record the demo, and commands beside it, as an animated SVG: python docs/record_demo.py

It writes docs/images/demo.svg, with the commands of this checkout, and takes some 15 s.
"""

from __future__ import annotations

import asyncio
import os
import shlex
import signal
import socket
import sys
import time
from html import escape
from pathlib import Path
from typing import NamedTuple

PICTURE = Path(__file__).parent / "images" / "demo.svg"
DEMO = "python -m fibws demo"
COMMANDS = [
    "fibws topic list",
    "fibws topic echo -n 2 /fibonacci",
    "fibws topic info /fibonacci",
    "fibws graph",
]
"""Commands in a second terminal, while the demo runs in the first."""
PAUSE = 1.2
"""Seconds before each of them."""
REST = 4.0
"""Seconds for which the end is shown."""
ROWS, COLUMNS = (9, 13), 88
"""The sizes of both terminals."""
LINE, CHARACTER, MARGIN = 19, 8.43, 14
"""Pixels of a line, a character, and around the text."""
STYLE = """\
text { font: 14px ui-monospace, SFMono-Regular, Menlo, Consolas, 'DejaVu Sans Mono', monospace;
  fill: #d7dde5; white-space: pre; }
.typed { fill: #8fd0ff; }
rect { fill: #16202b; }
g, text { animation-duration: %gs; animation-iteration-count: infinite;
  animation-timing-function: step-end; }
@media (prefers-reduced-motion: reduce) { g, text { animation: none !important; } }
"""


class Line(NamedTuple):
    """A line in one of the terminals, and when it appeared, in seconds."""

    time: float
    text: str
    is_typed: bool = False


class Recorder:
    """Runs commands, and records what appears in a terminal.

    Args:
        began: when the recording began, by `time.monotonic`.
        port: the port of the hub, which is shown as the default.
    """

    def __init__(self, began: float, port: int) -> None:
        self.lines: list[Line] = []
        self.heard = asyncio.Event()
        """Set once the listener has heard something."""
        self._began = began
        self._port = port

    def note(self, text: str, *, is_typed: bool = False) -> None:
        """Record a line that appears now."""
        shown = text.replace(f":{self._port}", ":9090")
        self.lines.append(Line(time.monotonic() - self._began, shown, is_typed))
        if "I heard" in text:
            self.heard.set()

    async def start(self, command: str) -> asyncio.subprocess.Process:
        """Start a command."""
        self.note(command, is_typed=True)
        words = shlex.split(command)
        modules = words[2:] if words[0] == "python" else words
        hub = {"FIBWS_PORT": str(self._port), "FIBWS_HUB": f"ws://127.0.0.1:{self._port}"}
        return await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", *modules),
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT,
            env=os.environ | hub | {"PYTHONUNBUFFERED": "1", "COLUMNS": str(COLUMNS)},
        )

    async def follow(self, process: asyncio.subprocess.Process) -> None:
        """Record what a command prints, until it ends."""
        assert process.stdout is not None
        async for line in process.stdout:
            self.note(line.decode().rstrip("\n"))
        await process.wait()


async def record() -> list[list[Line]]:
    """Run the demo and the commands; return the lines of both terminals."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    began = time.monotonic()
    first, second = Recorder(began, port), Recorder(began, port)
    demo = await first.start(DEMO)
    following = asyncio.create_task(first.follow(demo))
    await first.heard.wait()
    for command in COMMANDS:
        await asyncio.sleep(PAUSE)
        await second.follow(await second.start(command))
    await asyncio.sleep(PAUSE)
    demo.send_signal(signal.SIGINT)
    await following
    return [first.lines, second.lines]


def picture(terminals: list[list[Line]]) -> str:
    """Return the recording as an SVG, which repeats for ever."""
    duration = max(lines[-1].time for lines in terminals) + REST
    width = round(2 * MARGIN + COLUMNS * CHARACTER)
    heights = [2 * MARGIN + rows * LINE for rows in ROWS]
    total = sum(heights) + MARGIN * (len(heights) - 1)
    parts, styles, top = [], [STYLE % duration], 0
    for number, (lines, rows, height) in enumerate(zip(terminals, ROWS, heights, strict=True)):
        steps = {0.0: 0}
        texts = []
        for index, line in enumerate(lines):
            percent = round(100 * line.time / duration, 2)
            name = f"l{number}-{index}"
            styles.append(
                f"@keyframes {name} {{ 0% {{ opacity: 0 }} {percent}% {{ opacity: 1 }} }}"
            )
            steps[percent] = -LINE * max(0, index + 1 - rows)
            text, kind = escape(line.text[:COLUMNS], quote=False), ""
            if line.is_typed:
                text, kind = f"$ {text}", ' class="typed"'
            y = LINE * (index + 0.75)
            texts.append(
                f'<text{kind} x="{MARGIN}" y="{y:g}" style="animation-name: {name}">{text}</text>'
            )
        moves = " ".join(f"{at:g}% {{ transform: translateY({y}px) }}" for at, y in steps.items())
        end = -LINE * max(0, len(lines) - rows)
        styles.append(f"@keyframes t{number} {{ {moves} }}")
        parts += [
            f'<svg y="{top}" width="{width}" height="{height}">',
            '<rect width="100%" height="100%" rx="8"/>',
            f'<svg y="{MARGIN}" width="{width}" height="{rows * LINE}">',
            f'<g style="animation-name: t{number}; transform: translateY({end}px)">',
            *texts,
            "</g></svg></svg>",
        ]
        top += height + MARGIN
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {total}">',
            "<title>The demo in one terminal, and commands in another</title>",
            *("<style>", *(each.rstrip() for each in styles), "</style>"),
            *parts,
            "</svg>\n",
        ]
    )


if __name__ == "__main__":
    PICTURE.write_text(picture(asyncio.run(record())), "utf-8")
    print(f"{PICTURE}: {PICTURE.stat().st_size} bytes")
