"""The clients' packages, and the observations of each client in its scenarios."""

from __future__ import annotations

import asyncio
import json
import os
import re
import shutil
from collections.abc import Callable
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock

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
def observe(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, worker_id: str
) -> Observe:
    """The observations of a client, whose scenarios run once for all tests of all workers."""
    folder = tmp_path_factory.getbasetemp()
    if worker_id != "master":
        folder = folder.parent  # which the workers share

    @cache
    def observe(cast: Cast) -> Observations:
        if cast.library != "roslibpy":
            request.getfixturevalue("npm_packages")
        if cast.runtime == "Chromium" and CHROMIUM is None:
            _lack("there is no Chromium here")
        name = re.sub(r"\W", "_", f"{cast} {' '.join(cast.scenarios)}")
        file = folder / f"{name}.json"
        with FileLock(file.with_suffix(".lock")):
            if not file.exists():
                observed = asyncio.run(play(cast))
                file.write_text(json.dumps(asdict(observed)))
        return Observations(**json.loads(file.read_text()))

    return observe


@pytest.fixture
def seen(cast: Cast, observe: Observe, request: pytest.FixtureRequest) -> Any:
    """The client's observation in the scenario with the name of the test."""
    test: str = request.node.originalname
    return observe(cast).of(test.removeprefix("test_").replace("_", " "))
