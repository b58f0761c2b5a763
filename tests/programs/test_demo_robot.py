"""fibws demo robot: a simulated robot on a hub."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator

import pytest
from running_programs import Start

import fibws
from fibws.action.move_base_msgs import MoveBase
from fibws.hub.server import HubServer
from fibws.msg.diagnostic_msgs import DiagnosticArray
from fibws.msg.geometry_msgs import PoseStamped, Twist, Vector3
from fibws.msg.move_base_msgs import MoveBaseGoal
from fibws.msg.nav_msgs import OccupancyGrid, Odometry, Path
from fibws.msg.sensor_msgs import CameraInfo, Image, JointState, LaserScan, PointCloud2
from fibws.msg.std_msgs import String
from fibws.msg.tf2_msgs import TFMessage
from fibws.msg.visualization_msgs import MarkerArray
from fibws.ros1.urdf import read_urdf


@pytest.fixture
async def node(hub: HubServer, start: Start) -> AsyncIterator[fibws.Node]:
    await start("fibws.programs.demo_robot.robot_node", FIBWS_HUB=hub.url)
    async with fibws.Node("test", hub=hub.url) as node:
        yield node


def goal(x: float, y: float, frame: str = "map") -> MoveBaseGoal:
    found = MoveBaseGoal()
    found.target_pose.header.frame_id = frame
    found.target_pose.pose.position.x, found.target_pose.pose.position.y = x, y
    return found


async def test_robot_publishes_what_robots_have(node: fibws.Node) -> None:
    grid = await node.wait_for_message("/map", OccupancyGrid)
    assert len(grid.data) == grid.info.width * grid.info.height
    scan = await node.wait_for_message("/scan", LaserScan)
    assert len(scan.ranges) == 180
    # It starts 0.35 m from the wall to its right, which is nearer than the others.
    back, right, ahead, left = (scan.ranges[at] for at in (0, 45, 90, 135))
    assert [back, right, ahead] == pytest.approx([0.75, 0.35, 3.75], abs=0.01)
    assert left > right
    image = await node.wait_for_message("/camera/image", Image)
    assert len(image.data) == image.step * image.height
    diagnostics = await node.wait_for_message("/diagnostics", DiagnosticArray)
    assert [status.level for status in diagnostics.status] == [0, 1, 0]
    frames = await node.wait_for_message("/tf_static", TFMessage)
    names = [each.child_frame_id for each in frames.transforms]
    assert names == ["odom", "laser", "camera", "camera_optical"]


async def test_robot_has_a_body_whose_wheels_turn(node: fibws.Node) -> None:
    description = await node.wait_for_message("/robot_description", String)
    model = read_urdf(description.data)
    joints = await node.wait_for_message("/joint_states", JointState)
    assert {name for name, joint in model.joints.items() if joint.moves} == set(joints.name)
    assert {"base_link", "laser", "camera"} <= set(model.links)


async def test_robot_sees_depths_and_marks_what_it_knows(node: fibws.Node) -> None:
    cloud = await node.wait_for_message("/camera/points", PointCloud2)
    assert len(cloud.data) == cloud.width * cloud.point_step
    info = await node.wait_for_message("/camera/camera_info", CameraInfo)
    image = await node.wait_for_message("/camera/image", Image)
    assert (info.width, info.header.frame_id) == (image.width, image.header.frame_id)
    markers = (await node.wait_for_message("/markers", MarkerArray)).markers
    assert {marker.ns for marker in markers} == {"rooms", "carpets", "speed", "goal"}


async def test_robot_drives_by_commands_and_stops_without_them(node: fibws.Node) -> None:
    odometry = node.subscribe("/odom", Odometry)
    commands = await node.advertise("/cmd_vel", Twist, peers=True)
    async for names in commands.peers.changes():
        if names:
            break
    await commands.publish(Twist(linear=Vector3(x=0.5)))
    moved = False
    async for message in odometry:
        speed = message.twist.twist.linear.x
        moved = moved or speed == 0.5
        if moved and speed == 0.0:
            break
    assert 1.0 < message.pose.pose.position.x < 3.0


@pytest.mark.long  # The robot needs some seconds for the way.
async def test_goals_are_reached_or_refused(node: fibws.Node) -> None:
    client = node.action_client("/move_base", MoveBase, over="topics")
    await client.wait_for_server(timeout=60)
    turned = goal(2.2, 0.7)
    orientation = turned.target_pose.pose.orientation
    orientation.z, orientation.w = math.sin(0.25), math.cos(0.25)
    reaching = await client.send(turned)
    feedback = await anext(aiter(reaching.feedback()))
    assert feedback.base_position.header.frame_id == "map"
    await reaching.result()
    message = await node.wait_for_message("/odom", Odometry)
    place = message.pose.pose.position
    assert math.hypot(place.x - 2.2, place.y - 0.7) < 0.15
    assert message.pose.pose.orientation.z == pytest.approx(math.sin(0.25), abs=0.05)
    plan = await node.wait_for_message("/plan", Path)
    ends = [(each.pose.position.x, each.pose.position.y) for each in plan.poses]
    assert ends[0] == pytest.approx((1.0, 0.6))
    assert ends[-1] == pytest.approx((2.2, 0.7))
    # RViz and the page publish goals without an action.
    goals = await node.advertise("/move_base_simple/goal", PoseStamped, peers=True)
    async for names in goals.peers.changes():
        if names:
            break
    await goals.publish(goal(1.6, 0.7).target_pose)
    async for message in node.subscribe("/odom", Odometry):
        place = message.pose.pose.position
        if math.hypot(place.x - 1.6, place.y - 0.7) < 0.15:
            break
    with pytest.raises(fibws.FibwsError, match="a wall is in the way"):
        await (await client.send(goal(0.1, 0.1))).result()
    with pytest.raises(fibws.FibwsError, match="in the frame map"):
        await (await client.send(goal(1, 1, "odom"))).result()
