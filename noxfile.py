"""The commands of contributors: `nox -l` lists them, `nox -s lint` runs one.

CI runs the same commands. Most sessions use the environment in which nox runs, as
`pip install -e '.[dev]'` made it, so they start at once.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import nox
from nox.command import CommandFailed

LOCK = Path("constraints.txt")
"""The versions that CI installs: `pip install -e '.[dev]' -c constraints.txt`."""
BUILD_REQUIREMENTS = Path("build", "requirements.in")
"""What a build needs, in the form that uv reads; written by the session lock."""
UNLOCKED = {"PIP_CONSTRAINT": None, "PIP_BUILD_CONSTRAINT": None}
"""The environment of an installation with the newest versions."""
LINT = [["ruff", "check", "."], ["ruff", "format", "--check", "."]]
TYPES = [["mypy"]]

nox.needs_version = ">=2025.5"
nox.options.default_venv_backend = "none"
nox.options.sessions = ["lint", "types", "page", "docs", "tests"]


@nox.session
def tests(session: nox.Session) -> None:
    """Run the default tests; `nox -s tests -- tests/hub` runs one folder."""
    session.run("python", "-m", "pytest", *session.posargs)


@nox.session
def lint(session: nox.Session) -> None:
    """Check the style of the Python code."""
    for command in LINT:
        session.run(*command)


@nox.session
def format(session: nox.Session) -> None:
    """Repair the style of the Python code and of the page, where tools can."""
    session.run("ruff", "check", "--fix", ".")
    session.run("ruff", "format", ".")
    session.run("npm", "--prefix", "web", "run", "format")


@nox.session
def types(session: nox.Session) -> None:
    """Check the types of the Python code."""
    for command in TYPES:
        session.run(*command)


@nox.session
def page(session: nox.Session) -> None:
    """Check the hub's page: its types, style and unit tests."""
    session.run("npm", "--prefix", "web", "ci")
    session.run("npm", "--prefix", "web", "run", "check")
    session.run("npm", "--prefix", "web", "test")


@nox.session
def docs(session: nox.Session) -> None:
    """Build the documentation into build/site; a broken link is an error."""
    session.run("python", "-m", "mkdocs", "build", "--strict")


@nox.session
def project(session: nox.Session) -> None:
    """Check the workflows, forms and other files that are for people and GitHub."""
    session.run("python", "-m", "pytest", "-m", "", "tests/project", *session.posargs)


@nox.session(name="all")
def everything(session: nox.Session) -> None:
    """Run everything; needs Debian, where it installs packages if they are missing."""
    session.run(".ci/all", *session.posargs)


@nox.session
def lock(session: nox.Session) -> None:
    """Write constraints.txt again, with the newest versions that fit together.

    `nox -s lock -- --upgrade-package ruff` changes one package only, `nox -s lock -- --no-upgrade`
    nothing but what pyproject.toml demands.
    """
    BUILD_REQUIREMENTS.parent.mkdir(exist_ok=True)
    BUILD_REQUIREMENTS.write_text("\n".join([*build_requirements(), ""]), "utf-8")
    # No hashes: pip refuses editable installs, such as this project's, when it checks hashes.
    command = ["uv", "pip", "compile", "--quiet", "--all-extras", "--universal"]
    command += ["--python-version", "3.11", "--custom-compile-command", "nox -s lock"]
    command += ["--no-emit-package", "fibws", "--output-file", str(LOCK)]
    options = session.posargs or ["--upgrade"]
    session.run(*command, *options, "pyproject.toml", BUILD_REQUIREMENTS.as_posix())


def build_requirements() -> list[str]:
    """Return what pip installs to build the package, also Node.js for the page."""
    pyproject = tomllib.loads(Path("pyproject.toml").read_text("utf-8"))
    requires: list[str] = pyproject["build-system"]["requires"]
    node = re.search(r'^NODE_WHEEL = "(.+)"$', Path("hatch_build.py").read_text("utf-8"), re.M)
    assert node is not None, "hatch_build.py has no NODE_WHEEL"
    return [*requires, node[1]]


@nox.session(venv_backend="venv")
def newest(session: nox.Session) -> None:
    """Report what breaks with the newest versions of all dependencies.

    The installation ignores constraints.txt. If any version differs from the locked ones, all
    checks run, even if one of them fails, and the versions that differ are printed. Options are for
    pytest.
    """
    session.install("--upgrade", "--quiet", "-e", ".[dev]", env=UNLOCKED)
    installed = session.run("python", "-m", "pip", "freeze", "--exclude-editable", silent=True)
    differing = newer_than_locked(str(installed))
    if not differing:
        session.log("all versions are those of constraints.txt, with which the other checks ran")
        return
    failed = []
    for command in [*LINT, *TYPES, ["python", "-m", "pytest", *session.posargs]]:
        try:
            session.run(*command, env=UNLOCKED)
        except CommandFailed:
            failed.append(" ".join(command))
    for line in differing:
        session.log(line)
    if failed:
        session.error(f"fails with these versions: {'; '.join(failed)}")


def newer_than_locked(installed: str) -> list[str]:
    """Return a line for each package whose version differs from all locked ones.

    Args:
        installed: the output of `pip freeze`.
    """
    locked: dict[str, list[str]] = {}
    for name, version in re.findall(r"^([\w.-]+)==(\S+)", LOCK.read_text("utf-8"), re.M):
        locked.setdefault(normalized(name), []).append(version)
    return [
        f"{name}: {version}, locked: {' or '.join(locked.get(normalized(name), ['no version']))}"
        for name, version in re.findall(r"^([\w.-]+)==(\S+)", installed, re.M)
        if version not in locked.get(normalized(name), [])
    ]


def normalized(name: str) -> str:
    """Return a package's name as indexes write it."""
    return re.sub(r"[-_.]+", "-", name).lower()
