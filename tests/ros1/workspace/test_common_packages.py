"""Packages in the shapes of those that are common in ROS 1 build, and can be imported."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import fibws
from fibws.ros1.workspace.build import Plan

from .common_packages import SHAPES
from .conftest import Layout


@pytest.fixture(scope="module")
def layout(tmp_path_factory: pytest.TempPathFactory) -> Layout:
    """A workspace with all shapes."""
    layout = Layout(tmp_path_factory.mktemp("common") / "ws")
    for name, shape in SHAPES.items():
        texts = {
            "package.xml": shape.package_xml(name),
            "CMakeLists.txt": shape.cmake_lists(name),
            **shape.files,
        }
        for path, text in texts.items():
            file = layout.source / name / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
            file.chmod(0o755 if text.startswith("#!") else 0o644)
    return layout


@pytest.fixture(scope="module")
def plan(layout: Layout) -> Plan:
    """The workspace, built."""
    return layout.plan()


def test_there_are_many_shapes() -> None:
    assert len(SHAPES) >= 15


def test_no_shape_has_an_error(plan: Plan) -> None:
    assert [str(error) for error in plan.errors] == []
    assert {package.name for package in plan.built} == SHAPES.keys()


def test_only_what_fibws_lacks_is_warned_of(layout: Layout, plan: Plan) -> None:
    warnings = [layout.relative(warning) for warning in plan.warnings]
    missing = ("laser_geometry", "xacro", "rviz", "robot_state_publisher")
    kinds = {
        next((f"{name} not found" for name in missing if f"{name} not found" in warning), warning)
        for warning in warnings
    }
    (cpp,) = [warning for warning in kinds if "C++" in warning]
    assert "turtlesim" in cpp
    assert kinds - {cpp} <= {f"{name} not found" for name in missing}
    assert len(warnings) == len(kinds)


@pytest.mark.parametrize("name", SHAPES)
def test_shape_is_built(layout: Layout, plan: Plan, name: str) -> None:
    shape = SHAPES[name]
    programs = layout.devel / "lib" / name
    found = sorted(path.name for path in programs.iterdir()) if programs.is_dir() else []
    assert found == sorted(shape.programs)
    for path in shape.files:
        if path.endswith((".msg", ".srv", ".action")):
            assert (layout.devel / "share" / name / path).is_file()
    for program in found:
        done = subprocess.run([sys.executable, programs / program], capture_output=True, text=True)
        assert done.stdout == "hello\n", done.stderr


def test_messages_and_modules_can_be_imported(layout: Layout, plan: Plan) -> None:
    root = Path(fibws.__file__).parents[1]
    paths = [layout.devel / "lib/python3/dist-packages", root / "fibws/ros1/python", root]
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(map(str, paths)),
        "FIBWS_INTERFACES": str(layout.devel / "share"),
    }
    program = "\n".join(shape.imports for shape in SHAPES.values())
    words = [sys.executable, "-c", program]
    done = subprocess.run(words, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
