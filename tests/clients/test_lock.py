"""The clients are the packages that their makers published, at exact versions."""

from __future__ import annotations

import json
import re

from .conftest import HERE, LOCK

MANIFEST = json.loads((HERE / "package.json").read_text())
PACKAGES = json.loads(LOCK.read_text())["packages"]


def test_every_version_is_exact() -> None:
    for version in MANIFEST["dependencies"].values():
        assert re.fullmatch(r"(npm:roslib@)?\d+\.\d+\.\d+", version)
    assert PACKAGES[""]["dependencies"] == MANIFEST["dependencies"]


def test_both_generations_of_roslib_are_locked() -> None:
    roslibs = {name: PACKAGES[f"node_modules/{name}"] for name in ("roslib1", "roslib2")}
    assert {each["name"] for each in roslibs.values()} == {"roslib"}
    assert [each["version"] for each in roslibs.values()] == ["1.4.1", "2.1.0"]


def test_lock_has_hashes_but_no_download_addresses() -> None:
    for name, package in PACKAGES.items():
        assert "resolved" not in package
        assert name == "" or package["integrity"].startswith("sha512-")
