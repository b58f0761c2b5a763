"""``fibws open``: the printed address, and the browser if there is one."""

from __future__ import annotations

import sys
import webbrowser

import pytest
from hub_in_thread import HubThread, Publish, Run

from fibws.cli.open import addresses
from fibws.client.hub_client import HubClient


@pytest.fixture(autouse=True)
def no_display(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Remove the display, and record what the browser is asked to open."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER", "SSH_CONNECTION"):
        monkeypatch.delenv(name, raising=False)
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    monkeypatch.setattr(sys, "platform", "linux")
    return opened


@pytest.mark.parametrize(
    ("words", "route"),
    [
        ([], "graph"),
        (["graph"], "graph"),
        (["gui"], "graph"),
        (["rqt_graph"], "graph"),
        (["--force-discover", "-s", "rqt_console"], "console"),
        (["graph", "__name:=rqt_graph", "a:=b"], "graph"),
        (["topics"], "topics"),
        (["reconfigure", "/camera"], "reconfigure/%2Fcamera"),
        (["topics", "/fibonacci"], "topics/%2Ffibonacci"),
        (["/fibonacci"], "topics/%2Ffibonacci"),
        (["plot"], "topics"),
        (["plot", "/fibonacci"], "topics/%2Ffibonacci/plot"),
        (["plot", "/fibonacci/data"], "topics/%2Ffibonacci/plot"),
        (["plot", "fibonacci/data:other"], "topics/%2Ffibonacci/plot"),
        (["plot", "/fibonacci/data[0]"], "topics/%2Ffibonacci/plot"),
        (["services", "add"], "services/%2Fadd"),
        (["actions", "fibonacci"], "actions/%2Ffibonacci"),
        (["console"], "console"),
        (["parameters"], "parameters"),
    ],
)
def test_address_is_printed_without_a_browser(
    words: list[str], route: str, run: Run, hub: HubThread, publish: Publish, no_display: list[str]
) -> None:
    publish("/fibonacci", "std_msgs/Int32", {"data": 8})
    result = run("open", *words)
    assert result.exit_code == 0, result.output
    assert result.output == f"{hub.url.replace('ws:', 'http:')}/#/{route}\n"
    assert no_display == []


def test_browser_is_opened_if_there_is_a_display(
    run: Run, no_display: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    assert [run("open").stdout.strip()] == no_display


@pytest.mark.parametrize("platform", ["darwin", "win32"])
def test_macos_and_windows_always_have_a_display(
    platform: str, run: Run, no_display: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "platform", platform)
    assert [run("open").stdout.strip()] == no_display


def test_browser_is_not_opened_over_ssh(
    run: Run, no_display: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DISPLAY", "localhost:10.0")
    monkeypatch.setenv("SSH_CONNECTION", "10.0.0.1 22 10.0.0.2 22")
    assert run("open").exit_code == 0
    assert no_display == []


def test_each_topic_has_an_address(run: Run, publish: Publish) -> None:
    publish("/a", "std_msgs/Int32")
    publish("/b", "std_msgs/Int32")
    lines = run("open", "plot", "/a/data", "/b/data", "/a").stdout.splitlines()
    assert [line.partition("#")[2] for line in lines] == ["/topics/%2Fa/plot", "/topics/%2Fb/plot"]


def test_unknown_topic_is_a_warning(run: Run) -> None:
    result = run("open", "plot", "/later")
    assert result.exit_code == 0
    assert result.stdout.endswith("/#/topics/%2Flater/plot\n")
    assert result.stderr == "WARNING: topic [/later] does not appear to be published yet\n"


def test_page_of_a_remote_hub(client: HubClient) -> None:
    client.url = "wss://robot.example:8443/some/path?key=1"
    assert list(addresses(client, "graph", [])) == ["https://robot.example:8443/some/path/#/graph"]


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["grap"], "did you mean graph?"),
        (["rviz"], "graph, topics, plot"),
        (["console", "x"], "'x'"),
        (["plot", "a b"], "'a b' is not a legal name"),
    ],
)
def test_unknown_part_or_name_is_an_error(words: list[str], text: str, run: Run) -> None:
    result = run("open", *words)
    assert (result.exit_code, result.stdout) == (2, "")
    assert text in result.stderr


def test_missing_hub_is_an_error(run: Run) -> None:
    result = run("open", "--hub", "ws://127.0.0.1:1")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "ws://127.0.0.1:1" in result.stderr
