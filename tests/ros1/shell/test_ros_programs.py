"""Substitutes for programs of ROS's own packages."""

from __future__ import annotations

import re
import sys
from importlib import import_module
from pathlib import Path

import pytest
from click.testing import CliRunner

from fibws.cli.aliases import aliases
from fibws.cli.commands import command
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.ros1.errors import WorkspaceError
from fibws.ros1.shell import ros_programs


@pytest.mark.parametrize(("package", "program"), ros_programs._MODULES)
def test_each_substitute_runs(package: str, program: str) -> None:
    line = ros_programs.command_line(package, program, ["--help"])
    assert line is not None
    assert line[:3] == [sys.executable, "-P", "-m"]
    module, *words = line[3:]
    programs = {"fibws": command, "fibws.cli": aliases}
    program_ = programs[module] if module in programs else import_module(module).command
    result = CliRunner().invoke(program_, words)
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("Usage:")


def test_name_may_end_in_py() -> None:
    assert ros_programs.command_line(
        "rospy_tutorials", "talker.py", []
    ) == ros_programs.command_line("rospy_tutorials", "talker", [])


def test_other_programs_are_unknown() -> None:
    assert ros_programs.command_line("fibonacci", "talker", []) is None
    assert ros_programs.command_line("rospy_tutorials", "nothing", []) is None


def test_programs_of_a_package_are_known() -> None:
    assert ros_programs.names("rospy_tutorials") == [
        *("add_two_ints_server", "add_two_ints_client", "talker", "listener")
    ]
    assert ros_programs.names("rostopic") == ["rostopic"]
    assert ros_programs.names("fibonacci") == []


@pytest.mark.parametrize("package", ros_programs._unsupported())
def test_package_without_a_substitute_is_an_error(package: str) -> None:
    with pytest.raises(WorkspaceError, match=f"^{package} "):
        ros_programs.command_line(package, "anything", [])


async def test_listener_receives_from_talker(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    import asyncio

    async with HubServer(Settings(port=0)) as hub, asyncio.timeout(60):
        monkeypatch.setenv("FIBWS_HUB", hub.url)
        monkeypatch.setenv("PYTHONUNBUFFERED", "1")
        processes = []
        for program in ("listener", "talker"):
            line = ros_programs.command_line("rospy_tutorials", program, [])
            assert line is not None
            processes.append(
                await asyncio.create_subprocess_exec(*line, stdout=asyncio.subprocess.PIPE)
            )
        try:
            out = processes[0].stdout
            assert out is not None
            heard = (await out.readline()).decode()
            assert re.search(r"/listener_\d+_\d+I heard hello world \d+\.\d+\n$", heard)
        finally:
            for process in processes:
                process.terminate()
                await process.communicate()
        assert [process.returncode for process in processes] == [0, 0]
