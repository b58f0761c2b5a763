"""Checks of this machine."""

from __future__ import annotations

import socket
from collections.abc import Callable
from importlib import metadata

import pytest

from fibws.cli.doctor import machine
from fibws.cli.doctor.finding import Finding

HUB = "ws://127.0.0.1:9090"


@pytest.fixture(autouse=True)
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    """Unset all variables that are checked."""
    names = {
        "FIBWS_HUB",
        "FIBWS_INTERFACES",
        "ROS_NAMESPACE",
        *machine.ROS1_VARIABLES,
        *machine.OTHER_ROS,
    }
    for name in (*names, *machine.PROXIES, *(each.upper() for each in machine.PROXIES)):
        monkeypatch.delenv(name, raising=False)


def verdicts(found: list[Finding]) -> list[str]:
    return [finding.verdict for finding in found]


def versions(**known: str) -> Callable[[str], str]:
    def version(name: str) -> str:
        if name not in known:
            raise metadata.PackageNotFoundError(name)
        return known[name]

    return version


@pytest.mark.parametrize(
    ("version", "verdict"), [((3, 10), "wrong"), ((3, 11), "ok"), ((3, 14), "ok"), ((4, 0), "ok")]
)
def test_version_of_python(version: tuple[int, int], verdict: str) -> None:
    finding = machine.python(version)
    assert finding.verdict == verdict
    assert ("Python 3.11" in finding.advice) == (verdict == "wrong")


def test_installed_packages_are_fine() -> None:
    assert [finding.verdict for finding in machine.packages()] == ["ok"]


def test_missing_and_old_packages_are_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    required = [
        *("click>=8.1", "pydantic<3,>=2.10", "websockets<18,>=17.1", "rich>=13"),
        *('ruff; extra == "test"', 'colorama; sys_platform == "none"'),
    ]
    monkeypatch.setattr(metadata, "requires", lambda name: required)
    monkeypatch.setattr(
        metadata, "version", versions(click="8.1.0", websockets="17.0.2", rich="13rc1")
    )
    missing, old, prerelease, fine = machine.packages()
    assert verdicts([missing, old, prerelease, fine]) == ["wrong", "wrong", "wrong", "ok"]
    assert missing.text.startswith("pydantic ")
    assert 'python -m pip install "pydantic<3,>=2.10"' in missing.advice
    assert "websockets 17.0.2" in old.text and "<18,>=17.1" in old.text
    assert "rich 13rc1" in prerelease.text
    assert "click 8.1.0" in fine.text and "ruff" not in fine.text


def test_fibws_that_is_not_installed_is_a_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(metadata, "distribution", versions())
    (finding,) = machine.packages()
    assert finding.verdict == "warning"


def test_empty_environment_is_fine() -> None:
    (finding,) = machine.environment(HUB)
    assert finding.verdict == "ok"
    assert HUB in finding.text


def test_address_from_the_option_is_not_the_default() -> None:
    (finding,) = machine.environment("ws://robot:9091")
    assert finding.verdict == "ok" and "robot" not in finding.text


def test_variables_are_printed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "robot")
    (finding,) = machine.environment("robot")
    assert (finding.verdict, finding.text) == ("ok", "FIBWS_HUB=robot")


def test_invalid_namespace_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "3x")
    (finding,) = machine.environment(HUB)
    assert finding.verdict == "wrong"
    assert "ROS_NAMESPACE" in finding.text and "'3x'" in finding.text


@pytest.mark.parametrize("where", ["--hub", "FIBWS_HUB"])
def test_invalid_address_is_wrong(where: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "http://robot" if where == "FIBWS_HUB" else "other")
    (finding,) = machine.environment("http://robot")
    assert finding.verdict == "wrong"
    assert where in finding.text and "http://robot" in finding.text


@pytest.mark.parametrize(("hub", "verdict"), [("wss://robot", "warning"), (HUB, "ok")])
def test_proxy_for_a_secure_hub_is_a_warning(
    hub: str, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HTTPS_PROXY", "http://proxy:8080")
    assert verdicts(list(machine.environment(hub))) == [verdict]


def test_variables_of_another_ros_are_a_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", "http://robot:11311")
    (finding,) = machine.environment(HUB)
    assert finding.verdict == "warning"
    assert "ROS_MASTER_URI" in finding.text and "FIBWS_HUB" in finding.advice
    monkeypatch.setenv("FIBWS_HUB", "robot")
    assert verdicts(list(machine.environment("robot"))) == ["ok"]


def test_master_on_this_machine_may_be_the_hub(monkeypatch: pytest.MonkeyPatch) -> None:
    for host in ("localhost", "127.0.0.1", socket.gethostname()):
        monkeypatch.setenv("ROS_MASTER_URI", f"http://{host}:11311")
        (finding,) = machine.environment(HUB)
        assert finding.verdict == "ok" and f"ROS_MASTER_URI=http://{host}" in finding.text


@pytest.mark.parametrize(("can_show", "verdict"), [(True, "ok"), (False, "warning")])
def test_ascii_output_is_a_warning(
    can_show: bool, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.cli.output.can_show", lambda text: can_show)
    assert machine.encoding().verdict == verdict


def test_token_is_not_printed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "ws://robot:9090/?token=secret")
    monkeypatch.setenv("FIBWS_TOKEN", "secret")
    (finding,) = machine.environment("ws://robot:9090/?token=secret")
    assert finding.verdict == "ok" and "FIBWS_TOKEN" in finding.text
    assert "secret" not in finding.text


def test_invalid_token_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_TOKEN_FILE", "/nowhere/token")
    (finding,) = machine.environment(HUB)
    assert finding.verdict == "wrong" and "/nowhere/token" in finding.text
