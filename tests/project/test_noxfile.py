"""The sessions of nox: they run what CI runs, and CONTRIBUTING.md lists them."""

from __future__ import annotations

import re
from typing import Any, cast

import pytest
from nox import registry

import noxfile

from .requirements import ROOT

CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
QUIET = {"--silent", "--quiet"}


class FakeSession:
    """Remembers the commands of a session in place of running them."""

    def __init__(self) -> None:
        self.posargs: list[str] = []
        self.commands: list[list[str]] = []

    def run(self, *command: str, **options: Any) -> None:
        self.commands.append([word for word in command if word not in QUIET])


def commands_of(session: str) -> list[list[str]]:
    fake = FakeSession()
    getattr(noxfile, session)(cast(Any, fake))
    return fake.commands


def commands_of_ci() -> list[list[str]]:
    """Return the commands of the scripts in .ci, without their options for silence."""
    scripts = [(ROOT / ".ci" / name).read_text("utf-8") for name in ("run", "all", "prepare.sh")]
    texts = re.split(r"\n|&&", "\n".join(scripts).replace("&&\n", "&& "))
    return [[word for word in text.split() if word not in QUIET] for text in texts]


@pytest.mark.parametrize("session", ["lint", "types", "page"])
def test_sessions_run_what_ci_runs(session: str) -> None:
    missing = [command for command in commands_of(session) if command not in commands_of_ci()]
    assert not missing, f"nox -s {session} runs these, .ci/run and .ci/all do not"


def test_sessions_in_contributing_are_those_of_the_noxfile() -> None:
    sessions = registry.get().keys()
    documented = set(re.findall(r"^nox -s (\w+)", CONTRIBUTING, re.MULTILINE))
    assert documented <= sessions
    assert sessions - documented == {"lock", "newest", "project"}
