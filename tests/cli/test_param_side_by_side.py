"""Parameters are listed, printed and dumped as by ROS's rosparam."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeAlias

from hub_in_thread import Run
from recorded_answers import Answers
from ros_masters import roscore

Command: TypeAlias = Callable[..., str]

FILE = """
gains: {p: 1, i: 0.5, d: "0"}
angle: deg(90)
half: rad(pi/2)
sure: yes
list: [1, two, [3.5, {four: 5}]]
---
_ns: arm
text: "one\\ntwo: 'three'"
empty: ''
"""


PREPARED = (
    ("delete", "/"),
    ("load", "FOLDER/file.yaml", "/robot"),
    ("set", "/robot/negative", "-5"),
    ("set", "/robot/text", ""),
    ("set", "/robot/gains", "{p: 2, more: {x: 1}}"),
    ("delete", "/robot/sure"),
)


@contextmanager
def rosparam(folder: Path) -> Iterator[Command]:
    """Give the real rosparam, at a ROS master of its own."""
    with roscore(folder) as environment:

        def run(*words: str) -> str:
            command = ["/usr/bin/rosparam", *words]
            ran = subprocess.run(command, env=environment, capture_output=True, text=True)
            return ran.stdout if ran.returncode == 0 else ran.stderr

        yield run


def play(run: Command, folder: Path) -> dict[str, str]:
    """Return what `rosparam` prints for each list of words, and the file that it dumps."""
    folder.mkdir()
    (folder / "file.yaml").write_text(FILE)
    for words in PREPARED:
        run(*(word.replace("FOLDER", str(folder)) for word in words))
    names = [name for name in run("list", "/robot").split()]
    asked = [
        *(("list", "/robot"), ("list", "/robot/arm"), ("get", "/robot"), ("get", "-p", "/robot")),
        *(("get", name) for name in names),
        *(("get", "-p", name) for name in names),
    ]
    printed = {" ".join(words): run(*words) for words in asked}
    run("dump", str(folder / "dumped"), "/robot")
    return {**printed, "dump": (folder / "dumped").read_text()}


def test_parameters_are_printed_as_by_rosparam(run: Run, answers: Answers, tmp_path: Path) -> None:
    def ask() -> dict[str, str]:
        with rosparam(tmp_path / "ros") as theirs:
            return play(theirs, tmp_path / "theirs")

    expected = answers.of("printed", ask)
    assert play(lambda *words: run("param", *words).output, tmp_path / "ours") == expected
    assert len(expected) > 20
