"""Names of nodes: namespaces, anonymous names, remapping."""

from __future__ import annotations

import os
import re

import pytest

from fibws.errors import InvalidName
from fibws.names import Remapping, parse_remappings
from fibws.node.node import Identity


@pytest.fixture(autouse=True)
def no_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_NAMESPACE", raising=False)


def choose(
    name: str, *remappings: str, anonymous: bool = False, namespace: str | None = None
) -> Identity:
    remapping = parse_remappings(remappings)
    return Identity.choose(name, anonymous=anonymous, namespace=namespace, remapping=remapping)


def test_default_namespace_is_the_root() -> None:
    assert choose("talker") == Identity("/talker", "/", Remapping())


def test_environment_variable_sets_the_namespace(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "robot")
    identity = choose("talker")
    assert (identity.name, identity.namespace) == ("/robot/talker", "/robot")
    assert choose("talker", namespace="/arm").name == "/arm/talker"


def test_anonymous_name_has_the_form_of_rospy() -> None:
    name = choose("talker", anonymous=True).name
    assert re.fullmatch(rf"/talker_{os.getpid()}_\d{{13}}", name)


def test_anonymous_names_differ_at_equal_times_and_pids(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("time.time_ns", lambda: 1_795_305_600_123_000_000)
    monkeypatch.setattr("os.getpid", lambda: 1)
    assert choose("talker", anonymous=True).name != choose("talker", anonymous=True).name


def test_command_line_takes_precedence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "leg")
    identity = choose("listener", "__name:=ear", "__ns:=/robot", anonymous=True, namespace="/arm")
    assert identity.name == "/robot/ear"


@pytest.mark.parametrize("name", ["", "a/b", "/talker", "7", "~x"])
def test_invalid_node_name_is_refused(name: str) -> None:
    with pytest.raises(InvalidName):
        choose(name)


def test_names_are_resolved_and_remapped() -> None:
    identity = choose("talker", "fibonacci:=numbers", "~gain:=/gain", namespace="/robot")
    assert identity.resolve("fibonacci") == "/robot/numbers"
    assert identity.resolve("/fibonacci") == "/fibonacci"
    assert identity.resolve("~offset") == "/robot/talker/offset"
    assert identity.resolve("~gain") == "/gain"
