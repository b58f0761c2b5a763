"""The hooks that run at each commit."""

from __future__ import annotations

import os
import runpy
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from .requirements import ROOT

CONFIGURATION: dict[str, Any] = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())
HOOKS: dict[str, dict[str, Any]] = {
    hook["id"]: hook for repository in CONFIGURATION["repos"] for hook in repository["hooks"]
}
fault: Callable[[str], str | None] = runpy.run_path(str(ROOT / ".ci" / "commit_subject.py"))[
    "fault"
]


def test_configuration_is_valid() -> None:
    command = [sys.executable, "-m", "pre_commit", "validate-config"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_hooks_run_the_locked_programs() -> None:
    assert {repository["repo"] for repository in CONFIGURATION["repos"]} == {"local"}
    assert {hook["language"] for hook in HOOKS.values()} == {"system"}


@pytest.mark.parametrize(
    "message",
    [
        "cli: report a missing option value",
        "hub, node: close with a code\n\nBecause.\n",
        "tests/node: wait for events",
        "bag play: stop at the end\n# Please enter the commit message",
        ".ci: x" + "x" * 60,
        "Merge branch 'main' into topic",
        'Revert "cli: report a missing option value"',
        "fixup! cli: report a missing option value",
    ],
)
def test_good_subjects_are_accepted(message: str) -> None:
    assert fault(message) is None


@pytest.mark.parametrize(
    ("message", "fact"),
    [
        ("Report a missing option value", "component: what changed"),
        ("Cli: report a missing option value", "component: what changed"),
        ("cli: report a missing option value.", "full stop"),
        ("cli:", "component: what changed"),
        ("", "component: what changed"),
        ("cli: " + "x" * 68, "73 characters"),
        ("cli: report\nmore", "must be empty"),
    ],
)
def test_bad_subjects_are_refused_with_the_reason(message: str, fact: str) -> None:
    assert fact in str(fault(message))


@pytest.mark.long
def test_git_refuses_a_commit_with_a_bad_subject(tmp_path: Path) -> None:
    """The hook of the configuration, as git runs it."""
    environ = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    environ |= {"PRE_COMMIT_HOME": str(tmp_path / "cache"), "HOME": str(tmp_path)}
    environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), environ["PATH"]])
    folder = tmp_path / "repository"
    (folder / ".ci").mkdir(parents=True)
    for name in (".pre-commit-config.yaml", ".ci/commit_subject.py"):
        (folder / name).write_bytes((ROOT / name).read_bytes())

    def run(*command: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(command, cwd=folder, env=environ, capture_output=True, text=True)

    assert run("git", "init").returncode == 0
    run("git", "config", "user.name", "A")
    run("git", "config", "user.email", "a@example.com")
    installed = run(sys.executable, "-m", "pre_commit", "install")
    assert installed.returncode == 0, installed.stdout + installed.stderr
    run("git", "add", ".pre-commit-config.yaml")
    refused = run("git", "commit", "-m", "Change something.")
    assert refused.returncode != 0
    assert "component: what changed" in refused.stdout + refused.stderr
    accepted = run("git", "commit", "-m", "hub: change something")
    assert accepted.returncode == 0, accepted.stdout + accepted.stderr
