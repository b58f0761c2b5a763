"""The page moves the links of a robot as robot_state_publisher does."""

from __future__ import annotations

import json
import os
import random
import shutil
import subprocess
from pathlib import Path

import pytest

from fibws.programs.demo_robot.body import DESCRIPTION
from fibws.ros1.urdf import RobotModel, read_urdf
from fibws.tf.transform import Transform

WEB = Path(__file__).parents[2] / "web"
TYPES = ["revolute", "continuous", "prismatic", "fixed", "floating"]


def made_up(chance: random.Random) -> str:
    """Return a robot with any turns, axes and mimics."""

    def numbers(most: float) -> str:
        return " ".join(str(chance.uniform(-most, most)) for _ in range(3))

    links, joints = ['<link name="link0"/>'], []
    for number in range(1, 9):
        links.append(f'<link name="link{number}"/>')
        mimic = ""
        if number > 2 and chance.random() < 0.4:
            other = chance.randrange(1, number)
            mimic = f'<mimic joint="joint{other}" multiplier="{chance.uniform(-2, 2)}" offset="1"/>'
        joints.append(
            f'<joint name="joint{number}" type="{chance.choice(TYPES)}">'
            f'<parent link="link{chance.randrange(number)}"/><child link="link{number}"/>'
            f'<origin xyz="{numbers(2)}" rpy="{numbers(7)}"/><axis xyz="{numbers(1)}"/>{mimic}'
            '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        )
    chance.shuffle(joints)
    return f'<robot name="made_up">{"".join(links + joints)}</robot>'


def places(model: RobotModel, known: dict[str, float]) -> dict[str, list[float]]:
    """Return where each link is in the root: x, y and z, and the rotation's x, y, z and w."""
    positions = model.positions(known)
    found = {model.root: Transform()}
    while len(found) < len(model.links):
        for joint in model.joints.values():
            if joint.parent in found:
                step = joint.at(positions.get(joint.name, 0.0))
                found[joint.child] = found[joint.parent] @ step
    return {link: [*each.translation, *each.rotation] for link, each in found.items()}


@pytest.mark.skipif(
    not (os.environ.get("CI") or (WEB / "node_modules").is_dir()) or shutil.which("npx") is None,
    reason="needs npm ci, in web/",
)
def test_page_moves_links_as_robot_state_publisher(tmp_path: Path) -> None:
    chance, cases = random.Random(8), []
    for urdf in [DESCRIPTION, *(made_up(chance) for _ in range(20))]:
        model = read_urdf(urdf)
        names = [name for name, joint in model.joints.items() if joint.moves]
        known = {name: chance.uniform(-4, 4) for name in names if chance.random() < 0.8}
        cases.append({"urdf": urdf, "known": known, "places": places(model, known)})
    module = tmp_path / "cases.mjs"
    module.write_text(f"export const cases = {json.dumps(cases)};")
    done = subprocess.run(
        ["npx", "--no-install", "vitest", "run", "src/panels/scene/robot/urdf.test.ts"],
        cwd=WEB,
        env={**os.environ, "VITE_URDF_CASES": str(module), "NO_COLOR": "1"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "skipped" not in done.stdout
