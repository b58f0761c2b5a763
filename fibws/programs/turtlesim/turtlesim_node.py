"""The simulator as a node: turtles that follow velocities, draw, and report what they see.

Topics, services and parameters are those of ROS's turtlesim_node. Besides, ``~picture`` has what
the pens have drawn as a PNG, latched; it is published only while somebody subscribes.
"""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack
from typing import Any, Protocol

import click

import fibws
from fibws.cli import node_program
from fibws.errors import CallRefused
from fibws.msg.geometry_msgs import Twist
from fibws.msg.sensor_msgs import CompressedImage
from fibws.msg.std_msgs import Header
from fibws.msg.turtlesim import Color as ColorMessage
from fibws.msg.turtlesim import Pose as PoseMessage
from fibws.programs.turtlesim.canvas import Color
from fibws.programs.turtlesim.field import (
    BACKGROUND,
    STEP,
    FieldError,
    Pose,
    Seen,
    Turtle,
    TurtleField,
)
from fibws.srv.std_srvs import Empty, EmptyRequest, EmptyResponse
from fibws.srv.turtlesim import (
    Kill,
    KillRequest,
    KillResponse,
    SetPen,
    SetPenRequest,
    SetPenResponse,
    Spawn,
    SpawnRequest,
    SpawnResponse,
    TeleportAbsolute,
    TeleportAbsoluteRequest,
    TeleportAbsoluteResponse,
    TeleportRelative,
    TeleportRelativeRequest,
    TeleportRelativeResponse,
)

PICTURE_STEPS = 4
"""Steps between two pictures: 15 a second."""
MOST_LATE = 0.5
"""Seconds that the simulation may be late before it leaves out steps."""


class _Closable(Protocol):
    def close(self) -> None: ...


class _TurtleTopics:
    """The topics and services of one turtle."""

    def __init__(self, node: fibws.Node, turtle: Turtle) -> None:
        self.turtle = turtle
        self._node = node
        self._open: list[_Closable] = []
        self._task: asyncio.Task[None] | None = None

    async def open(self) -> None:
        """Register them; the turtle obeys commands from then on.

        Raises:
            FibwsError: its name is not one for topics, or the hub refuses one.
        """
        node, name = self._node, self.turtle.name
        commands = node.subscribe(f"{name}/cmd_vel", Twist, queue_size=1)
        self._open.append(commands)
        self._task = asyncio.create_task(self._obey(commands), name=f"commands of {name}")
        self._poses = await node.advertise(f"{name}/pose", PoseMessage, queue_size=1)
        self._open.append(self._poses)
        self._colors = await node.advertise(f"{name}/color_sensor", ColorMessage, queue_size=1)
        self._open.append(self._colors)
        for suffix, type_, handler in (
            ("set_pen", SetPen, self._set_pen),
            ("teleport_absolute", TeleportAbsolute, self._teleport_absolute),
            ("teleport_relative", TeleportRelative, self._teleport_relative),
        ):
            service: Any = await node.service(f"{name}/{suffix}", type_, handler)
            self._open.append(service)

    def close(self) -> None:
        """Remove them from the graph."""
        if self._task is not None:
            self._task.cancel()
        for each in self._open:
            each.close()

    async def publish(self, seen: Seen) -> None:
        """Publish what the turtle sees after a step."""
        pose = PoseMessage(*seen.pose, seen.linear, seen.angular)
        await self._poses.publish(pose)
        await self._colors.publish(ColorMessage(*seen.color))

    async def _obey(self, commands: fibws.Subscription[Twist]) -> None:
        async for twist in commands:
            self.turtle.command(twist.linear.x, twist.angular.z)

    def _set_pen(self, request: SetPenRequest) -> SetPenResponse:
        color = (request.r, request.g, request.b)
        self.turtle.set_pen(color, request.width, off=bool(request.off))
        return SetPenResponse()

    def _teleport_absolute(self, request: TeleportAbsoluteRequest) -> TeleportAbsoluteResponse:
        with _Refused(self._node):
            self.turtle.teleport_absolute(Pose(request.x, request.y, request.theta))
        return TeleportAbsoluteResponse()

    def _teleport_relative(self, request: TeleportRelativeRequest) -> TeleportRelativeResponse:
        with _Refused(self._node):
            self.turtle.teleport_relative(request.linear, request.angular)
        return TeleportRelativeResponse()


class _Refused:
    """Logs errors of the field, and refuses the call that caused them."""

    def __init__(self, node: fibws.Node) -> None:
        self._node = node

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, where: object) -> None:
        if isinstance(error, FieldError | fibws.FibwsError):
            self._node.log.error("%s", error)
            raise CallRefused(str(error)) from None


class Simulator:
    """A field whose turtles are in the graph.

    Args:
        node: a node that has been entered.
    """

    def __init__(self, node: fibws.Node) -> None:
        self._node = node
        self._field = TurtleField()
        self._topics: dict[str, _TurtleTopics] = {}
        self._has_changed = True

    async def run(self) -> None:
        """Register everything and simulate until the node ends.

        Raises:
            FibwsError: the hub refuses a topic or a service.
        """
        node = self._node
        node.log.info("Starting turtlesim with node name %s", node.name)
        await self._fill()
        self._pictures = await node.advertise(
            "~picture", CompressedImage, queue_size=1, latch=True, peers=True
        )
        await self._spawn_first()
        await node.service("clear", Empty, self._clear)
        await node.service("reset", Empty, self._reset)
        await node.service("spawn", Spawn, self._spawn)
        await node.service("kill", Kill, self._kill)
        steps = asyncio.create_task(self._simulate(), name="steps of turtlesim")
        async with AsyncExitStack() as stack:
            stack.callback(steps.cancel)
            await node.spin()

    async def _simulate(self) -> None:
        loop = asyncio.get_running_loop()
        due = loop.time()
        count = 0
        while True:
            due += STEP
            late = loop.time() - due
            if late > MOST_LATE:  # The machine slept, for example.
                due += late
            await asyncio.sleep(max(0.0, due - loop.time()))
            for topics in list(self._topics.values()):
                seen, has_drawn = topics.turtle.step(self._field.canvas, self._node.log.warning)
                self._has_changed |= has_drawn
                await topics.publish(seen)
            count += 1
            if self._has_changed and count % PICTURE_STEPS == 0:
                await self._publish_picture()

    async def _publish_picture(self) -> None:
        peers = self._pictures.peers
        if peers.known and not peers.names:
            return  # The next subscriber gets it.
        self._has_changed = False
        header = Header(stamp=self._node.now())
        await self._pictures.publish(CompressedImage(header, "png", self._field.canvas.png()))

    async def _fill(self) -> None:
        """Fill the picture with the color of the parameters, which are set if they are missing."""
        red, green, blue = [
            await self._component(name, default)
            for name, default in zip("rgb", BACKGROUND, strict=True)
        ]
        color: Color = (red, green, blue)
        self._field.canvas.fill(color)
        self._has_changed = True

    async def _component(self, name: str, default: int) -> int:
        parameter = f"~background_{name}"
        value = await self._node.params.get(parameter, None)
        if value is None:
            await self._node.params.set(parameter, default)
            return default
        if not isinstance(value, int | float) or not 0 <= value <= 255:
            self._node.log.warning(
                "%s must be a number from 0 to 255, got %s", self._node.resolve(parameter), value
            )
            return default
        return int(value)

    async def _spawn_first(self) -> None:
        await self._show(self._field.spawn_first())

    async def _show(self, turtle: Turtle) -> None:
        """Add a turtle to the graph.

        Raises:
            FibwsError: its name is not one for topics, or the hub refuses one.
        """
        topics = _TurtleTopics(self._node, turtle)
        try:
            await topics.open()
        except fibws.FibwsError:
            topics.close()
            if self._field.turtles.get(turtle.name) is turtle:
                self._field.kill(turtle.name)
            raise
        if self._field.turtles.get(turtle.name) is not turtle:
            topics.close()  # It has been killed meanwhile.
            return
        self._topics[turtle.name] = topics
        x, y, theta = turtle.pose
        self._node.log.info(
            "Spawning turtle [%s] at x=[%f], y=[%f], theta=[%f]", turtle.name, x, y, theta
        )

    def _hide(self, turtle: Turtle) -> None:
        topics = self._topics.pop(turtle.name, None)
        if topics is not None:
            topics.close()

    async def _clear(self, request: EmptyRequest) -> EmptyResponse:
        self._node.log.info("Clearing turtlesim.")
        await self._fill()
        return EmptyResponse()

    async def _reset(self, request: EmptyRequest) -> EmptyResponse:
        self._node.log.info("Resetting turtlesim.")
        for turtle in self._field.reset():
            self._hide(turtle)
        await self._spawn_first()
        await self._fill()
        return EmptyResponse()

    async def _spawn(self, request: SpawnRequest) -> SpawnResponse:
        with _Refused(self._node):
            turtle = self._field.spawn(request.name, Pose(request.x, request.y, request.theta))
            await self._show(turtle)
        return SpawnResponse(turtle.name)

    def _kill(self, request: KillRequest) -> KillResponse:
        with _Refused(self._node):
            self._hide(self._field.kill(request.name))
        return KillResponse()


async def simulate(node: fibws.Node) -> None:
    """Simulate turtles until the node ends."""
    await Simulator(node).run()


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("turtlesim", anonymous=False)
def command(node: fibws.Node) -> None:
    """Simulate turtles that draw; the hub's page shows them (fibws open turtlesim).

    Topics: turtle1/cmd_vel, turtle1/pose, turtle1/color_sensor. Services: clear, reset, spawn,
    kill, turtle1/set_pen, turtle1/teleport_absolute, turtle1/teleport_relative. Parameters:
    ~background_r, ~background_g, ~background_b.
    """

    async def program() -> None:
        async with node:
            await simulate(node)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.turtlesim.turtlesim_node")
