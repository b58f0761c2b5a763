"""``fibws bag``: the counterpart of rosbag."""

from __future__ import annotations

import click

from fibws.cli.lazy import Command, LazyGroup

INSPECTION = "fibws.cli.bag.inspection"
REWRITING = "fibws.cli.bag.rewriting"
COMMANDS = {
    "record": Command("fibws.cli.bag.record", "Record topics in a bag."),
    "play": Command("fibws.cli.bag.play", "Publish the messages of bags."),
    "info": Command(INSPECTION, "Show what is in bags.", attribute="info"),
    "check": Command(INSPECTION, "Compare a bag's types with the installed.", attribute="check"),
    "filter": Command("fibws.cli.bag.filtering", "Copy some of a bag's messages."),
    "compress": Command(REWRITING, "Compress bags.", attribute="compress"),
    "decompress": Command(REWRITING, "Decompress bags.", attribute="decompress"),
    "reindex": Command(
        REWRITING, "Restore bags that were not closed.", attribute="reindex_command"
    ),
}


@click.group(cls=LazyGroup, modules=COMMANDS)
def command() -> None:
    """Record, play, inspect, filter and restore bags: files of recorded messages.

    Bags are .bag files of ROS 1 and, with pip install 'fibws[mcap]', .mcap files. LZ4 compression
    needs pip install 'fibws[bags]'.
    """
