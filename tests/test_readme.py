"""The README's code, run as a reader would run it."""

from __future__ import annotations

import asyncio
import dataclasses
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from fibws.hub import Hub, Settings

README = (Path(__file__).parents[1] / "README.md").read_text()
PROGRAMS = {
    found["node"]: found[0].strip("`").removeprefix("python\n")
    for found in re.finditer(r"```python\n[^`]*fibws\.Node\(\"(?P<node>\w+)\"\)[^`]*```", README)
}
"""By the names of their nodes."""
DEFINITION = re.search(r"`(fibonacci/msg/Fibonacci\.msg)`:\n\n```text\n(.*?)```", README, re.DOTALL)


async def start(program: str, hub: Hub, folder: Path) -> asyncio.subprocess.Process:
    return await asyncio.create_subprocess_exec(
        sys.executable,
        "-c",
        program,
        stdout=asyncio.subprocess.PIPE,
        env={**os.environ, "FIBWS_HUB": hub.url, "FIBWS_INTERFACES": str(folder)},
    )


async def line_with(text: str, process: asyncio.subprocess.Process) -> str:
    assert process.stdout is not None
    async for line in process.stdout:
        if text in line.decode():
            return line.decode()
    raise AssertionError(f"the program ended before it printed {text!r}")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    assert DEFINITION is not None
    path = tmp_path / DEFINITION[1]
    path.parent.mkdir(parents=True)
    path.write_text(DEFINITION[2])
    return tmp_path


async def test_the_listener_hears_the_talker(folder: Path) -> None:
    talker, listener = PROGRAMS["talker"], PROGRAMS["listener"]
    async with Hub(Settings(port=0)) as hub:
        processes = [await start(talker, hub, folder), await start(listener, hub, folder)]
        try:
            assert "I heard hello world" in await line_with("I heard", processes[1])
        finally:
            for process in processes:
                process.terminate()
                await process.wait()


@pytest.mark.parametrize(
    ("node", "lines"),
    [
        ("adder", ["1 + 2 = 3", "last: 3 of ['/adder/last', ", "topics: {"]),
        ("counter", ["so far: [0, 1, 1]", "in all: [0, 1, 1, 2, 3, 5, 8]"]),
    ],
)
async def test_what_a_node_does_for_itself_is_printed(
    node: str, lines: list[str], folder: Path
) -> None:
    async with Hub(Settings(port=0)) as hub:
        process = await start(PROGRAMS[node], hub, folder)
        for line in lines:
            await line_with(line, process)
        assert await process.wait() == 0


def test_all_programs_are_tested() -> None:
    assert PROGRAMS.keys() == {"talker", "listener", "adder", "counter", "indexed_broadcaster"}
    assert len(PROGRAMS) == README.count("```python")


async def test_a_definition_of_ones_own_goes_from_end_to_end(folder: Path) -> None:
    async with Hub(Settings(port=0, interfaces=(folder,))) as hub:
        process = await start(PROGRAMS["indexed_broadcaster"], hub, folder)
        try:
            await line_with("F(10) = 55", process)
            topic = hub.graph.topics["/indexed"]
            assert topic.type is not None
            assert topic.type.name == "fibonacci/Fibonacci"
        finally:
            process.terminate()
            await process.wait()


def test_the_generated_module_of_ones_own_package_can_be_used(folder: Path) -> None:
    command = "-m fibws.interfaces.generator --interfaces . fibonacci"
    assert f"python {command}" in README
    source = subprocess.run(
        [sys.executable, *command.split()], cwd=folder, check=True, capture_output=True, text=True
    ).stdout
    (folder / "fibonacci_msgs.py").write_text(source)
    check = "from fibonacci_msgs import Fibonacci; print(Fibonacci(index=7, value=13))"
    said = subprocess.run(
        [sys.executable, "-c", check], cwd=folder, check=True, capture_output=True, text=True
    ).stdout
    assert said == "Fibonacci(index=7, value=13)\n"


def test_the_table_of_settings_is_that_of_the_code() -> None:
    rows = re.findall(r"^\| `--([a-z-]+)` \| `?([^|`]*)`? \| (.*) \|$", README, re.MULTILINE)
    assert rows == [
        (setting.name.replace("_", "-"), written(setting.default), setting.metadata["help"])
        for setting in dataclasses.fields(Settings)
    ]


def written(default: object) -> str:
    if isinstance(default, float):
        return f"{default:g}"
    return "" if default == () else str(default).lower()
