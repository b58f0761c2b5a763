"""``fibws open``: the address of what is asked for, and a browser if there is one."""

from __future__ import annotations

import sys
import webbrowser

import pytest
from hub_in_thread import HubThread, Publish, Run

from fibws.cli.open import addresses
from fibws.client.hub_client import HubClient


@pytest.fixture(autouse=True)
def no_display(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """No display, and a browser that only takes note of what it is to open."""
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
        (["topics", "/fibonacci"], "topics/%2Ffibonacci"),
        (["/fibonacci"], "topics/%2Ffibonacci"),
        (["plot"], "topics"),
        (["plot", "/fibonacci"], "topics/%2Ffibonacci/plot"),
        (["plot", "/fibonacci/data"], "topics/%2Ffibonacci/plot"),
        (["plot", "fibonacci/data:other"], "topics/%2Ffibonacci/plot"),
        (["plot", "/fibonacci/data[0]"], "topics/%2Ffibonacci/plot"),
        (["services", "add"], "services/%2Fadd"),
        (["console"], "console"),
        (["parameters"], "parameters"),
    ],
)
def test_it_prints_the_address_alone(
    words: list[str], route: str, run: Run, hub: HubThread, publish: Publish, no_display: list[str]
) -> None:
    publish("/fibonacci", "std_msgs/Int32", {"data": 8})
    result = run("open", *words)
    assert result.exit_code == 0, result.output
    assert result.output == f"{hub.url.replace('ws:', 'http:')}/#/{route}\n"
    assert no_display == []


def test_it_opens_a_browser_where_there_is_a_display(
    run: Run, no_display: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    assert [run("open").stdout.strip()] == no_display


@pytest.mark.parametrize("platform", ["darwin", "win32"])
def test_some_systems_have_a_display_at_any_rate(
    platform: str, run: Run, no_display: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "platform", platform)
    assert [run("open").stdout.strip()] == no_display


def test_it_opens_none_on_a_machine_where_nobody_sits(
    run: Run, no_display: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DISPLAY", "localhost:10.0")
    monkeypatch.setenv("SSH_CONNECTION", "10.0.0.1 22 10.0.0.2 22")
    assert run("open").exit_code == 0
    assert no_display == []


def test_several_topics_have_an_address_each(run: Run, publish: Publish) -> None:
    publish("/a", "std_msgs/Int32")
    publish("/b", "std_msgs/Int32")
    lines = run("open", "plot", "/a/data", "/b/data", "/a").stdout.splitlines()
    assert [line.partition("#")[2] for line in lines] == ["/topics/%2Fa/plot", "/topics/%2Fb/plot"]


def test_a_topic_that_is_not_there_yet_is_said_to_be_so(run: Run) -> None:
    result = run("open", "plot", "/later")
    assert result.exit_code == 0
    assert result.stdout.endswith("/#/topics/%2Flater/plot\n")
    assert result.stderr == "WARNING: topic [/later] does not appear to be published yet\n"


def test_a_hub_on_another_machine_has_its_page_there(client: HubClient) -> None:
    client.url = "wss://robot.example:8443/some/path?key=1"
    assert list(addresses(client, "graph", [])) == ["https://robot.example:8443/#/graph"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["grap"], "The page has no 'grap'; did you mean graph?"),
        (["rviz"], "The page has no 'rviz'. There are graph, topics, plot"),
        (["console", "x"], "console takes no names, such as 'x'."),
        (["plot", "a b"], "'a b' is not a legal name"),
    ],
)
def test_what_the_page_has_not_is_an_error(words: list[str], said: str, run: Run) -> None:
    result = run("open", *words)
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr


def test_without_a_hub_it_says_so_in_a_line(run: Run) -> None:
    result = run("open", "--hub", "ws://127.0.0.1:1")
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr == "Error: No hub at ws://127.0.0.1:1. Start one with: fibws hub\n"
