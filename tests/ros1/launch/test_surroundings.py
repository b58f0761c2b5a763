"""This machine, as launch files see it."""

from __future__ import annotations

import socket
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from fibws import names
from fibws.errors import PackageNotFound
from fibws.ros1.launch import surroundings
from fibws.ros1.launch.surroundings import Surroundings, split

from .packages import package


@pytest.fixture
def world(tmp_path: Path) -> Surroundings:
    return Surroundings(package(tmp_path), yaml.safe_load)


def test_a_package_has_a_folder(world: Surroundings, tmp_path: Path) -> None:
    assert world.find("robot") == tmp_path / "robot"
    with pytest.raises(PackageNotFound, match="did you mean robot"):
        world.find("robt")
    for name in ("", "..", "../share"):
        with pytest.raises(PackageNotFound):
            world.find(name)


def test_rosbridge_is_there_and_that_is_noted(world: Surroundings) -> None:
    for _ in range(2):
        folder = world.find("rosbridge_server")
    assert (folder / "launch" / "rosbridge_websocket.launch").is_file()
    assert world.shared == ["rosbridge_server"]


def test_a_file_is_read(
    world: Surroundings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a").write_bytes(b"\xff")
    assert world.read(str(tmp_path / "a")) == b"\xff"
    with pytest.raises(FileNotFoundError):
        world.read(str(tmp_path / "b"))
    monkeypatch.setattr(surroundings, "MOST_BYTES", 0)
    with pytest.raises(OSError, match="more than 0 bytes"):
        world.read(str(tmp_path / "a"))


def test_a_command_prints_a_value(world: Surroundings) -> None:
    assert world.output(f"'{sys.executable}' -c 'print(\"a b\")'").strip() == "a b"


@pytest.mark.parametrize(
    ("command", "error"),
    [
        ("no_such_command x", "cannot run no_such_command: No such file"),
        (f"'{sys.executable}' -c 'exit(3)'", "it has failed with exit code 3"),
        ("", "there is no command"),
        ("'x", "No closing quotation"),
    ],
)
def test_a_command_that_fails_is_an_error(command: str, error: str, world: Surroundings) -> None:
    with pytest.raises(ValueError, match=error):
        world.output(command)


def test_an_anonymous_name_is_legal_and_never_the_same(world: Surroundings) -> None:
    first, second = world.anonymous("talker"), world.anonymous("talker")
    assert first != second
    assert first.startswith("talker_")
    assert names.check_base(first) == first


def test_an_address_is_of_this_machine_if_one_can_listen_there(
    world: Surroundings, monkeypatch: pytest.MonkeyPatch
) -> None:
    for address in ("localhost", "127.0.0.1"):
        assert world.is_here(address), address
    for address in ("192.0.2.1", "a" * 100, "a\0"):  # One of no machine, and two of none at all.
        assert not world.is_here(address), address
    for address in ("224.0.0.1", "255.255.255.255"):  # Those of many machines.
        assert not world.is_here(address), address
    hosts = iter([["192.0.2.1", "127.0.0.1"]])

    def found(*_: object, **__: object) -> list[Any]:
        for each in hosts:
            return [(socket.AF_INET, socket.SOCK_STREAM, 0, "", (host, 0)) for host in each]
        raise socket.gaierror

    monkeypatch.setattr("socket.getaddrinfo", found)
    assert world.is_here("robot"), "one of its addresses is"
    assert not world.is_here("nowhere")


def test_the_environment_and_yaml_are_those_of_here(
    world: Surroundings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SPEED", "2")
    assert world.environment["SPEED"] == "2"
    assert world.yaml("[1]") == [1]


def test_words_are_split_as_by_a_shell(monkeypatch: pytest.MonkeyPatch) -> None:
    assert split("a 'b c' d\\ e") == ["a", "b c", "d e"]
    monkeypatch.setattr("os.name", "nt")
    assert split("C:\\a\\b 'b c' \"d e\"") == ["C:\\a\\b", "b c", "d e"]
