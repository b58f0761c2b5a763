"""turtlesim's programs on a hub: topics, services, keys, launch files, the tutorials' scripts."""

from __future__ import annotations

import asyncio
import os
import re
import sys
from collections.abc import AsyncIterator
from math import cos, hypot, sin
from pathlib import Path

import pytest
from click.testing import CliRunner
from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import Twist, Vector3
from fibws.msg.sensor_msgs import CompressedImage
from fibws.msg.turtlesim import Color, Pose
from fibws.programs.turtlesim import draw_square, mimic, teleop_key, turtlesim_node
from fibws.programs.turtlesim.draw_square import Square
from fibws.programs.turtlesim.field import BACKGROUND
from fibws.srv.std_srvs import Empty
from fibws.srv.turtlesim import Kill, SetPen, Spawn, TeleportAbsolute

TURTLE_BROADCASTER = """
import rospy, tf, turtlesim.msg

def handle(pose, name):
    br = tf.TransformBroadcaster()
    rotation = tf.transformations.quaternion_from_euler(0, 0, pose.theta)
    br.sendTransform((pose.x, pose.y, 0), rotation, rospy.Time.now(), name, "world")

rospy.init_node("broadcaster", anonymous=True)
name = rospy.get_param("~turtle")
rospy.Subscriber("/%s/pose" % name, turtlesim.msg.Pose, handle, name)
rospy.spin()
"""
TURTLE_LISTENER = """
import math, rospy, tf, geometry_msgs.msg, turtlesim.srv

rospy.init_node("listener")
listener = tf.TransformListener()
rospy.wait_for_service("spawn")
rospy.ServiceProxy("spawn", turtlesim.srv.Spawn)(9, 9, 0, "turtle2")
velocity = rospy.Publisher("turtle2/cmd_vel", geometry_msgs.msg.Twist, queue_size=1)
rate = rospy.Rate(20)
while not rospy.is_shutdown():
    try:
        (x, y, _), _ = listener.lookupTransform("/turtle2", "/turtle1", rospy.Time(0))
    except (tf.LookupException, tf.ConnectivityException, tf.ExtrapolationException):
        rate.sleep()
        continue
    command = geometry_msgs.msg.Twist()
    command.linear.x = 2 * math.hypot(x, y)
    command.angular.z = 8 * math.atan2(y, x)
    velocity.publish(command)
    rate.sleep()
"""


@pytest.fixture
async def node(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("test", hub=hub.url) as node:
        yield node


@pytest.fixture
async def simulator(hub: HubServer, start: Start, node: fibws.Node) -> None:
    await start("fibws.programs.turtlesim.turtlesim_node", FIBWS_HUB=hub.url)
    await node.wait_for_service("/kill", timeout=60)


async def test_turtle_obeys_and_reports(simulator: None, node: fibws.Node) -> None:
    poses = node.subscribe("/turtle1/pose", Pose, queue_size=None)
    assert (await anext(poses)).x == pytest.approx(5.544445)
    velocity = await node.advertise("/turtle1/cmd_vel", Twist)
    await velocity.publish(Twist(Vector3(x=2.0), Vector3(z=1.0)))
    moving = await anext(pose async for pose in poses if pose.linear_velocity)
    assert (moving.linear_velocity, moving.angular_velocity) == (2.0, 1.0)
    still = await anext(pose async for pose in poses if not pose.linear_velocity)
    assert still.theta == pytest.approx(1.0, abs=0.1)
    color = await node.wait_for_message("/turtle1/color_sensor", Color)
    assert (color.r, color.g, color.b) == (0xB3, 0xB8, 0xFF)


async def test_services_change_the_field(hub: HubServer, simulator: None, node: fibws.Node) -> None:
    spawned = await node.call("/spawn", Spawn, {"x": 1, "y": 2, "theta": 0})
    assert spawned.name == "turtle2"
    await node.call("/turtle2/set_pen", SetPen, {"r": 255, "width": 5})
    await node.call("/turtle2/teleport_absolute", TeleportAbsolute, {"x": 3, "y": 2, "theta": 1})
    colors = node.subscribe("/turtle2/color_sensor", Color)
    await anext(each async for each in colors if each.r == 255)
    hub.graph.parameters.set("/turtlesim/background_r", 200)
    await node.call("/clear", Empty)
    colors = node.subscribe("/turtle1/color_sensor", Color)
    await anext(each async for each in colors if each.r == 200)
    await node.call("/kill", Kill, {"name": "turtle2"})
    await node.flush()
    assert "/turtle2/pose" not in await node.graph.topics()
    await node.call("/reset", Empty)
    assert (await node.wait_for_message("/turtle1/pose", Pose)).x == pytest.approx(5.544445)


async def test_wrong_calls_are_refused(simulator: None, node: fibws.Node) -> None:
    with pytest.raises(fibws.ServiceError, match=r"A turtle named \[turtle1\] already exists"):
        await node.call("/spawn", Spawn, {"name": "turtle1"})
    with pytest.raises(fibws.ServiceError, match=r"turtle \[x\], which does not exist"):
        await node.call("/kill", Kill, {"name": "x"})
    with pytest.raises(fibws.ServiceError, match="a b"):
        await node.call("/spawn", Spawn, {"name": "a b"})
    assert (await node.call("/spawn", Spawn, {})).name == "turtle2"


async def test_parameters_are_set_and_invalid_ones_reported(
    hub: HubServer, start: Start, node: fibws.Node
) -> None:
    hub.graph.parameters.set("/turtlesim/background_g", "green")
    program = await start("fibws.programs.turtlesim.turtlesim_node", FIBWS_HUB=hub.url)
    await node.wait_for_service("/kill", timeout=60)
    assert "/turtlesim/background_g" in await program.error_line()
    found = [hub.graph.parameters.get(f"/turtlesim/background_{each}") for each in "rb"]
    assert found == [BACKGROUND[0], BACKGROUND[2]]


async def test_picture_is_published_for_late_subscribers(simulator: None, node: fibws.Node) -> None:
    picture = await node.wait_for_message("/turtlesim/picture", CompressedImage)
    assert picture.format == "png"
    assert bytes(picture.data).startswith(b"\x89PNG")


async def test_mimic_follows_remapped_namespaces(
    hub: HubServer, simulator: None, node: fibws.Node, start: Start
) -> None:
    await node.call("/spawn", Spawn, {"x": 1, "y": 1})
    words = ("input:=turtle1", "output:=turtle2")
    await start("fibws.programs.turtlesim.mimic", *words, FIBWS_HUB=hub.url)
    poses = node.subscribe("/turtle2/pose", Pose)
    velocity = await node.advertise("/turtle1/cmd_vel", Twist)
    async for pose in poses:
        await velocity.publish(Twist(Vector3(x=1.5)))
        if pose.linear_velocity == 1.5:
            break


def test_square_has_sides_of_two_meters() -> None:
    square, x, y, theta = Square(), 1.0, 1.0, 0.0
    speed = turn = 0.0
    corners, texts = [], []
    for _ in range(4000):
        twist, text = square.next(Pose(x, y, theta, speed, turn))
        if text and "Reached" in text:
            corners.append((x, y))
        texts.append(text or "")
        speed, turn = twist.linear.x, twist.angular.z
        x, theta = x + 0.016 * speed * round(cos(theta)), theta + 0.016 * turn
        y += 0.016 * speed * round(sin(theta))
    sides = [hypot(b[0] - a[0], b[1] - a[1]) for a, b in zip(corners, corners[2:], strict=False)]
    assert sides[:4] == pytest.approx([2.0] * 4, abs=0.2)
    assert re.match(r"New goal \[3\.0+ 1\.0+, 0\.0+\]", texts[0])


async def test_unmodified_tf_tutorial_lets_one_turtle_follow_another(
    hub: HubServer, simulator: None, node: fibws.Node, start: Start, tmp_path: Path
) -> None:
    listener, broadcaster = tmp_path / "listener.py", tmp_path / "broadcaster.py"
    listener.write_text(TURTLE_LISTENER)
    broadcaster.write_text(TURTLE_BROADCASTER)
    await start("fibws.rospy", str(listener), FIBWS_HUB=hub.url)
    for name in ("turtle1", "turtle2"):
        await start("fibws.rospy", str(broadcaster), f"_turtle:={name}", FIBWS_HUB=hub.url)
    async for pose in node.subscribe("/turtle2/pose", Pose):
        if hypot(pose.x - 5.544445, pose.y - 5.544445) < 0.5:
            break


@pytest.mark.long
async def test_launch_file_starts_it(hub: HubServer, start: Start, tmp_path: Path) -> None:
    path = tmp_path / "turtles.launch"
    path.write_text('<launch><node pkg="turtlesim" type="turtlesim_node" name="sim"/></launch>')
    await start("fibws", "launch", str(path), FIBWS_HUB=hub.url)
    async with fibws.Node("test", hub=hub.url) as node:
        await node.wait_for_service("/sim/get_loggers", timeout=60)
        assert (await node.wait_for_message("/turtle1/pose", Pose)).x == pytest.approx(5.544445)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("\x1b[A\x1bOBq", ["up", "down", "q"]),
        ("\x1b[C\x1b[D", ["right", "left"]),
        ("\xe0K\xe0H", ["left", "up"]),
        ("\x1b[5~", ["\x1b", "[", "5", "~"]),
        ("", []),
    ],
)
def test_keys_of_terminals_are_read(text: str, expected: list[str]) -> None:
    assert list(teleop_key.keys(text)) == expected


@pytest.mark.skipif(os.name == "nt", reason="needs a pseudo-terminal")
async def test_arrow_keys_drive_the_turtle(hub: HubServer, node: fibws.Node) -> None:
    import pty

    main, terminal = pty.openpty()
    commands = node.subscribe("/turtle1/cmd_vel", Twist)
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "fibws.programs.turtlesim.teleop_key"),
        stdin=terminal,
        stdout=asyncio.subprocess.PIPE,
        env={**os.environ, "FIBWS_HUB": hub.url},
    )
    os.close(terminal)
    assert process.stdout is not None
    while b"quit" not in (line := await process.stdout.readline()):
        assert line, "the program has ended"
    os.write(main, b"\x1b[A\x1b[D")
    forwards, left = await anext(commands), await anext(commands)
    assert (forwards.linear.x, forwards.angular.z) == (2.0, 0.0)
    assert (left.linear.x, left.angular.z) == (0.0, 2.0)
    os.write(main, b"q")
    assert await process.wait() == 0
    os.close(main)


async def test_without_a_terminal_teleop_is_an_error(hub: HubServer, start: Start) -> None:
    program = await start("fibws.programs.turtlesim.teleop_key", FIBWS_HUB=hub.url)
    code, _, err = await program.end()
    assert code == 1
    assert "terminal" in err


@pytest.mark.parametrize("module", [draw_square, mimic, teleop_key, turtlesim_node])
def test_help_says_what_a_program_does(module: object) -> None:
    command = module.command  # type: ignore[attr-defined]  # A module with a command.
    assert "turtle" in CliRunner().invoke(command, ["--help"]).output
