"""The node of the simulated robot."""

from __future__ import annotations

import asyncio
import math
import struct
from typing import TypeAlias

import click

import fibws
from fibws.action.move_base_msgs import MoveBase
from fibws.cli import node_program
from fibws.msg.actionlib_msgs import GoalID
from fibws.msg.diagnostic_msgs import DiagnosticArray, DiagnosticStatus, KeyValue
from fibws.msg.geometry_msgs import (
    Pose,
    PoseStamped,
    Quaternion,
    Transform,
    TransformStamped,
    Twist,
    Vector3,
)
from fibws.msg.move_base_msgs import (
    MoveBaseActionGoal,
    MoveBaseFeedback,
    MoveBaseGoal,
    MoveBaseResult,
)
from fibws.msg.nav_msgs import OccupancyGrid, Odometry, Path
from fibws.msg.sensor_msgs import (
    CameraInfo,
    Image,
    JointState,
    LaserScan,
    PointCloud2,
    PointField,
)
from fibws.msg.std_msgs import ColorRGBA, Header, String
from fibws.msg.tf2_msgs import TFMessage
from fibws.msg.visualization_msgs import Marker, MarkerArray
from fibws.programs.demo_robot.body import CAMERA, DESCRIPTION, LASER, WHEEL_JOINTS
from fibws.programs.demo_robot.world import RADIUS, RESOLUTION, Robot, World, toward

HZ = 20.0
"""Steps of the simulation, odometry and tf per second; scans, images and diagnostics are fewer."""
SCAN_EVERY, IMAGE_EVERY, DEPTHS_EVERY, DIAGNOSTICS_EVERY = 2, 4, 10, 20
RAYS, RANGE = 180, 8.0
WIDTH, HEIGHT, FIELD = 160, 120, 1.2
COLUMNS, ROWS = 48, 24
"""Rays of the depths."""
SILENCE = 0.5
"""Seconds without a command after which the robot stops."""
BLOCKED = 2.0
"""Seconds at a wall after which a goal is given up."""
NEAR = 0.1
"""Meters from a place at which it is reached."""
ALIGNED = 0.05
"""Radians from the heading of a goal at which it is reached."""

ROOMS = (
    ("Workshop", 3.7, 1.2, (0.9, 0.6, 0.2)),
    ("Kitchen", 3.1, 3.4, (0.3, 0.7, 0.4)),
    ("Hall", 6.1, 3.4, (0.3, 0.5, 0.9)),
    ("Store", 6.0, 1.2, (0.7, 0.4, 0.8)),
)
"""Names of the rooms, where they are, and the colours of their carpets."""

Goal: TypeAlias = fibws.ServerGoal[MoveBaseGoal, MoveBaseResult, MoveBaseFeedback]


class RobotNode:
    """Publishes what a robot sees, and drives it.

    Args:
        node: an entered node.
    """

    def __init__(self, node: fibws.Node) -> None:
        self._node = node
        self._robot = Robot(World())
        self._last_command = -math.inf
        self._images = 0
        self._target: Pose | None = None
        """Where the robot drives to."""

    async def run(self) -> None:
        """Simulate until the node ends."""
        node = self._node
        static = await node.advertise("/tf_static", TFMessage, latch=True)
        grid = await node.advertise("/map", OccupancyGrid, latch=True)
        self._tf = await node.advertise("/tf", TFMessage)
        self._odometry = await node.advertise("/odom", Odometry)
        self._scan = await node.advertise("/scan", LaserScan)
        self._camera = await node.advertise("/camera/image", Image)
        self._info = await node.advertise("/camera/camera_info", CameraInfo)
        self._depths = await node.advertise("/camera/points", PointCloud2)
        self._joints = await node.advertise("/joint_states", JointState)
        self._markers = await node.advertise("/markers", MarkerArray)
        self._diagnostics = await node.advertise("/diagnostics", DiagnosticArray)
        self._plan = await node.advertise("/plan", Path, latch=True)
        description = await node.advertise("/robot_description", String, latch=True)
        await description.publish(String(DESCRIPTION))
        await static.publish(TFMessage(self._mounts()))
        await grid.publish(self._map())
        server = await node.action_server("/move_base", MoveBase, self._go, over="topics")
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(self._follow())
            tasks.create_task(self._simulate())
            tasks.create_task(self._pass_goals())
            tasks.create_task(server.spin())

    async def _follow(self) -> None:
        async for command in self._node.subscribe("/cmd_vel", Twist, queue_size=1):
            self._command(command.linear.x, command.angular.z)

    async def _pass_goals(self) -> None:
        """Pass the goals that RViz and the page publish on to the action, as move_base does."""
        topic = await self._node.advertise("/move_base/goal", MoveBaseActionGoal)
        async for pose in self._node.subscribe("/move_base_simple/goal", PoseStamped, queue_size=1):
            now = self._node.now()
            goal_id = GoalID(now, f"{self._node.name}-{now.secs}.{now.nsecs}")
            await topic.publish(MoveBaseActionGoal(Header(stamp=now), goal_id, MoveBaseGoal(pose)))

    def _command(self, speed: float, turn: float) -> None:
        self._robot.command(speed, turn)
        self._last_command = asyncio.get_running_loop().time()

    async def _simulate(self) -> None:
        step = 0
        async for _ in self._node.rate(HZ):
            if asyncio.get_running_loop().time() - self._last_command > SILENCE:
                self._robot.command(0.0, 0.0)
            self._robot.move(1 / HZ)
            await self._publish(step)
            step += 1

    async def _publish(self, step: int) -> None:
        now = self._node.now()
        await self._tf.publish(TFMessage([self._base(now)]))
        await self._odometry.publish(self._odometry_at(now))
        if step % SCAN_EVERY == 0:
            await self._scan.publish(self._scan_at(now))
            await self._joints.publish(self._joints_at(now))
        if step % IMAGE_EVERY == 0:
            self._images += 1
            await self._camera.publish(self._image_at(now))
            await self._info.publish(self._info_at(now))
        if step % DEPTHS_EVERY == 0:
            await self._depths.publish(self._depths_at(now))
        if step % DIAGNOSTICS_EVERY == 0:
            await self._diagnostics.publish(self._status_at(now))
            await self._markers.publish(self._markers_at(now))

    async def _go(self, goal: Goal) -> MoveBaseResult:
        """Drive to the place of a goal, around walls, and turn to its heading."""
        self._target = goal.request.target_pose.pose
        try:
            fault = await self._drive(goal, goal.request.target_pose)
        finally:
            if self._target is goal.request.target_pose.pose:  # Otherwise another goal is newer.
                self._target = None
        self._command(0.0, 0.0)
        if fault:
            self._node.log.warning("The goal is given up: %s.", fault)
            return goal.aborted(text=fault)
        return goal.canceled() if goal.cancel_requested else MoveBaseResult()

    async def _drive(self, goal: Goal, target: PoseStamped) -> str:
        """Drive to a place until the goal is canceled; return why it cannot be reached."""
        if target.header.frame_id.lstrip("/") != "map":
            return f"expected a goal in the frame map, got {target.header.frame_id!r}"
        pose, position = self._robot.pose, target.pose.position
        places = self._robot.world.path((pose.x, pose.y), (position.x, position.y))
        if places is None:
            return (
                f"there is no way to x {position.x:.2f}, y {position.y:.2f}: a wall is in the way"
            )
        await self._plan.publish(self._plan_of([(pose.x, pose.y), *places]))
        for x, y in places:
            blocked = 0
            while math.hypot(x - pose.x, y - pose.y) >= NEAR:
                blocked = blocked + 1 if self._robot.is_blocked else 0
                if blocked > BLOCKED * HZ:
                    return "a wall is in the way"
                if await self._step(goal, *toward(pose, x, y)):
                    return ""
        yaw = _yaw(target.pose.orientation)
        while yaw is not None and abs(error := math.remainder(yaw - pose.yaw, math.tau)) > ALIGNED:
            if await self._step(goal, 0.0, max(-1.0, min(1.0, 2.5 * error))):
                return ""
        return ""

    async def _step(self, goal: Goal, speed: float, turn: float) -> bool:
        """Drive for a step, and report where the robot is; return whether the goal is canceled."""
        self._command(speed, turn)
        feedback = MoveBaseFeedback()
        feedback.base_position.header.frame_id = "map"
        pose = self._robot.pose
        feedback.base_position.pose = _pose(pose.x, pose.y, pose.yaw)
        await goal.publish_feedback(feedback)
        await goal.cancellation(timeout=1 / HZ)
        return goal.cancel_requested

    # Messages.

    def _map(self) -> OccupancyGrid:
        world = self._robot.world
        grid = OccupancyGrid(Header(stamp=self._node.now(), frame_id="map"))
        info = grid.info
        info.resolution, info.width, info.height = RESOLUTION, world.width, world.height
        info.origin.orientation.w = 1.0
        grid.data = [100 if is_wall else 0 for is_wall in world.cells()]
        return grid

    def _plan_of(self, places: list[tuple[float, float]]) -> Path:
        header = Header(stamp=self._node.now(), frame_id="map")
        return Path(header, [PoseStamped(header, _pose(x, y, 0.0)) for x, y in places])

    def _mounts(self) -> list[TransformStamped]:
        """Return the frames that do not move."""
        stamp = self._node.now()
        # The odometry of this robot does not drift.
        places = [("map", "odom", 0.0, 0.0), ("base_link", "laser", *LASER)]
        places.append(("base_link", "camera", *CAMERA))
        frames = [
            TransformStamped(
                Header(stamp=stamp, frame_id=parent),
                child,
                Transform(Vector3(x, 0.0, z), Quaternion(w=1.0)),
            )
            for parent, child, x, z in places
        ]
        # z ahead and x to the right, as cameras have it (REP 103).
        turn = Transform(Vector3(), Quaternion(-0.5, 0.5, -0.5, 0.5))
        header = Header(stamp=stamp, frame_id="camera")
        return [*frames, TransformStamped(header, "camera_optical", turn)]

    def _base(self, now: fibws.Time) -> TransformStamped:
        pose = _pose(self._robot.pose.x, self._robot.pose.y, self._robot.pose.yaw)
        place = Vector3(pose.position.x, pose.position.y, 0.0)
        header = Header(stamp=now, frame_id="odom")
        return TransformStamped(header, "base_link", Transform(place, pose.orientation))

    def _odometry_at(self, now: fibws.Time) -> Odometry:
        robot = self._robot
        message = Odometry(Header(stamp=now, frame_id="odom"), "base_link")
        message.pose.pose = _pose(robot.pose.x, robot.pose.y, robot.pose.yaw)
        message.twist.twist.linear.x = 0.0 if robot.is_blocked else robot.speed
        message.twist.twist.angular.z = robot.turn
        return message

    def _scan_at(self, now: fibws.Time) -> LaserScan:
        return LaserScan(
            Header(stamp=now, frame_id="laser"),
            angle_min=-math.pi,
            angle_max=math.pi - math.tau / RAYS,
            angle_increment=math.tau / RAYS,
            scan_time=SCAN_EVERY / HZ,
            range_min=RADIUS,
            range_max=RANGE,
            ranges=self._robot.scan(RAYS, RANGE),
        )

    def _joints_at(self, now: fibws.Time) -> JointState:
        return JointState(Header(stamp=now), list(WHEEL_JOINTS), list(self._robot.wheels))

    def _info_at(self, now: fibws.Time) -> CameraInfo:
        header = Header(stamp=now, frame_id="camera_optical")
        info = CameraInfo(header, HEIGHT, WIDTH, "plumb_bob", D=[0.0] * 5)
        focus = WIDTH / 2 / math.tan(FIELD / 2)
        info.K = [focus, 0.0, WIDTH / 2, 0.0, focus, HEIGHT / 2, 0.0, 0.0, 1.0]
        info.R = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
        info.P = [*info.K[:3], 0.0, *info.K[3:6], 0.0, *info.K[6:], 0.0]
        return info

    def _depths_at(self, now: fibws.Time) -> PointCloud2:
        """Return the points that the camera sees; the colours are bytes: blue, green and red."""
        points = self._robot.depths(COLUMNS, ROWS, FIELD, *CAMERA, RANGE)
        size = 16
        data = bytearray(len(points) * size)
        for at, (x, y, z, shade) in enumerate(points):
            color = (shade * 7 // 10, shade * 9 // 10, shade, 0)
            struct.pack_into("<3f4B", data, at * size, x, y, z, *color)
        fields = [
            PointField(name, offset, PointField.FLOAT32, 1)
            for name, offset in (("x", 0), ("y", 4), ("z", 8), ("rgb", 12))
        ]
        return PointCloud2(
            Header(stamp=now, frame_id="camera"),
            height=1,
            width=len(points),
            fields=fields,
            point_step=size,
            row_step=len(data),
            data=bytes(data),
            is_dense=True,
        )

    def _markers_at(self, now: fibws.Time) -> MarkerArray:
        """Return the rooms, the robot's speed above it, and where it drives to."""
        still = Header(stamp=now, frame_id="map")
        markers = []
        for number, (name, x, y, (red, green, blue)) in enumerate(ROOMS):
            text = Marker(still, "rooms", number, Marker.TEXT_VIEW_FACING, text=name)
            text.pose = _pose(x, y, 0.0)
            text.scale.z, text.color = 0.4, ColorRGBA(red, green, blue, 1.0)
            carpet = Marker(still, "carpets", number, Marker.CUBE)
            carpet.pose = _pose(x, y, 0.0)
            carpet.scale = Vector3(1.8, 1.0, 0.01)
            carpet.color = ColorRGBA(red, green, blue, 0.5)
            markers += [text, carpet]
        header = Header(frame_id="base_link")
        speed = Marker(header, "speed", 0, Marker.TEXT_VIEW_FACING, frame_locked=True)
        speed.text = "blocked" if self._robot.is_blocked else f"{self._robot.speed:.1f} m/s"
        speed.pose.position.z = 0.5
        speed.scale.z, speed.color = 0.2, ColorRGBA(0.9, 0.4, 0.1, 1.0)
        speed.lifetime = fibws.Duration(2)
        goal = Marker(still, "goal", 0, Marker.ARROW, Marker.DELETE)
        if self._target is not None:
            goal.action, goal.pose = Marker.ADD, self._target
            goal.scale, goal.color = Vector3(0.5, 0.06, 0.06), ColorRGBA(0.8, 0.2, 0.7, 1.0)
        return MarkerArray([*markers, speed, goal])

    def _image_at(self, now: fibws.Time) -> Image:
        return Image(
            Header(stamp=now, frame_id="camera_optical"),
            HEIGHT,
            WIDTH,
            "rgb8",
            step=3 * WIDTH,
            data=self._robot.look(WIDTH, HEIGHT, FIELD),
        )

    def _status_at(self, now: fibws.Time) -> DiagnosticArray:
        robot = self._robot
        blocked = "a wall is in the way" if robot.is_blocked else "driving freely"
        nearest = min(robot.scan(36, RANGE))
        is_close = nearest < 2 * RADIUS
        return DiagnosticArray(
            Header(stamp=now),
            [
                DiagnosticStatus(
                    DiagnosticStatus.WARN if robot.is_blocked else DiagnosticStatus.OK,
                    "robot/Base/Wheels",
                    blocked,
                    values=[
                        KeyValue("Speed (m/s)", f"{robot.speed:.2f}"),
                        KeyValue("Turn (rad/s)", f"{robot.turn:.2f}"),
                    ],
                ),
                DiagnosticStatus(
                    DiagnosticStatus.WARN if is_close else DiagnosticStatus.OK,
                    "robot/Sensors/Laser",
                    "a wall is close" if is_close else "all is clear",
                    values=[KeyValue("Nearest (m)", f"{nearest:.2f}")],
                ),
                DiagnosticStatus(
                    DiagnosticStatus.OK,
                    "robot/Sensors/Camera",
                    f"{HZ / IMAGE_EVERY:.0f} images per second",
                    values=[KeyValue("Images", str(self._images))],
                ),
            ],
        )


def _pose(x: float, y: float, yaw: float) -> Pose:
    pose = Pose()
    pose.position.x, pose.position.y = x, y
    pose.orientation = Quaternion(z=math.sin(yaw / 2), w=math.cos(yaw / 2))
    return pose


def _yaw(orientation: Quaternion) -> float | None:
    """Return the heading of an orientation; None if it has none, as in an empty message."""
    x, y, z, w = orientation.x, orientation.y, orientation.z, orientation.w
    if not 0.9 < x * x + y * y + z * z + w * w < 1.1:
        return None
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


async def simulate(node: fibws.Node) -> None:
    """Simulate a robot until the node ends."""
    await RobotNode(node).run()


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("robot", anonymous=False)
def command(node: fibws.Node) -> None:
    """Simulate a robot that drives by /cmd_vel.

    It publishes /map, /scan, /camera/image, /camera/points, /odom, /tf, /joint_states, /markers,
    /robot_description and /diagnostics, and drives around walls to goals of the action /move_base
    and of /move_base_simple/goal, in the frame map; /plan is its way.
    """

    async def program() -> None:
        async with node:
            await simulate(node)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.demo_robot.robot_node")
