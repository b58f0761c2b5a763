"""``fibws doctor``: what is wrong with this setup, and what to do about it."""

from __future__ import annotations

import shutil
import sys
import textwrap
from collections.abc import Iterator

import click

from fibws.cli import output
from fibws.cli.common_options import hub_option, json_option
from fibws.cli.doctor import definitions, graph, hub, machine
from fibws.cli.doctor.finding import Finding, ok, wrong
from fibws.client.hub_client import HubClient
from fibws.errors import NodeError

SIGNS = {"ok": "✓", "warning": "!", "wrong": "✗"}
ASCII = {"ok": "+", "warning": "!", "wrong": "x"}
COLOURS = {"ok": "green", "warning": "yellow", "wrong": "red"}
MOMENT = 1.0
"""Seconds between the two looks at what changes."""


@click.command()
@json_option
@hub_option
def command(hub: str | None, as_json: bool) -> None:
    """Look for what is wrong with this setup, and say what to do about it.

    \b
    python       is it new enough?
    packages     is all that fibws needs there, in versions that fit?
    terminal     can what is printed have more than ASCII?
    environment  are ROS_NAMESPACE and FIBWS_HUB what they should be? proxies?
    definitions  is every folder of FIBWS_INTERFACES there, does every file parse?
    hub          is there one, or what is it that answers?
    version      is the hub's that of this?
    round trip   does an answer come soon?
    clock        do the clocks agree?
    graph        how much is there?
    types        is there a topic whose type nobody defined?
    ends         topics without publishers or subscribers: were names misspelled?
    names        one name for two things, one program twice, nodes that fight
    clients      who does not keep up, and loses messages?

    It exits with 1 if something is wrong; what only looks odd is a warning.
    """
    is_fine = True
    for finding in findings(hub):
        is_fine &= finding.verdict != "wrong"
        output.as_json(finding.as_json()) if as_json else tell(finding)
    if not is_fine:
        sys.exit(1)


def findings(hub_: str | None) -> Iterator[Finding]:
    """All findings, in the order in which one would look."""
    yield from machine.checks(hub.url_of(hub_))
    yield from definitions.checks()
    client = hub.reach(hub_)
    if isinstance(client, Finding):
        yield client
        return
    with client:
        yield ok("hub", f"{client.url} takes connections")
        yield hub.version(client.url)
        try:
            yield from hub.distance(client)
            before = _look(client)
            client.process(MOMENT)
            yield from graph.checks(before, _look(client), but=client.node)
        except NodeError as error:
            yield wrong("hub", str(error), "Look at the hub's log. Is it a fibws hub?")


def _look(client: HubClient) -> graph.Look:
    return client.call("/rosapi/graph"), client.call("/rosapi/statistics")


def tell(finding: Finding) -> None:
    """Print a finding as a line, and below it what to do."""
    signs = SIGNS if output.can_show("".join(SIGNS.values())) else ASCII
    head = f"{signs[finding.verdict]} {finding.verdict:7}  {finding.check:11}  "
    margin = " " * len(head)
    output.line(head + _wrapped(finding.text, margin), colour=COLOURS[finding.verdict])
    if finding.advice:
        output.line(margin + _wrapped(finding.advice, margin))


def _wrapped(text: str, margin: str) -> str:
    """A text in lines of which all but the first begin with a margin; a pipe gets one line."""
    text = output.visible(text, keep="")
    if not output.is_terminal():
        return text
    width = shutil.get_terminal_size().columns - len(margin)
    lines = textwrap.wrap(text, max(width, 20), break_on_hyphens=False, break_long_words=False)
    return f"\n{margin}".join(lines)
