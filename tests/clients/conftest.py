"""The clients' packages, and what each client saw in its scenarios."""

from __future__ import annotations

import asyncio
import os
import shutil
import sqlite3
import subprocess
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from .casts import Cast
from .runtimes import CHROMIUM
from .stage import Observations, play

HERE = Path(__file__).parent
LOCK = HERE / "package-lock.json"
INSTALLED = HERE / "node_modules" / "installed-lock.json"
"""The lock that the installed packages come from."""

Observe = Callable[[Cast], Observations]


def _lack(reason: str) -> None:
    """Go on without it only where nobody counts on the result."""
    if os.environ.get("CI") == "true":
        pytest.fail(reason)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def npm_packages(tmp_path_factory: pytest.TempPathFactory) -> None:
    """The clients from npm, just as the lock names them."""
    if shutil.which("npm") is None:
        _lack("there is no npm to install the clients with")
    # Processes that share the tests have the folder in common: one of them installs, others wait.
    lock = tmp_path_factory.getbasetemp().parent / "npm_packages.lock"
    with closing(sqlite3.connect(lock, timeout=900)) as alone:
        alone.execute("BEGIN EXCLUSIVE")
        if not INSTALLED.exists() or INSTALLED.read_bytes() != LOCK.read_bytes():
            subprocess.run(["npm", "ci"], cwd=HERE, check=True, timeout=900)
            shutil.copyfile(LOCK, INSTALLED)


@pytest.fixture(scope="session")
def observe(request: pytest.FixtureRequest) -> Observe:
    """What a client sees, played once however many tests ask."""
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
    """What the client saw in the scenario that is called as the test."""
    test: str = request.node.originalname
    return observe(cast).of(test.removeprefix("test_").replace("_", " "))
