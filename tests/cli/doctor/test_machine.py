"""What can be said of a machine without a hub."""

from __future__ import annotations

from collections.abc import Callable
from importlib import metadata

import pytest

from fibws.cli.doctor import machine
from fibws.cli.doctor.finding import Finding

HUB = "ws://127.0.0.1:9090"


@pytest.fixture(autouse=True)
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    """An environment that says nothing."""
    names = {"FIBWS_HUB", "FIBWS_INTERFACES", "ROS_NAMESPACE", *machine.OF_ROS}
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
def test_python_is_new_enough_or_not(version: tuple[int, int], verdict: str) -> None:
    finding = machine.python(version)
    assert finding.verdict == verdict
    assert ("Python 3.11" in finding.advice) == (verdict == "wrong")


@pytest.mark.parametrize(
    ("version", "wanted", "expected"),
    [
        ("17.1", ">=17.1,<18", True),
        ("17.1.0", "<18,>=17.1", True),
        ("17.4rc1", ">=17.1,<18", True),
        ("17.0.2", ">=17.1,<18", False),
        ("18.0", ">=17.1,<18", False),
        ("2.9", ">=2.10", False),
        ("1", "", True),
        ("8.1", ">=8.1", True),
    ],
)
def test_versions_compare_by_their_numbers(version: str, wanted: str, expected: bool) -> None:
    assert machine.fits(version, wanted) == expected


def test_the_packages_of_this_very_test_are_fine() -> None:
    assert [finding.verdict for finding in machine.packages()] == ["ok"]


def test_packages_that_lack_or_do_not_fit_are_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    needed = ["click>=8.1", "pydantic<3,>=2.10", "websockets<18,>=17.1", 'ruff; extra == "test"']
    monkeypatch.setattr(metadata, "requires", lambda name: needed)
    monkeypatch.setattr(metadata, "version", versions(click="8.1", websockets="15.0"))
    missing, unfit, fine = machine.packages()
    assert verdicts([missing, unfit, fine]) == ["wrong", "wrong", "ok"]
    assert missing.text == "pydantic is not installed"
    assert missing.advice == 'Install it: python -m pip install "pydantic<3,>=2.10"'
    assert unfit.text == "websockets 15.0 does not fit, needed is <18,>=17.1"
    assert "click 8.1" in fine.text


def test_what_is_not_installed_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(metadata, "distribution", versions())
    (finding,) = machine.packages()
    assert finding.verdict == "warning"


def test_an_empty_environment_is_fine() -> None:
    (finding,) = machine.environment(HUB)
    assert finding.verdict == "ok"
    assert HUB in finding.text


def test_a_hub_that_was_named_is_not_said_to_be_the_default() -> None:
    (finding,) = machine.environment("ws://robot:9091")
    assert (finding.verdict, finding.text) == ("ok", "No variable of fibws is set")


def test_what_is_set_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "robot")
    (finding,) = machine.environment("robot")
    assert (finding.verdict, finding.text) == ("ok", "FIBWS_HUB=robot")


def test_a_namespace_must_be_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "3x")
    (finding,) = machine.environment(HUB)
    assert finding.verdict == "wrong"
    assert "ROS_NAMESPACE: '3x' is not a legal name" in finding.text


@pytest.mark.parametrize("where", ["--hub", "FIBWS_HUB"])
def test_an_address_must_be_one(where: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "http://robot" if where == "FIBWS_HUB" else "other")
    (finding,) = machine.environment("http://robot")
    assert finding.verdict == "wrong"
    assert finding.text.startswith(f"{where}: 'http://robot' is not the address of a hub")


@pytest.mark.parametrize(("hub", "verdict"), [("wss://robot", "warning"), (HUB, "ok")])
def test_proxies_matter_to_secure_hubs(
    hub: str, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HTTPS_PROXY", "http://proxy:8080")
    assert verdicts(list(machine.environment(hub))) == [verdict]


def test_variables_of_another_ros_do_nothing_here(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", "http://robot:11311")
    (finding,) = machine.environment(HUB)
    assert finding.verdict == "warning"
    assert finding.advice == "To say where the hub is, set FIBWS_HUB."
    monkeypatch.setenv("FIBWS_HUB", "robot")
    assert verdicts(list(machine.environment("robot"))) == ["ok"]


@pytest.mark.parametrize(("can_show", "verdict"), [(True, "ok"), (False, "warning")])
def test_an_encoding_has_more_than_ascii_or_not(
    can_show: bool, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.cli.output.can_show", lambda text: can_show)
    assert machine.encoding().verdict == verdict
