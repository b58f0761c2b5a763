"""The files in .github/: valid by GitHub's schemas, and about things that exist."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import yaml
from nox import registry
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

import noxfile  # noqa: F401  It registers its sessions.

from .requirements import EXTRAS, PYPROJECT, ROOT, names_of

GITHUB = ROOT / ".github"
WORKFLOWS: dict[str, dict[str, Any]] = {
    path.name: yaml.safe_load(path.read_text("utf-8"))
    for path in sorted((GITHUB / "workflows").glob("*.yml"))
}
SCHEMAS = {
    "vendor.github-workflows": "workflows/*.yml",
    "custom.github-workflows-require-timeout": "workflows/*.yml",
    "vendor.dependabot": "dependabot.yml",
    "vendor.github-issue-config": "ISSUE_TEMPLATE/config.yml",
    "vendor.github-issue-forms": "ISSUE_TEMPLATE/[!c]*.yml",
}
"""The schemas of check-jsonschema, which are part of it, and the files in .github/ for each."""
OF_THE_SYSTEM = {"apt-get", "gh", "git", "test"}
PINNED = re.compile(r"[\w-]+/[\w-]+@(v\d+|release/v\d+|[0-9a-f]{40})|\./\.github/workflows/\S+")


class Step(NamedTuple):
    """One step of a workflow's job."""

    workflow: str
    job: str
    step: dict[str, Any]


def steps() -> Iterator[Step]:
    for name, workflow in WORKFLOWS.items():
        for job_name, job in workflow["jobs"].items():
            for step in job.get("steps", []):
                yield Step(name, job_name, step)


def jobs() -> Iterator[tuple[str, str, dict[str, Any]]]:
    for name, workflow in WORKFLOWS.items():
        for job_name, job in workflow["jobs"].items():
            yield name, job_name, job


@pytest.mark.parametrize(("schema", "pattern"), SCHEMAS.items())
def test_files_are_valid(schema: str, pattern: str) -> None:
    files = sorted(str(path) for path in GITHUB.glob(pattern))
    assert files
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", schema, *files]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_schemas_find_faults(tmp_path: Path) -> None:
    workflow = tmp_path / "tests.yml"
    text = (GITHUB / "workflows" / "tests.yml").read_text("utf-8")
    workflow.write_text(text.replace("runs-on:", "run-on:"))
    schema = ["--builtin-schema", "vendor.github-workflows"]
    command = [sys.executable, "-m", "check_jsonschema", *schema, str(workflow)]
    assert subprocess.run(command, capture_output=True).returncode != 0


def test_python_versions_are_those_of_the_package() -> None:
    matrix = WORKFLOWS["tests.yml"]["jobs"]["tests"]["strategy"]["matrix"]
    versions = matrix["python"]
    supported = SpecifierSet(PYPROJECT["project"]["requires-python"])
    assert [f"3.{minor}" for minor in range(15) if f"3.{minor}" in supported] == versions
    classifiers = "\n".join(PYPROJECT["project"]["classifiers"])
    named = re.findall(r"^Programming Language :: Python :: (3\.\d+)$", classifiers, re.MULTILINE)
    assert named in ([], versions)
    assert {system.partition("-")[0] for system in matrix["os"]} == {"ubuntu", "windows", "macos"}


def test_jobs_wait_for_jobs_that_exist() -> None:
    for name, job_name, job in jobs():
        needs = job.get("needs", [])
        assert {*needs} <= WORKFLOWS[name]["jobs"].keys(), f"{name}: {job_name}"


def test_everything_must_have_passed_before_anything_is_published() -> None:
    release = WORKFLOWS["release.yml"]["jobs"]
    for name in ("pypi", "image", "documentation"):
        assert {"tests", "build"} <= {*release[name]["needs"]}
    tests = WORKFLOWS["tests.yml"]["jobs"]
    assert {*tests["passed"]["needs"]} == tests.keys() - {"passed"}


def test_actions_are_pinned() -> None:
    used = {step["uses"] for _, _, step in steps() if "uses" in step}
    used |= {job["uses"] for _, _, job in jobs() if "uses" in job}
    assert used
    assert [name for name in sorted(used) if not PINNED.fullmatch(name)] == []
    for name in used:
        if name.startswith("./"):
            assert (ROOT / name).exists()


def test_jobs_may_do_no_more_than_they_must() -> None:
    assert {str(workflow["permissions"]) for workflow in WORKFLOWS.values()} == {
        str({"contents": "read"})
    }
    writers = {
        (name, job_name): {
            right for right, level in job.get("permissions", {}).items() if level == "write"
        }
        for name, job_name, job in jobs()
    }
    assert {job: rights for job, rights in writers.items() if rights} == {
        ("release.yml", "pypi"): {"id-token"},
        ("release.yml", "image"): {"packages"},
        ("release.yml", "documentation"): {"pages", "id-token"},
        ("release.yml", "github"): {"contents"},
    }
    checkouts = [step for _, _, step in steps() if step.get("uses", "").startswith("actions/ch")]
    assert checkouts
    assert all(step["with"]["persist-credentials"] is False for step in checkouts)


def test_commands_do_not_contain_text_from_outside() -> None:
    """A branch's name in a command would be executed: variables of the environment are not."""
    for workflow, job, step in steps():
        assert "${{" not in step.get("run", ""), f"{workflow}: {job}"


@pytest.mark.long
def test_commands_of_jobs_exist() -> None:
    installed: dict[tuple[str, str], set[str]] = {}
    for workflow, job, step in steps():
        packages = installed.setdefault((workflow, job), set())
        for words in commands(step.get("run", "")):
            where = f"{workflow}: {job}: {shlex.join(words)}"
            match words:
                case ["python" | "build/venv/bin/pip", *_] if "install" in words:
                    packages |= packages_of(words[words.index("install") + 1 :], where)
                case ["python", "-m", module, *_]:
                    names = {*map(canonicalize_name, packages_distributions().get(module, []))}
                    assert module in sys.stdlib_module_names or names & packages, where
                case ["python" | "python3", script, *_]:
                    assert (ROOT / script).is_file(), where
                case ["nox", "-s", session]:
                    assert session in registry.get(), where
                    assert "nox" in packages, where
                case ["build/venv/bin/fibws", "--version"]:
                    assert "fibws" in packages, where
                case [program, *_] if program.startswith(".ci/"):
                    assert os.access(ROOT / program, os.X_OK), where
                case [program, *_]:
                    assert program in OF_THE_SYSTEM, where


def commands(run: str) -> Iterator[list[str]]:
    for line in run.splitlines():
        for command in re.split(r" && | >>? ", line):
            words = shlex.split(command)
            if not words[0].startswith("$") and words != ["notes.md"]:
                yield words


def packages_of(words: list[str], where: str) -> set[str]:
    """Return what a `pip install` installs, and check that all of it is known."""
    packages: set[str] = set()
    rest = iter(words)
    for word in rest:
        if word == "-c":
            assert (ROOT / next(rest)).is_file(), where
        elif found := re.fullmatch(r"\.\[(\w+)\]", word):
            assert found[1] in EXTRAS, where
            packages |= names_of(found[1])
        elif word == "dist/*.whl":
            packages.add("fibws")
        elif not word.startswith("-"):
            assert canonicalize_name(word) in names_of("dev"), where
            packages.add(word)
    return packages


def test_links_lead_to_the_projects_own_repository() -> None:
    urls = PYPROJECT["project"].get("urls", {})
    linked = set(
        re.findall(
            r"https://github\.com/[\w-]+/[\w-]+",
            (GITHUB / "ISSUE_TEMPLATE" / "config.yml").read_text("utf-8")
            + (ROOT / "CONTRIBUTING.md").read_text("utf-8"),
        )
    )
    assert len(linked) == 1
    own = {
        found[0]
        for url in urls.values()
        if (found := re.match(r"https://github\.com/[^/]+/[^/#]+", url))
    }
    assert own <= linked


def test_links_in_pages_of_the_root_lead_somewhere() -> None:
    for name in ("CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md"):
        for link in re.findall(r"\]\(([^)\s#]+)", (ROOT / name).read_text("utf-8")):
            assert link.startswith("http") or (ROOT / link).exists(), f"{name}: {link}"
