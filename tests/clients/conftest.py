"""The clients' packages, and the observations of each client in its scenarios."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from .casts import Cast
from .runtimes import CHROMIUM
from .stage import Observations, play

HERE = Path(__file__).parent
LOCK = HERE / "package-lock.json"
INSTALLED = HERE / "node_modules" / ".package-lock.json"
"""npm's list of the installed packages."""

Observe = Callable[[Cast], Observations]


def _lack(reason: str) -> None:
    """Skip the test, or fail it in CI."""
    if os.environ.get("CI") == "true":
        pytest.fail(reason)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def npm_packages() -> None:
    """Require the clients from npm, in the versions of the lock."""
    if shutil.which("node") is None:
        _lack("Node.js is not installed")
    if not INSTALLED.exists() or not _versions(LOCK).items() <= _versions(INSTALLED).items():
        _lack("the JavaScript clients are not installed: run `npm ci` in tests/clients")


def _versions(lock: Path) -> dict[str, str]:
    """Return the version of each package that a lock file requires, by its path."""
    packages = json.loads(lock.read_text())["packages"]
    return {
        path: package["version"]
        for path, package in packages.items()
        if path and not package.get("optional")
    }


@pytest.fixture(scope="session")
def observe(request: pytest.FixtureRequest) -> Observe:
    """The observations of a client, whose scenarios run once for all tests."""
    observed: dict[Cast, Observations] = {}

    def observe(cast: Cast) -> Observations:
        if cast not in observed:
            if cast.library != "roslibpy":
                request.getfixturevalue("npm_packages")
            if cast.runtime == "Chromium" and CHROMIUM is None:
                _lack("there is no Chromium here")
            observed[cast] = asyncio.run(play(cast))
        return observed[cast]

    return observe


@pytest.fixture
def seen(cast: Cast, observe: Observe, request: pytest.FixtureRequest) -> Any:
    """The client's observation in the scenario with the name of the test."""
    test: str = request.node.originalname
    return observe(cast).of(test.removeprefix("test_").replace("_", " "))
