"""What tools have in common: the link, and how they end."""

from __future__ import annotations

from collections.abc import Callable

import click
from click.testing import CliRunner, Result

from fibws.cli.link import Link
from fibws.cli.tool import linked

from .conftest import HubThread


def invoke(body: Callable[[Link], None], *words: str, endless: bool = False) -> Result:
    @click.command()
    @linked("test", endless=endless)
    def command(link: Link) -> None:
        body(link)

    return CliRunner().invoke(command, words)


def interrupt(link: Link) -> None:
    raise KeyboardInterrupt


def test_a_tool_has_a_link_while_it_runs(hub: HubThread) -> None:
    links = []

    def body(link: Link) -> None:
        links.append(link)
        assert link.node in link.call("/rosapi/nodes")["nodes"]

    result = invoke(body, "--hub", hub.url)
    assert result.exit_code == 0, result.output
    assert links[0].node.startswith("/fibws_test_")
    with Link("other", hub.url) as other:
        assert links[0].node not in other.call("/rosapi/nodes")["nodes"]


def test_where_there_is_no_hub_one_line_says_what_to_do(hub: HubThread) -> None:
    hub.stop()
    result = invoke(lambda link: None, "--hub", hub.url)
    assert result.exit_code == 1
    assert result.output == f"Error: No hub at {hub.url}. Start one with: fibws hub\n"


def test_ctrl_c_breaks_off_with_the_code_of_shells(hub: HubThread) -> None:
    assert invoke(interrupt, "--hub", hub.url).exit_code == 130


def test_ctrl_c_is_how_an_endless_tool_ends(hub: HubThread) -> None:
    assert invoke(interrupt, "--hub", hub.url, endless=True).exit_code == 0
