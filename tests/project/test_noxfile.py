"""The sessions of nox: they run what CI runs, and CONTRIBUTING.md lists them."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import pytest

from .requirements import ROOT

CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
QUIET = {"--silent", "--quiet"}


COMMANDS = """
import json, sys, noxfile
from nox import registry

class FakeSession:
    def __init__(self):
        self.posargs, self.commands = [], []

    def run(self, *command, **options):
        self.commands.append(command)

found = {}
for session in sys.argv[1:]:
    fake = FakeSession()
    getattr(noxfile, session)(fake)
    found[session] = fake.commands
print(json.dumps([found, list(registry.get())]))
"""
"""Run in a process of its own: nox gives logging's level 25 a name."""
SAME = ("lint", "types", "page")


@pytest.fixture(scope="module")
def found() -> tuple[dict[str, list[list[str]]], set[str]]:
    """The commands of some sessions, and the names of all."""
    words = [sys.executable, "-c", COMMANDS, *SAME]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    commands, sessions = json.loads(done.stdout)
    return commands, set(sessions)


def commands_of_ci() -> list[list[str]]:
    """Return the commands of the scripts in .ci, without their options for silence."""
    scripts = [(ROOT / ".ci" / name).read_text("utf-8") for name in ("run", "all", "prepare.sh")]
    texts = re.split(r"\n|&&", "\n".join(scripts).replace("&&\n", "&& "))
    return [[word for word in text.split() if word not in QUIET] for text in texts]


@pytest.mark.parametrize("session", SAME)
def test_sessions_run_what_ci_runs(
    session: str, found: tuple[dict[str, list[list[str]]], set[str]]
) -> None:
    commands = [[word for word in each if word not in QUIET] for each in found[0][session]]
    missing = [command for command in commands if command not in commands_of_ci()]
    assert not missing, f"nox -s {session} runs these, .ci/run and .ci/all do not"


def test_sessions_in_contributing_are_those_of_the_noxfile(
    found: tuple[dict[str, list[list[str]]], set[str]],
) -> None:
    documented = set(re.findall(r"^nox -s (\w+)", CONTRIBUTING, re.MULTILINE))
    assert documented <= found[1]
    assert found[1] - documented == {"lock", "newest", "project"}
