"""The command line, ``fibws``. A command is imported when it is called."""

from __future__ import annotations

import os
from typing import Any

import click

from fibws import __version__
from fibws.cli.common_options import SETTINGS
from fibws.cli.exit_handling import ending
from fibws.cli.lazy import Command, LazyGroup

BEGIN, LOOK, NOUNS, TYPES, MORE = "Begin", "See it live", "Look and act", "Types", "More"

COMMANDS = {
    "demo": Command(
        "fibws.cli.demo", "Run the first tutorial: a hub, a broadcaster, a listener.", BEGIN
    ),
    "hub": Command("fibws.hub.__main__", "Run a hub that nodes and web pages meet at.", BEGIN),
    "core": Command("fibws.cli.core", "Run a hub as roscore does: one for all nodes.", BEGIN),
    "setup": Command("fibws.cli.setup", "Give a shell roscore, rosrun, rospy ...", BEGIN),
    "run": Command("fibws.cli.run", "Run a package's program, or a rospy script.", BEGIN),
    "workspace": Command(
        "fibws.cli.workspace", "Begin and build a workspace of packages: catkin_make.", BEGIN
    ),
    "pkg": Command("fibws.cli.pkg", "Make packages, and find them: catkin_create_pkg.", BEGIN),
    "launch": Command("fibws.cli.launch", "Run the nodes that launch files tell of.", BEGIN),
    "doctor": Command("fibws.cli.doctor", "Look for what is wrong with this setup.", BEGIN),
    "open": Command("fibws.cli.open", "Open the hub's page in a browser, as rqt does.", LOOK),
    "graph": Command("fibws.cli.graph", "Draw who publishes what to whom.", LOOK),
    "top": Command("fibws.cli.top", "Show the rates of topics and how clients keep up.", LOOK),
    "log": Command("fibws.cli.log", "Show what the nodes log.", LOOK),
    "topic": Command("fibws.cli.topic", "List, show, measure and publish topics.", NOUNS),
    "node": Command("fibws.cli.node", "Look at nodes, ping them, kill them.", NOUNS),
    "service": Command("fibws.cli.service", "Look at services, call them.", NOUNS),
    "action": Command("fibws.cli.action", "Look at actions, send them goals.", NOUNS),
    "param": Command("fibws.cli.param", "Get and set parameters, load and dump them.", NOUNS),
    "msg": Command("fibws.cli.msg", "Look at the types of messages.", TYPES),
    "srv": Command("fibws.cli.srv", "Look at the types of services.", TYPES),
    "completion": Command(
        "fibws.cli.completion", "Complete commands and names by TAB in a shell.", MORE
    ),
}


class Root(LazyGroup):
    """The group of all commands, which makes an end of each."""

    def invoke(self, ctx: click.Context) -> Any:
        """Import the command and run it, either of which Ctrl-C may break off."""
        with ending():
            return super().invoke(ctx)


@click.group(cls=Root, modules=COMMANDS, context_settings=SETTINGS)
@click.version_option(__version__, message="fibws %(version)s")
@click.pass_context
def command(context: click.Context) -> None:
    """The ROS graph over WebSockets.

    \b
      fibws demo                    all of it, in one terminal
      fibws topic echo /fibonacci   in a second one: what is published there

    The nodes of the tutorial are programs of their own: python -m fibws.broadcaster, python -m
    fibws.listener.
    """
    if os.environ.get("NO_COLOR"):  # https://no-color.org
        context.color = False


def main() -> None:
    """Run the command line."""
    command(prog_name="fibws")
