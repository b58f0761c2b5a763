"""``fibws graph``: draw the graph in the terminal."""

from __future__ import annotations

import shutil

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.graph.dot import dot
from fibws.cli.graph.drawing import ASCII, LINES, drawing
from fibws.client.graph_view import View
from fibws.client.hub_client import HubClient
from fibws.command_names import command_name

PIPE_WIDTH = 120
"""Characters per line without a terminal."""


@click.command()
@click.argument("namespace", default="/", shell_complete=completers.nodes)
@click.option("--all", "everything", is_flag=True, help="Show the hub, commands and pages, too.")
@click.option(
    "--dot", "as_dot", is_flag=True, help="Print the graph for Graphviz: --dot | dot -Tsvg"
)
@json_option
@with_hub("graph")
def command(
    client: HubClient, namespace: str, everything: bool, as_dot: bool, as_json: bool
) -> None:
    """Draw the graph: nodes, topics, services and actions.

    With NAMESPACE, only names in it are shown, and what is connected to them.

    Hidden without --all: nodes, topics and services of the hub, its page and commands; /rosout and
    the services of loggers; the topics of actions.
    """
    if as_dot and as_json:
        raise click.UsageError("--dot and --json exclude each other.")
    view = View.of(
        client.call("/rosapi/graph"),
        exclude=client.node,
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
        width = shutil.get_terminal_size((PIPE_WIDTH, 0)).columns
        for text, is_head in drawing(view, pen, width):
            output.line(text, bold=is_head)
        if not view.nodes:
            output.line(
                f"No nodes. To start some: {command_name('demo')}"
                if namespace == "/"
                else f"No nodes in {namespace}."
            )
