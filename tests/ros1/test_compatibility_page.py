"""The tables of docs/ros1-compatibility.md are those of the code."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

from fibws.ros1.launch import reader
from fibws.ros1.shell import ros_programs

ROOT = Path(__file__).parents[2]
ROS1 = ROOT / "fibws" / "ros1"
PAGE = (ROOT / "docs" / "ros1-compatibility.md").read_text("utf-8")
FUNCTIONS_OF_THE_SHELL = {"roscd", "rosls"}


def rows(heading: str) -> list[list[str]]:
    """Return the cells of the table below a heading."""
    section = PAGE.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    lines = re.findall(r"^\| (.*?) ?\|$", section, re.MULTILINE)[1:]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)] for line in lines]


def words(cell: str) -> list[str]:
    return re.findall(r"`([^`]+)`", cell)


def test_commands() -> None:
    table = {word: row[1] for row in rows("Commands") for word in words(row[0])}
    there = {path.name for path in (ROS1 / "shell" / "bin").iterdir() if path.suffix == ""}
    there -= {"fibws"}
    assert {name for name, state in table.items() if state != "missing"} == (
        there | FUNCTIONS_OF_THE_SHELL
    )


def test_python_modules() -> None:
    folders = [*(ROS1 / "python").iterdir(), *(ROS1 / "fallback").iterdir()]
    modules = {path.name for path in folders if (path / "__init__.py").exists()}
    modules.add("sensor_msgs")  # point_cloud2 alone
    assert sorted(word for row in rows("Python modules") for word in words(row[0])) == sorted(
        modules
    )


@pytest.mark.parametrize(
    ("module", "missing"), [(row[0], row[2]) for row in rows("Python modules")]
)
def test_names_that_are_missing(module: str, missing: str) -> None:
    [package, *_] = words(module)
    for name in words(missing):
        if name.isidentifier():
            assert not hasattr(importlib.import_module(package), name)
            with pytest.raises(ImportError):
                importlib.import_module(f"{package}.{name}")


def test_python_modules_that_are_missing() -> None:
    for row in rows("Python modules that are missing"):
        for name in words(row[0]):
            folder = ROS1 / "python" / name
            assert not folder.exists()


def test_packages_with_definitions() -> None:
    folder = ROOT / "fibws" / "interfaces" / "definitions"
    table = {row[0]: words(row[1]) for row in rows("Packages with message definitions")}
    for kind, suffix in (("messages", "msg"), ("services", "srv"), ("actions", "action")):
        assert table.pop(kind) == sorted(path.parent.name for path in folder.glob(f"*/{suffix}"))
    assert not table


def test_programs() -> None:
    for package, programs in rows("Programs of ROS's packages"):
        (name,) = words(package)
        assert words(programs) == sorted(ros_programs.names(name))
        for program in words(programs):
            assert ros_programs.command_line(name, program, [])


def test_launch_tags() -> None:
    tags = words(rows("Launch files")[0][0])
    assert {*tags, "launch", "machine"} == reader.ATTRIBUTES.keys()
