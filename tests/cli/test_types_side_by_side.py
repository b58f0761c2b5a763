"""Types as rosmsg and rossrv show them, where these are installed."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from fibws.interfaces.catalogue import STANDARD
from fibws.values.type_definitions import InstalledTypes

pytestmark = [
    pytest.mark.real_ros,
    pytest.mark.skipif(
        shutil.which("rosmsg") is None, reason="rosmsg (Debian: python3-rosmsg) is not installed"
    ),
]

THEIRS = """
import json, rosmsg, rospkg
packages = rospkg.RosPack()
shown = {}
for mode, text in (".msg", rosmsg.get_msg_text), (".srv", rosmsg.get_srv_text):
    for package, folder in rosmsg.iterate_packages(packages, mode):
        for name in rosmsg._list_types(folder, mode[1:], mode):
            type_ = package + "/" + name
            shown[mode[1:] + " " + type_] = text(type_, rospack=packages)
print(json.dumps(shown))
"""


@pytest.fixture
def ros_packages(tmp_path: Path) -> Path:
    """The standard packages that name no type of an action, as ROS has packages."""
    for package in STANDARD.iterdir():
        if package.is_dir():
            shutil.copytree(package, tmp_path / package.name)
            (tmp_path / package.name / "package.xml").write_text(
                f"<package><name>{package.name}</name><version>1.0.0</version>"
                "<description>-</description><license>-</license>"
                "<maintainer email='a@example.org'>-</maintainer></package>"
            )
    return tmp_path


def test_standard_types_are_shown_as_by_rosmsg(ros_packages: Path) -> None:
    ran = subprocess.run(
        ["/usr/bin/python3", "-c", THEIRS],
        env={**os.environ, "ROS_PACKAGE_PATH": str(ros_packages), "PYTHONPATH": ""},
        capture_output=True,
        text=True,
        check=True,
    )
    theirs: dict[str, str] = json.loads(ran.stdout)
    messages, services = InstalledTypes("msg"), InstalledTypes("srv")
    ours = {}
    for key in theirs:
        kind, type_ = key.split()
        definition = (messages if kind == "msg" else services).definition(type_)
        ours[key] = "".join(f"{line}\n" for line in definition.lines)
    assert len(theirs) > 150
    assert ours == theirs
