"""What tools have in common: the client, and how they end."""

from __future__ import annotations

from collections.abc import Callable

import click
import pytest
from click.testing import CliRunner, Result
from hub_in_thread import HubThread

from fibws.cli.common_options import examples, with_hub
from fibws.client.hub_client import HubClient
from fibws.command_names import SETUP


def invoke(body: Callable[[HubClient], None], *words: str, endless: bool = False) -> Result:
    @click.command()
    @with_hub("test", endless=endless)
    def command(client: HubClient) -> None:
        body(client)

    return CliRunner().invoke(command, words)


def interrupt(client: HubClient) -> None:
    raise KeyboardInterrupt


def test_tool_has_a_link_while_it_runs(hub: HubThread) -> None:
    links = []

    def body(client: HubClient) -> None:
        links.append(client)
        assert client.node in client.call("/rosapi/nodes")["nodes"]

    result = invoke(body, "--hub", hub.url)
    assert result.exit_code == 0, result.output
    assert links[0].node.startswith("/fibws_test_")
    with HubClient("other", hub.url) as other:
        assert links[0].node not in other.call("/rosapi/nodes")["nodes"]


def test_where_there_is_no_hub_one_line_says_what_to_do(hub: HubThread) -> None:
    hub.stop()
    result = invoke(lambda client: None, "--hub", hub.url)
    assert result.exit_code == 1
    command = f"fibws hub --port {hub.port}"
    assert result.output == (
        f"Error: No hub at {hub.url} (connection refused). Start one with: {command}\n"
    )


def test_ctrl_c_breaks_off_with_the_code_of_shells(hub: HubThread) -> None:
    assert invoke(interrupt, "--hub", hub.url).exit_code == 130


def test_ctrl_c_is_how_an_endless_tool_ends(hub: HubThread) -> None:
    assert invoke(interrupt, "--hub", hub.url, endless=True).exit_code == 0


def test_examples_follow_the_first_paragraph_of_a_help(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(SETUP, "{}")

    @examples(("{topic pub} /a 'b: {c: 1}'", "a comment"), ("{topic list}", "another"), "cd x")
    def command() -> None:
        """Do it.

        More.
        """

    assert command.__doc__ == (
        "Do it.\n\n\b\n"
        "  rostopic pub /a 'b: {c: 1}'   a comment\n"
        "  rostopic list                 another\n"
        "  cd x\n\n"
        "More."
    )
