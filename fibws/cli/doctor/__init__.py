"""``fibws doctor``: check this setup for problems, and say how to fix them."""

from __future__ import annotations

import shutil
import sys
import textwrap
import time
from collections import Counter
from collections.abc import Iterator, Mapping

import click

from fibws.cli import output
from fibws.cli.common_options import hub_option, json_option
from fibws.cli.doctor import definitions, graph, hub, hubs, machine, ros1
from fibws.cli.doctor.finding import Finding, ok, wrong
from fibws.client.hub_client import HubClient
from fibws.errors import NodeError

SIGNS = {"ok": "✓", "warning": "!", "wrong": "✗"}
ASCII = {"ok": "+", "warning": "!", "wrong": "x"}
COLOURS = {"ok": "green", "warning": "yellow", "wrong": "red"}
HUBS = "/rosapi/hubs"
INTERVAL = 1.0
"""Seconds between the two snapshots that are compared."""


@click.command()
@json_option
@hub_option
def command(hub: str | None, as_json: bool) -> None:
    """Check this setup for problems, and say how to fix them.

    \b
    python       the version of Python
    packages     the required packages and their versions
    terminal     the encoding of the output
    environment  ROS_NAMESPACE, FIBWS_HUB, FIBWS_TOKEN and proxies
    definitions  the folders and files of FIBWS_INTERFACES
    hub          whether a hub answers
    version      whether the hub has the same version
    token        whether the hub wants a token, and accepts this one
    round trip   the time that a call takes
    clock        the difference between the clocks
    graph        the numbers of nodes and topics
    types        topics of undefined types
    conflicts    nodes that use a topic with another type
    ends         topics without publishers or subscribers, misspelled names
    names        names used twice
    clients      clients that are too slow and lose messages
    hubs         links to other hubs that are down or lose messages, clocks that differ
    master       whether ROS_MASTER_URI leads ROS 1 nodes to the hub
    ros1 nodes   ROS 1 nodes that do not answer, hosts that do not resolve

    The exit code is 1 if something is wrong, 0 if there are only warnings.
    """
    numbers: Counter[str] = Counter()
    for finding in findings(hub):
        numbers[finding.verdict] += 1
        output.as_json(finding.as_json()) if as_json else print_finding(finding)
    if not as_json:
        output.line(f"\n{summary(numbers)}", bold=True)
    if numbers["wrong"]:
        sys.exit(1)


def summary(numbers: Mapping[str, int]) -> str:
    """Return the line that sums up the findings, by their numbers for each verdict."""
    if not numbers["wrong"] and not numbers["warning"]:
        return f"Everything is fine ({output.counted(numbers['ok'], 'check')})."
    found = [
        output.counted(numbers[verdict], noun)
        for verdict, noun in (("wrong", "problem"), ("warning", "warning"))
        if numbers[verdict]
    ]
    return f"{' and '.join(found)}; {output.counted(numbers['ok'], 'check')} passed."


def findings(hub_: str | None) -> Iterator[Finding]:
    """Yield all findings; each check relies on the ones before it."""
    yield from machine.checks(hub.url_of(hub_))
    yield from definitions.checks()
    client = hub.reach(hub_)
    if isinstance(client, Finding):
        yield client
        return
    with client:
        yield ok("hub", f"{client.url} accepts connections")
        yield from hub.certificate(client.certificate_end(), time.time())
        yield hub.version(client.url, client.headers)
        yield from hub.warnings(client.url, client.headers)
        yield from hub.token(client)
        try:
            yield from hub.round_trip(client)
            before, hubs_before = _snapshot(client), client.call(HUBS)
            client.process(INTERVAL)
            now, hubs_now = _snapshot(client), client.call(HUBS)
            yield from graph.checks(before, now, but=client.node)
            yield from hubs.checks(hubs_before, hubs_now)
            run_id, port = hub.master(client)
            yield from ros1.checks(now[0], client.url, run_id, port)
        except NodeError as error:
            yield wrong("hub", str(error), "Check the hub's log. Is it a hub of fibws?")


def _snapshot(client: HubClient) -> graph.Snapshot:
    return client.call("/rosapi/graph"), client.call("/rosapi/statistics")


def print_finding(finding: Finding) -> None:
    """Print a finding, and its advice below."""
    signs = SIGNS if output.can_show("".join(SIGNS.values())) else ASCII
    head = f"{signs[finding.verdict]} {finding.verdict:7}  {finding.check:11}  "
    margin = " " * len(head)
    output.line(head + _wrapped(finding.text, margin), colour=COLOURS[finding.verdict])
    if finding.advice:
        output.line(margin + _wrapped(finding.advice, margin))


def _wrapped(text: str, margin: str) -> str:
    """Wrap a text to the terminal's width, with a margin; return one line for a pipe."""
    text = output.visible(text, keep="")
    if not output.is_terminal():
        return text
    width = shutil.get_terminal_size().columns - len(margin)
    lines = textwrap.wrap(text, max(width, 20), break_on_hyphens=False, break_long_words=False)
    return f"\n{margin}".join(lines)
