"""This machine as launch files see it."""

from __future__ import annotations

import socket
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from fibws import names
from fibws.ros1.errors import PackageNotFound
from fibws.ros1.launch import environment as module
from fibws.ros1.launch.environment import LocalEnvironment, split

from .packages import package


@pytest.fixture
def environment(tmp_path: Path) -> LocalEnvironment:
    return LocalEnvironment(package(tmp_path), yaml.safe_load)


def test_package_has_a_folder(environment: LocalEnvironment, tmp_path: Path) -> None:
    assert environment.find("robot") == tmp_path / "robot"
    with pytest.raises(PackageNotFound, match="did you mean robot"):
        environment.find("robt")
    for name in ("", "..", "../share"):
        with pytest.raises(PackageNotFound):
            environment.find(name)


def test_launch_file_of_rosbridge_is_found(environment: LocalEnvironment) -> None:
    folder = environment.find("rosbridge_server")
    assert (folder / "launch" / "rosbridge_websocket.launch").is_file()


def test_file_is_read(
    environment: LocalEnvironment, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a").write_bytes(b"\xff")
    assert environment.read(str(tmp_path / "a")) == b"\xff"
    with pytest.raises(FileNotFoundError):
        environment.read(str(tmp_path / "b"))
    monkeypatch.setattr(module, "MOST_BYTES", 0)
    with pytest.raises(OSError, match="limit is 0 bytes"):
        environment.read(str(tmp_path / "a"))


def test_output_of_a_command(environment: LocalEnvironment) -> None:
    assert environment.output(f"'{sys.executable}' -c 'print(\"a b\")'").strip() == "a b"


@pytest.mark.parametrize(
    ("command", "error"),
    [
        ("no_such_command x", "cannot run no_such_command: No such file"),
        (f"'{sys.executable}' -c 'exit(3)'", "exit code 3"),
        ("", "empty"),
        ("'x", "No closing quotation"),
    ],
)
def test_failed_command_is_an_error(
    command: str, error: str, environment: LocalEnvironment
) -> None:
    with pytest.raises(ValueError, match=error):
        environment.output(command)


def test_anonymous_names_are_legal_and_unique(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    packages = package(tmp_path)
    monkeypatch.setattr("os.getpid", lambda: 7)
    monkeypatch.setattr("time.time_ns", lambda: 1_795_305_600_123_000_000)
    containers = (LocalEnvironment(packages, yaml.safe_load) for _ in range(2))
    first, second = (container.anonymous("talker") for container in containers)
    assert first != second
    assert first.startswith("talker_")
    assert names.check_base(first) == first


def test_address_is_local_if_it_can_be_bound(
    environment: LocalEnvironment, monkeypatch: pytest.MonkeyPatch
) -> None:
    for address in ("localhost", "127.0.0.1"):
        assert environment.is_local(address), address
    for address in ("192.0.2.1", "a" * 100, "a\0"):  # Of another machine; invalid; invalid.
        assert not environment.is_local(address), address
    for address in ("224.0.0.1", "255.255.255.255"):  # Multicast, broadcast.
        assert not environment.is_local(address), address
    hosts = iter([["192.0.2.1", "127.0.0.1"]])

    def found(*_: object, **__: object) -> list[Any]:
        for each in hosts:
            return [(socket.AF_INET, socket.SOCK_STREAM, 0, "", (host, 0)) for host in each]
        raise socket.gaierror

    monkeypatch.setattr("socket.getaddrinfo", found)
    assert environment.is_local("robot"), "one of its addresses is"
    assert not environment.is_local("nowhere")


def test_variables_and_yaml(environment: LocalEnvironment, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPEED", "2")
    assert environment.variables["SPEED"] == "2"
    assert environment.yaml("[1]") == [1]


def test_commands_are_split_as_by_a_shell(monkeypatch: pytest.MonkeyPatch) -> None:
    assert split("a 'b c' d\\ e") == ["a", "b c", "d e"]
    monkeypatch.setattr("os.name", "nt")
    assert split("C:\\a\\b 'b c' \"d e\"") == ["C:\\a\\b", "b c", "d e"]


@pytest.mark.parametrize(
    "program", ["$(find xacro)/xacro --inorder", "$(find xacro)/xacro.py", "xacro"]
)
def test_xacro_expands_a_robot_with_files_of_packages(
    environment: LocalEnvironment,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    program: str,
) -> None:
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    space = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    (tmp_path / "robot" / "wheel.xacro").write_text(
        f'<robot {space}><xacro:macro name="wheel" params="side">'
        '<link name="${side}_wheel"/></xacro:macro></robot>'
    )
    (tmp_path / "robot" / "robot.xacro").write_text(
        f'<robot name="r" {space}><xacro:include filename="$(find robot)/wheel.xacro"/>'
        '<xacro:arg name="side" default="left"/><xacro:wheel side="$(arg side)"/></robot>'
    )
    program = program.replace("$(find xacro)", str(environment.find("xacro")))
    file = environment.find("robot") / "robot.xacro"
    assert '<link name="right_wheel"/>' in environment.output(f"{program} '{file}' side:=right")
