"""The code, commands, files and links in README.md and docs/."""

from __future__ import annotations

import ast
import asyncio
import dataclasses
import os
import re
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from importlib import import_module
from inspect import isawaitable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import click
import pytest

import fibws
from docs import record_demo
from fibws.cli.commands import command as fibws_command
from fibws.cli.hub import HubCommands
from fibws.command_names import ALIASES
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.hub.settings import flag_of
from fibws.msg.geometry_msgs import TransformStamped, Twist
from fibws.msg.std_msgs import Float64, Header, String
from fibws.msg.tf2_msgs import TFMessage
from fibws.testing import wait_until

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"
DOCS = ROOT / "docs"
PAGES = {path: path.read_text("utf-8") for path in (README, *sorted(DOCS.glob("*.md")))}
NODES = PAGES[README] + re.sub(
    r"^## Testing$.*?(?=^## )", "", PAGES[DOCS / "python-nodes.md"], flags=re.MULTILINE | re.DOTALL
)
"""The pages with programs, without the section that tests/test_testing.py runs."""
PROGRAMS = {
    found["node"]: found[0].strip("`").removeprefix("python\n")
    for found in re.finditer(r"```python\n[^`]*?fibws\.Node\(\"(?P<node>\w+)\"[^`]*```", NODES)
}
"""By the names of their nodes."""
DEFINITION = re.search(r"`(fibonacci/msg/Fibonacci\.msg)`:\n\n```text\n(.*?)```", NODES, re.DOTALL)


# The programs.


async def start(program: str, hub: HubServer, folder: Path) -> asyncio.subprocess.Process:
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


async def test_tracker_logs_where_the_robot_is(folder: Path) -> None:
    async with HubServer(Settings(port=0)) as hub, fibws.Node("robot", hub=hub.url) as node:
        tf = await node.advertise("/tf", TFMessage, latch=True)
        base = TransformStamped(Header(stamp=fibws.Time(7), frame_id="map"), "base_link")
        base.transform.translation.x, base.transform.rotation.w = 1.5, 1.0
        await tf.publish([base])
        process = await start(PROGRAMS["tracker"], hub, folder)
        try:
            line = await line_with("x =", process)
            assert "at 7.00 s: x = 1.50 m, y = 0.00 m" in line
        finally:
            process.kill()
            await process.wait()


async def test_listener_receives_what_talker_publishes(folder: Path) -> None:
    talker, listener = PROGRAMS["talker"], PROGRAMS["listener"]
    async with HubServer(Settings(port=0)) as hub:
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
        ("adder", ["1 + 2 = 3", "topics: {"]),
        ("configured", ["speed: 0.5", "rate: 10", "/robot/color"]),
        ("counter", ["so far: [0, 1, 1]", "in all: [0, 1, 1, 2, 3, 5, 8]"]),
    ],
)
async def test_node_that_calls_itself_prints_the_results(
    node: str, lines: list[str], folder: Path
) -> None:
    async with HubServer(Settings(port=0)) as hub:
        process = await start(PROGRAMS[node], hub, folder)
        for line in lines:
            await line_with(line, process)
        assert await process.wait() == 0


async def test_filter_publishes_what_it_makes_of_messages(folder: Path) -> None:
    async with HubServer(Settings(port=0)) as hub, fibws.Node("test", hub=hub.url) as node:
        rough = await node.advertise("rough", Float64, latch=True)
        await rough.publish(8.0)
        process = await start(PROGRAMS["smoother"], hub, folder)
        try:
            smooth = await node.wait_for_message("smooth", Float64)
            assert smooth.data == 8.0
        finally:
            process.terminate()
            assert await process.wait() == 0


async def test_several_nodes_run_in_one_process(folder: Path) -> None:
    async with HubServer(Settings(port=0)) as hub, fibws.Node("test", hub=hub.url) as node:
        process = await start(PROGRAMS["sum"], hub, folder)
        try:
            await line_with("total: ", process)
            assert {"/left", "/right", "/sum"} <= {*await node.graph.nodes()}
        finally:
            process.terminate()
            assert await process.wait() == 0


async def test_node_cleans_up_when_it_is_stopped(folder: Path) -> None:
    async with HubServer(Settings(port=0)) as hub, fibws.Node("test", hub=hub.url) as node:
        speeds = node.subscribe("cmd_vel", Twist)
        process = await start(PROGRAMS["driver"], hub, folder)
        assert (await anext(speeds)).linear.x == 0.2
        process.terminate()
        await line_with("stopped", process)
        assert await process.wait() == 0
        async for speed in speeds:
            if speed == Twist():
                break


async def test_hub_stops_the_robot_of_a_program_that_cannot(folder: Path) -> None:
    async with HubServer(Settings(port=0)) as hub, fibws.Node("test", hub=hub.url) as node:
        speeds = node.subscribe("cmd_vel", Twist)
        process = await start(PROGRAMS["careful_driver"], hub, folder)
        assert (await anext(speeds)).linear.x == 0.2
        process.kill()
        await process.wait()
        async for speed in speeds:
            if speed == Twist():
                break


async def test_program_with_a_hub_of_its_own(folder: Path) -> None:
    async with HubServer(Settings(port=0)) as other:
        process = await start(PROGRAMS["robot"], other, folder)
        url = (await line_with("can connect to", process)).split()[-1]
        assert url != other.url
        async with fibws.Node("test", hub=url) as node:
            assert (await node.wait_for_message("state", String)).data == "ready"
        process.terminate()
        assert await process.wait() == 0


def test_all_programs_are_tested() -> None:
    assert PROGRAMS.keys() == {
        *("talker", "listener", "smoother", "adder", "configured", "counter", "sum"),
        *("indexed_broadcaster", "driver", "careful_driver", "robot", "tracker"),
    }
    assert len(PROGRAMS) == NODES.count("```python")


async def test_hub_and_node_use_a_definition_of_the_users_own(folder: Path) -> None:
    async with HubServer(Settings(port=0, interfaces=(folder,))) as hub:
        process = await start(PROGRAMS["indexed_broadcaster"], hub, folder)
        try:
            await line_with("F(10) = 55", process)
            topic = hub.graph.topics["/indexed"]
            assert topic.type is not None
            assert topic.type.name == "fibonacci/Fibonacci"
        finally:
            process.terminate()
            await process.wait()


STRICT = """\
import fibws
from fibws.msg.geometry_msgs import PointStamped
from fibws.msg.std_msgs import Extra, Header, String


async def main(node: fibws.Node) -> None:
    extra = await node.advertise("extra", Extra)
    await extra.publish(level=1, text=String("a"))
    point = PointStamped(header=Header(frame_id="map"))
    print(point.header.frame_id, fibws.msg.message_class("std_msgs/Extra"))
"""
"""A program with a message of its own in a package that has the name of a standard one."""


@pytest.mark.long  # mypy reads all that pydantic has.
@pytest.mark.parametrize("package", ["fibonacci", "std_msgs"])
def test_type_checker_knows_the_users_own_packages_by_stubs(folder: Path, package: str) -> None:
    command = "-m fibws.interfaces.generator --stubs typings"
    assert f"python {command}" in NODES
    text, wrong, right = PROGRAMS["indexed_broadcaster"], "indx=index", "index=index"
    if package == "std_msgs":
        own = folder / "std_msgs" / "msg"
        own.mkdir(parents=True)
        (own / "Extra.msg").write_text("int32 level\nString text\n")
        text, wrong, right = STRICT, "levl=1", "level=1"
    environment = os.environ | {"FIBWS_INTERFACES": str(folder)}
    subprocess.run([sys.executable, *command.split()], cwd=folder, check=True, env=environment)
    settings = re.search(r"```toml\n(\[tool\.mypy\]\n.*?)```", NODES, re.DOTALL)
    assert settings is not None
    strict = settings[1].replace("[tool.mypy]\n", "[tool.mypy]\nstrict = true\n")
    (folder / "pyproject.toml").write_text(strict)
    program = folder / "program.py"
    program.write_text(text)
    mypy = (sys.executable, "-m", "mypy", ".")
    found = subprocess.run(mypy, cwd=folder, capture_output=True, text=True)
    assert found.returncode == 0, found.stdout + found.stderr
    program.write_text(text.replace(right, wrong))
    found = subprocess.run(mypy, cwd=folder, capture_output=True, text=True)
    assert f'did you mean "{right.partition("=")[0]}"' in found.stdout


async def test_cells_of_the_notebook_run_one_after_the_other() -> None:
    names: dict[str, Any] = {}
    shown = []
    for cell in re.findall(r"```python\n(.*?)```", PAGES[DOCS / "jupyter.md"], re.DOTALL):
        if cell == "newest.data\n":
            await wait_until(lambda: names["newest"].data == 8)
        # As IPython runs it: `await` may be anywhere, and the last expression is shown.
        tree = ast.parse(cell)
        if isinstance(tree.body[-1], ast.Expr):
            tree.body[-1] = ast.Assign([ast.Name("_", ast.Store())], tree.body[-1].value)
        code = compile(
            ast.fix_missing_locations(tree), "cell", "exec", ast.PyCF_ALLOW_TOP_LEVEL_AWAIT
        )
        running = eval(code, names)
        if isawaitable(running):
            await running
        shown.append(names.pop("_", None))
    await names["following"]
    assert [each for each in shown if each is not None] == [5, 8]


# The commands.


OTHERS = {
    *("cat", "cd", "chmod", "eval", "export", "kill", "mkdir", "source", "umask", "until"),
    *("chgrp", "curl", "docker", "git", "groupadd", "install", "journalctl", "kubectl"),
    "systemctl",
    *("mkdocs", "mypy", "nox", "npm", "pip", "pre-commit", "ruff"),  # of developers
    "ros2",  # of ROS 2
}
"""Programs that are not fibws's."""
INSTALLED = "/opt/fibws/bin/"
"""Where docs/operations.md installs fibws."""
MODULES = {"bench", "pip", "pytest", "venv"}
"""Modules that are run and are not fibws's."""


def commands(page: str) -> Iterator[list[str]]:
    """Yield the words of each command in a page's blocks for terminals, comments left out.

    In a block with prompts, other lines are what the commands print.
    """
    for block in re.findall(r"^```console[^\n]*\n(.*?)^```$", page, re.MULTILINE | re.DOTALL):
        block = re.sub(r"<< ?'?(\w+)'?\n.*?^\1$", "", block, flags=re.MULTILINE | re.DOTALL)
        lines = block.replace("\\\n", " ").splitlines()
        if prompted := [line[2:] for line in lines if line.startswith("$ ")]:
            lines = prompted
        for line in lines:
            subshell = re.fullmatch(r"\((umask \d+); (.*)\)", line)
            for part in subshell.groups() if subshell else line.split(" && "):
                words = shlex.split(re.sub(r" &$| > \S+$", "", part), comments=True)
                while words and re.match(r"\w+=", words[0]):  # A variable of this command.
                    words.pop(0)
                if words:
                    words[0] = words[0].removeprefix(INSTALLED).replace("python3", "python")
                yield words
                for inner in re.findall(r"[<$]\(([^()]*)\)", part):
                    yield shlex.split(inner)


def installed(first: str) -> list[str]:
    """Return the command that the README has behind an installation with pip."""
    found = re.search(rf"^python -m pip install {re.escape(first)}\n(.*)$", PAGES[README], re.M)
    assert found is not None
    words = shlex.split(found[1])
    assert words.pop(0) == "python"
    return words


@pytest.mark.parametrize(
    ("page", "heading"), [(README, "Try it"), (DOCS / "tutorial.md", "Without bash")]
)
def test_first_commands_are_also_those_of_powershell(page: Path, heading: str) -> None:
    """Windows PowerShell has no ``&&``, no ``source``, and no variables in front of a command."""
    section = re.search(rf"\n## {heading}\n(.*?)(?=\n## |\Z)", PAGES[page], re.DOTALL)
    assert section is not None
    blocks = re.findall(r"^```console.*?\n(.*?)^```$", section[1], re.M | re.DOTALL)
    lines = "".join(blocks).splitlines()
    assert len(lines) > 4
    for line in lines:
        assert not re.search(r"&&|\bsource\b|<\(|^\w+=|\bexport\b| &$", line), line


async def test_demo_runs() -> None:
    demo = await asyncio.create_subprocess_exec(
        *(sys.executable, *installed("-e ."), "--port", "0"), stdout=asyncio.subprocess.PIPE
    )
    try:
        await line_with("I heard 0", demo)
    finally:
        demo.terminate()
        await demo.communicate()


def test_pytest_finds_tests() -> None:
    words = [*installed('-e ".[test]"'), "--collect-only", "--quiet", "-n", "0"]
    run = subprocess.run(
        [sys.executable, *words, "tests/test_names.py"], cwd=ROOT, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stdout + run.stderr
    assert "tests/test_names.py::" in run.stdout


def test_extras_are_those_of_the_package() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    for page in PAGES.values():
        extras = set(re.findall(r"pip install [^`\n]*\[(\w+)\]", page))
        assert extras <= project["optional-dependencies"].keys()


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_commands_and_their_options_exist(path: Path) -> None:
    for words in commands(PAGES[path]):
        match words:
            case ["fibws", *arguments] | ["python", "-m", "fibws", *arguments]:
                check_options(fibws_command, arguments)
            case [str(alias), *arguments] if alias in ALIASES:
                check_options(fibws_command, [*ALIASES[alias].split(), *arguments])
            case ["python", "-m", str(module), *arguments] if module.startswith("fibws."):
                name = f"{module}.__main__" if module == "fibws.hub" else module
                command = getattr(import_module(name), "command", None)
                if isinstance(command, click.Command):
                    check_options(command, arguments)
            case ["python", "-m", str(module), *_]:
                assert module in MODULES, words
            case ["python", str(script), *_]:
                assert script.endswith(".py"), words
            case [str(program), *_]:
                assert program in OTHERS, words


def check_options(command: click.Command, arguments: list[str]) -> None:
    """Parse a command's arguments, as if it were called, and do nothing."""
    context = _context(command)
    while isinstance(command, click.Group):
        name = next(iter(arguments), "")
        if isinstance(command, HubCommands) and (not name or name.startswith("-")):
            command = import_module("fibws.hub.__main__").command
            break
        found = command.get_command(context, name)
        assert found is not None, f"{command.name} has no command {name!r}"
        command, arguments = found, arguments[1:]
        context = _context(command, context)
    try:
        command.parse_args(context, arguments)
    except click.exceptions.Exit:
        pass  # -h has printed the help.
    except click.BadParameter as error:
        is_missing = re.search("does not exist|No such file", error.message)
        assert is_missing, f"{command.name} {arguments}: {error}"


def _context(command: click.Command, parent: click.Context | None = None) -> click.Context:
    # With its settings: click keeps the names of a command's help option of the first context.
    return click.Context(command, parent, command.name, **command.context_settings)


def test_table_of_settings_is_that_of_the_code() -> None:
    page = PAGES[DOCS / "operations.md"]
    rows = re.findall(r"^\| `--([a-z0-9-]+)` \| `?([^|`]*)`? \| (.*) \|$", page, re.MULTILINE)
    assert rows == [
        (flag_of(setting), written(setting.default), setting.metadata["help"])
        for setting in dataclasses.fields(Settings)
    ]


def written(default: object) -> str:
    if isinstance(default, float):
        return f"{default:g}"
    if default is None or default == ():
        return ""
    return default if isinstance(default, str) else str(default).lower()


# Files and links.


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_links_lead_somewhere(path: Path) -> None:
    text = re.sub(r"^```.*?^```$", "", PAGES[path], flags=re.MULTILINE | re.DOTALL)
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if not link.startswith("http"):
            file, _, anchor = link.partition("#")
            target = (path.parent / file).resolve() if file else path
            assert target.exists(), f"{path.name}: {link}"
            if anchor:
                headings = re.findall(r"^#+ (.*)$", PAGES[target], re.MULTILINE)
                assert anchor in map(anchor_of, headings), f"{path.name}: {link}"


def anchor_of(heading: str) -> str:
    """Return the anchor that GitHub gives a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def test_badges_are_those_of_the_workflows() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    page = f"{project['urls']['Source']}/actions/workflows/"
    badges = re.findall(r"^\[!\[(.*)\]\((.*)\)\]\((.*)\)$", PAGES[README], re.MULTILINE)
    assert badges
    for name, picture, link in badges:
        assert picture == f"{link}/badge.svg"
        workflow = ROOT / ".github" / "workflows" / link.removeprefix(page)
        assert re.search(rf"^name: {name}$", workflow.read_text("utf-8"), re.MULTILINE)


def test_pictures_are_small_and_shown() -> None:
    pictures = sorted((DOCS / "images").iterdir())
    shown = re.findall(r"!\[.*\]\(\S*images/(\S*)\)", "\n".join(PAGES.values()))
    assert {each.name for each in pictures} == set(shown)
    for each in pictures:
        assert each.stat().st_size <= (400_000 if each.suffix == ".svg" else 150_000)


def test_recording_of_the_demo_has_what_terminals_show() -> None:
    lines = [record_demo.Line(0.5, "echo <1>", is_typed=True), record_demo.Line(1.5, "1 & 2" * 40)]
    root = ElementTree.fromstring(record_demo.picture([lines, lines * 9]))
    texts = ["".join(each.itertext()) for each in root.iter("{http://www.w3.org/2000/svg}text")]
    assert texts == ["$ echo <1>", ("1 & 2" * 40)[: record_demo.COLUMNS]] * 10


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_files_of_the_repository_exist(path: Path) -> None:
    files = re.findall(r"`((?:fibws|tests|web|bench|docs|\.ci)/[\w./-]*)`", PAGES[path])
    missing = [file for file in files if not (ROOT / file).exists() and file != "fibws/hub/page"]
    assert not missing
