"""Types are shown as by rosmsg and rossrv."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

from recorded_answers import Answers, shortened

from fibws.interfaces.catalogue import STANDARD
from fibws.values.type_definitions import InstalledTypes

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


def shown_by_ros(folder: Path) -> dict[str, str]:
    """Return the definitions that rosmsg and rossrv show, of the standard packages."""
    for package in STANDARD.iterdir():
        if package.is_dir():
            shutil.copytree(package, folder / package.name)
            (folder / package.name / "package.xml").write_text(
                f"<package><name>{package.name}</name><version>1.0.0</version>"
                "<description>-</description><license>-</license>"
                "<maintainer email='a@example.org'>-</maintainer></package>"
            )
    ran = subprocess.run(
        ["/usr/bin/python3", "-c", THEIRS],
        env={**os.environ, "ROS_PACKAGE_PATH": str(folder), "PYTHONPATH": ""},
        capture_output=True,
        text=True,
        check=True,
    )
    shown: dict[str, str] = json.loads(ran.stdout)
    return {key: shortened(text) for key, text in shown.items()}


def test_standard_types_are_shown_as_by_rosmsg(answers: Answers, tmp_path: Path) -> None:
    theirs: dict[str, str] = answers.of("shown", lambda: shown_by_ros(tmp_path))
    messages, services = InstalledTypes("msg"), InstalledTypes("srv")
    ours = {}
    for key in theirs:
        kind, type_ = key.split()
        definition = (messages if kind == "msg" else services).definition(type_)
        ours[key] = shortened("".join(f"{line}\n" for line in definition.lines))
    assert len(theirs) > 150
    assert ours == theirs
