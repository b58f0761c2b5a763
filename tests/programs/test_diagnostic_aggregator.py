"""aggregator_node, also beside ROS's."""

from __future__ import annotations

import asyncio
import os
from pathlib import Path
from typing import Any

import pytest
from running_programs import Start

import fibws
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.diagnostic_msgs import DiagnosticArray, DiagnosticStatus, KeyValue

REAL = Path("/usr/lib/diagnostic_aggregator/aggregator_node")
LIBRARIES = Path("/usr/lib/x86_64-linux-gnu")
PLUGIN = "libdiagnostic_aggregator.so"
NODE = ("fibws", "run", "diagnostic_aggregator", "aggregator_node")


def generic(path: str | None, **parameters: Any) -> dict[str, Any]:
    kind = {"type": "diagnostic_aggregator/GenericAnalyzer"}
    return {**kind, **({"path": path} if path else {}), **parameters}


PARAMETERS: dict[str, Any] = {
    "pub_rate": 10.0,
    "base_path": "robot",
    "analyzers": {
        "sensors": generic("Sensors", contains=["laser"], find_and_remove_prefix=["nodeA", "no"]),
        "motors": generic(
            "Motors/all",
            startswith=["m1", "m2: "],
            expected=["m9: lost", "m1: left"],
            remove_prefix=["m1: "],
        ),
        "number": generic("Number", regex=[r"^num\d+$", "nn"], num_items=2),
        "none": generic("None", startswith="qq", num_items=0),
        "named": generic("Named", name=["single", "other thing"], discard_stale=True),
        "group": {
            "type": "diagnostic_aggregator/AnalyzerGroup",
            "path": "Group",
            "analyzers": {
                "one": generic("One", contains="gone"),
                "two": generic("Two", contains="two"),
                "three": {**generic("Three", contains="discard"), "type": "DiscardAnalyzer"},
                "four": {"type": "diagnostic_aggregator/IgnoreAnalyzer", "path": "Four"},
            },
        },
        "unknown": {"type": "diagnostic_aggregator/NoSuch", "path": "Bad"},
        "nopath": generic(None, contains="xx"),
    },
}
ITEMS = [
    ("nodeA: laser", 0),
    ("nodeB: laser", 1),
    ("other/thing", 2),
    ("m1: left", 0),
    ("m2: right", 1),
    ("m3: x", 0),
    *((f"num{number}", 0) for number in range(3)),
    ("single", 0),
    ("is two", 0),
    ("discard me", 2),
    ("nn", 3),
    ("xx", 0),
]
Row = tuple[int, str, str, str, tuple[tuple[str, str], ...]]


def rows(array: DiagnosticArray) -> list[Row]:
    return [
        (
            each.level,
            each.name,
            each.message,
            each.hardware_id,
            tuple((value.key, value.value) for value in each.values),
        )
        for each in array.status
    ]


def statuses() -> DiagnosticArray:
    return DiagnosticArray(
        status=[
            DiagnosticStatus(level, name, "text", f"id {name}", [KeyValue("key", "1")])
            for name, level in ITEMS
        ]
    )


async def settled(node: fibws.Node, topic: str) -> list[Row]:
    """Return the first tree that has all items, while they are published."""
    found = node.subscribe(topic, DiagnosticArray)
    devices = await node.advertise("/diagnostics", DiagnosticArray)

    async def publish() -> None:
        async for _ in node.rate(10):
            await devices.publish(statuses())

    publishing = asyncio.create_task(publish())
    try:
        async for array in found:
            if any(name.endswith("/xx") for _, name, *_ in rows(array)):
                return rows(array)
    finally:
        publishing.cancel()
        found.close()
    raise AssertionError


@pytest.mark.long
async def test_items_are_sorted_into_a_tree(hub: HubServer, start: Start) -> None:
    hub.graph.parameters.set("/diagnostic_aggregator", PARAMETERS)
    async with fibws.Node("test", hub=hub.url) as node:
        tops = node.subscribe("/diagnostics_toplevel_state", DiagnosticStatus)
        await start(*NODE, FIBWS_HUB=hub.url)
        assert (await anext(tops)).level == 2  # The analyzer without items is OK, others are stale.
        tree = await settled(node, "/diagnostics_agg")
        by_name = {name: (level, message) for level, name, message, *_ in tree}
        assert by_name["/robot"] == (2, "Error")
        assert by_name["/robot/Sensors/laser"] == (0, "text")
        assert by_name["/robot/Number"] == (2, "Expected 2, found 4")
        assert by_name["/robot/Motors/all/m9: lost"] == (3, "Missing")
        assert by_name["/robot/nopath"] == (3, "Analyzer init failed")
        assert by_name["/robot/Other/other thing"] == (2, "text")
        assert not any("discard" in name for name in by_name)


@pytest.mark.real_ros
@pytest.mark.skipif(not REAL.is_file(), reason="Debian's diagnostic_aggregator is not installed")
async def test_tree_is_that_of_ros(start: Start, tmp_path: Path) -> None:
    settings = Settings(port=0, ros1=0, ros1_host="127.0.0.1")
    async with HubServer(settings) as hub, fibws.Node("test", hub=hub.url) as node:
        assert hub.ros1 is not None
        for name in ("/ours", "/theirs"):
            hub.graph.parameters.set(name, PARAMETERS)
        topics = [f"/diagnostics_{what}:=/{{}}_{what}" for what in ("agg", "toplevel_state")]
        ours, theirs = ([topic.format(whose) for topic in topics] for whose in ("our", "their"))
        await start(*NODE, "__name:=ours", *ours, FIBWS_HUB=hub.url)
        environment = {**_plugins(tmp_path), "ROS_MASTER_URI": hub.ros1.uri}
        process = await asyncio.create_subprocess_exec(
            str(REAL), "__name:=theirs", *theirs, env=environment
        )
        try:
            expected = await settled(node, "/their_agg")
            assert await settled(node, "/our_agg") == expected
        finally:
            process.terminate()
            await process.wait()


def _plugins(folder: Path) -> dict[str, str]:
    """Return the environment in which ROS's program finds its analyzers.

    Debian has left out the files that list them.
    """
    package = folder / "diagnostic_aggregator"
    package.mkdir()
    (package / "package.xml").write_text(
        "<package><name>diagnostic_aggregator</name><version>1.0.0</version>"
        '<description>x</description><maintainer email="a@example.com">a</maintainer>'
        "<license>BSD</license><run_depend>diagnostic_aggregator</run_depend><export>"
        '<diagnostic_aggregator plugin="${prefix}/plugins.xml"/></export></package>'
    )
    kinds = ("GenericAnalyzer", "DiscardAnalyzer", "IgnoreAnalyzer", "AnalyzerGroup")
    classes = "".join(
        f'<class name="diagnostic_aggregator/{kind}" type="diagnostic_aggregator::{kind}" '
        'base_class_type="diagnostic_aggregator::Analyzer"><description>x</description></class>'
        for kind in kinds
    )
    library = PLUGIN.removesuffix(".so")
    (package / "plugins.xml").write_text(f'<library path="{library}">{classes}</library>')
    (folder / "lib").mkdir()
    (folder / ".catkin").touch()
    (folder / "lib" / PLUGIN).symlink_to(next(LIBRARIES.glob(f"{PLUGIN}.*d")))
    inherited = {key: value for key, value in os.environ.items() if "PYTHON" not in key}
    return {
        **inherited,
        "CMAKE_PREFIX_PATH": str(folder),
        "ROS_PACKAGE_PATH": f"{folder}:/usr/share",
        "ROS_IP": "127.0.0.1",
        "ROS_LOG_DIR": str(folder),
        "HOME": str(folder),
    }
