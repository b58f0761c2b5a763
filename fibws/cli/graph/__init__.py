"""``fibws graph``: who publishes what to whom, drawn in the terminal."""

from __future__ import annotations

import shutil

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.graph.dot import dot
from fibws.cli.graph.drawing import ASCII, LINES, drawing
from fibws.cli.graph.view import View
from fibws.client.hub_client import HubClient

WIDTH_OF_PIPES = 120
"""Characters in a line where no terminal says how many there is room for."""


@click.command()
@click.argument("namespace", default="/", shell_complete=completers.nodes)
@click.option("--all", "everything", is_flag=True, help="Show what belongs to ROS itself, too.")
@click.option("--dot", "as_dot", is_flag=True, help="Print Graphviz: fibws graph --dot | dot -Tsvg")
@json_option
@with_hub("graph")
def command(
    client: HubClient, namespace: str, everything: bool, as_dot: bool, as_json: bool
) -> None:
    """Draw who publishes what to whom: nodes, topics, services, actions.

    With a NAMESPACE, only what is in it and what has to do with that.

    Left out, unless --all: /rosout and the hub's own topics, the services of logging and of the hub
    itself, the topics that an action is made of.
    """
    if as_dot and as_json:
        raise click.UsageError("--dot or --json, not both.")
    view = View.of(
        client.call("/rosapi/graph"),
        but=client.node,
        namespace=client.resolve_namespace(namespace),
        everything=everything,
    )
    if as_json:
        output.as_json(view.as_json())
    elif as_dot:
        for text in dot(view):
            output.line(text)
    else:
        pen = LINES if output.can_show("─┬┤┘├└") else ASCII
        width = shutil.get_terminal_size((WIDTH_OF_PIPES, 0)).columns
        for text, is_head in drawing(view, pen, width):
            output.line(text, bold=is_head)
        if not view.nodes:
            output.line(
                "No node is here yet. To see some: fibws demo"
                if namespace == "/"
                else f"No node is in {namespace}."
            )
