"""The command line, ``fibws``, and the table of its commands."""

from __future__ import annotations

import os
from importlib import import_module
from typing import Any

import click

from fibws import __version__
from fibws.cli.common_options import SETTINGS
from fibws.cli.exit_handling import clean_exit
from fibws.cli.lazy import Command, LazyGroup

BEGIN, LOOK, NOUNS, TYPES, MORE = "Begin", "See it live", "Look and act", "Types", "More"

COMMANDS = {
    "demo": Command(
        "fibws.programs.demo", "Run the first tutorial: a hub, a broadcaster, a listener.", BEGIN
    ),
    "hub": Command("fibws.cli.hub", "Run a hub, which nodes and web pages connect to.", BEGIN),
    "core": Command("fibws.cli.core", "Run a hub as roscore does: one for all nodes.", BEGIN),
    "setup": Command("fibws.cli.setup", "Set up a shell with roscore, rosrun, rospy ...", BEGIN),
    "run": Command("fibws.cli.run", "Run a program of a package, or a rospy script.", BEGIN),
    "workspace": Command(
        "fibws.cli.workspace", "Create and build a workspace of packages: catkin_make.", BEGIN
    ),
    "pkg": Command("fibws.cli.pkg", "Create and find packages: catkin_create_pkg, rospack.", BEGIN),
    "launch": Command("fibws.cli.launch", "Start nodes from launch files: roslaunch.", BEGIN),
    "test": Command("fibws.cli.rostest", "Run the tests of a launch file: rostest.", BEGIN),
    "token": Command("fibws.cli.token", "Create, list and revoke the tokens of a hub.", BEGIN),
    "doctor": Command("fibws.cli.doctor", "Find problems of the setup, hub and graph.", BEGIN),
    "open": Command("fibws.cli.open", "Open the hub's page in a browser: rqt.", LOOK),
    "graph": Command("fibws.cli.graph", "Draw the graph of nodes and topics.", LOOK),
    "top": Command("fibws.cli.top", "Show rates of topics and queues of clients.", LOOK),
    "log": Command("fibws.cli.log", "Show the log messages of nodes.", LOOK),
    "topic": Command("fibws.cli.topic", "List, show, measure and publish topics.", NOUNS),
    "node": Command("fibws.cli.node", "List, inspect, ping and kill nodes.", NOUNS),
    "client": Command("fibws.cli.client", "List the hub's clients, with their rates.", NOUNS),
    "service": Command("fibws.cli.service", "List, inspect and call services.", NOUNS),
    "action": Command("fibws.cli.action", "List and inspect actions, and send goals.", NOUNS),
    "bag": Command("fibws.cli.bag", "Record, play and inspect bags: rosbag.", NOUNS),
    "param": Command("fibws.cli.param", "List, get, set, load and dump parameters.", NOUNS),
    "msg": Command("fibws.cli.msg", "Inspect message types.", TYPES),
    "srv": Command("fibws.cli.srv", "Inspect service types.", TYPES),
    "help": Command("fibws.cli.help", "Show the help of a command, or of connections.", MORE),
    "completion": Command("fibws.cli.completion", "Print a script for completion by TAB.", MORE),
}


class Root(LazyGroup):
    """The group of all commands, with error handling for each."""

    def invoke(self, ctx: click.Context) -> Any:
        """Import and run the command; Ctrl-C may interrupt both."""
        with clean_exit():
            return super().invoke(ctx)


@click.group(cls=Root, modules=COMMANDS, context_settings=SETTINGS)
@click.version_option(__version__, message="fibws %(version)s")
@click.pass_context
def command(context: click.Context) -> None:
    """The ROS graph over WebSockets.

    \b
      fibws demo                    a hub and two nodes in one terminal
      fibws topic echo /fibonacci   in a second terminal: their messages

    The nodes of the tutorial are separate programs: python -m fibws.broadcaster, python -m
    fibws.listener.
    """
    if os.environ.get("NO_COLOR"):  # https://no-color.org
        context.color = False


def main() -> None:
    """Run the command line."""
    if "_FIBWS_COMPLETE" in os.environ:
        import_module("fibws.cli.completion")  # It adapts what click tells the shells.
    command(prog_name="fibws")
