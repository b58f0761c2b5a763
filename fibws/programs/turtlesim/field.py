"""The field on which turtles move and draw; it knows no node and no clock.

Source of the numbers, limits and texts: turtlesim of ROS Noetic.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from math import cos, floor, isfinite, pi, remainder, sin
from typing import NamedTuple

from fibws.programs.turtlesim.canvas import Canvas, Color

PIXELS = 500
"""The width and height of the picture."""
METER = 45
"""Pixels of a meter."""
STEP = 0.016
"""Seconds of a step."""
COMMAND_SECONDS = 1.0
"""The time after which a turtle stops unless it gets another command."""
BACKGROUND: Color = (0x45, 0x56, 0xFF)
PEN: Color = (0xB3, 0xB8, 0xFF)
PEN_WIDTH = 3
MOST_TURTLES = 100
FAR = 1e6
"""Most meters that a turtle is teleported off the field, before it hits the wall."""


def _float32(value: float) -> float:
    return float(struct.unpack("f", struct.pack("f", value))[0])


SIZE = _float32((PIXELS - 1) / METER)
"""The width and height of the field in meters: 11.088889."""


class FieldError(Exception):
    """A turtle cannot be added, removed or moved."""


class Pose(NamedTuple):
    """Where a turtle is; x to the right and y upwards from the lower left corner, in meters."""

    x: float
    y: float
    theta: float
    """Radians, counterclockwise from the right."""


class Seen(NamedTuple):
    """The values that a turtle publishes after a step."""

    pose: Pose
    linear: float
    """Meters per second."""
    angular: float
    """Radians per second."""
    color: Color
    """The colour below the turtle, before it draws its step."""


@dataclass
class Turtle:
    """A turtle and its pen.

    Attributes:
        name: its name, below which its topics are.
        pose: where it is.
        linear: its speed forwards in meters per second.
        angular: its speed to the left in radians per second.
        pen: the colour that it draws in.
        pen_width: the width of its strokes in pixels.
        draws: whether the pen is down.
    """

    name: str
    pose: Pose
    linear: float = 0.0
    angular: float = 0.0
    pen: Color = PEN
    pen_width: int = PEN_WIDTH
    draws: bool = True
    _quiet_seconds: float = 0.0
    _teleports: list[Callable[[Pose], Pose]] = field(default_factory=list)

    def command(self, linear: float, angular: float) -> None:
        """Move with these speeds for at most `COMMAND_SECONDS`; ignore numbers that are not finite.

        Args:
            linear: meters per second.
            angular: radians per second.
        """
        if isfinite(linear) and isfinite(angular):
            self.linear, self.angular = linear, angular
            self._quiet_seconds = 0.0

    def set_pen(self, color: Color, width: int, *, off: bool) -> None:
        """Change the pen, or only lift it.

        Args:
            color: its colour.
            width: in pixels; 0 for 1.
            off: lift it, and keep its colour and its width.
        """
        self.draws = not off
        if self.draws:
            self.pen, self.pen_width = color, max(1, width)

    def teleport_absolute(self, pose: Pose) -> None:
        """Be somewhere else from the next step on.

        Raises:
            FieldError: a number is not finite.
        """
        _check(pose)
        self._teleports.append(lambda before: pose)

    def teleport_relative(self, linear: float, angular: float) -> None:
        """Turn by an angle, then move by a distance, at the next step.

        Raises:
            FieldError: a number is not finite.
        """
        _check((linear, angular))

        def move(before: Pose) -> Pose:
            theta = remainder(before.theta + angular, 2 * pi)
            x, y = before.x + cos(theta) * linear, before.y + sin(theta) * linear
            return Pose(x, y, theta)

        self._teleports.append(move)

    def step(self, canvas: Canvas, warn: Callable[[str], object]) -> tuple[Seen, bool]:
        """Move for `STEP` seconds and draw; return what it sees, and whether it has drawn.

        Args:
            canvas: what it draws on.
            warn: is called with a text when it hits the wall.
        """
        has_drawn = False
        for teleport in self._teleports:
            before, self.pose = self.pose, _clamped(teleport(self.pose), FAR)
            has_drawn |= self._draw(canvas, before)
        self._teleports.clear()
        if self._quiet_seconds > COMMAND_SECONDS:
            self.linear = self.angular = 0.0
        self._quiet_seconds += STEP
        before = self.pose
        theta = before.theta + self.angular * STEP
        theta -= 2 * pi * floor((theta + pi) / (2 * pi))
        x = before.x + cos(theta) * self.linear * STEP
        y = before.y + sin(theta) * self.linear * STEP
        self.pose = _clamped(Pose(x, y, theta))
        if self.pose[:2] != (x, y):
            # The original counts y from the top.
            warn(f"Oh no! I hit the wall! (Clamping from [x={x:f}, y={SIZE - y:f}])")
        seen = Seen(self.pose, self.linear, self.angular, canvas.color_at(*_pixel(self.pose)))
        if self.pose[:2] != before[:2]:
            has_drawn |= self._draw(canvas, before)
        return seen, has_drawn

    def _draw(self, canvas: Canvas, before: Pose) -> bool:
        if self.draws:
            start, end = (_pixel(_clamped(pose)) for pose in (before, self.pose))
            canvas.draw_stroke(start, end, self.pen, self.pen_width)
        return self.draws


class TurtleField:
    """The turtles and the picture.

    Args:
        background: the colour of the picture.
    """

    def __init__(self, background: Color = BACKGROUND) -> None:
        self.canvas = Canvas(PIXELS, background)
        self.turtles: dict[str, Turtle] = {}
        self._count = 0

    def spawn(self, name: str, pose: Pose) -> Turtle:
        """Add a turtle.

        Args:
            name: its name; empty for ``turtle1``, ``turtle2`` and so on.
            pose: where it is.

        Raises:
            FieldError: there is one of this name, there are too many, or a number is not finite.
        """
        _check(pose)
        if name in self.turtles:
            raise FieldError(f"A turtle named [{name}] already exists")
        if len(self.turtles) == MOST_TURTLES:
            raise FieldError(f"too many turtles (limit {MOST_TURTLES}): kill one first")
        while not name or name in self.turtles:
            self._count += 1
            name = f"turtle{self._count}"
        turtle = self.turtles[name] = Turtle(name, pose)
        return turtle

    def spawn_first(self) -> Turtle:
        """Add a turtle in the middle, the next one without a name of its own."""
        return self.spawn("", Pose(SIZE / 2, SIZE / 2, 0.0))

    def kill(self, name: str) -> Turtle:
        """Remove a turtle; what it has drawn stays.

        Raises:
            FieldError: the turtle does not exist.
        """
        if name not in self.turtles:
            raise FieldError(f"Tried to kill turtle [{name}], which does not exist")
        return self.turtles.pop(name)

    def reset(self) -> list[Turtle]:
        """Remove all turtles, and count from 1 again; return those removed."""
        removed = list(self.turtles.values())
        self.turtles.clear()
        self._count = 0
        return removed


def _clamped(pose: Pose, beyond: float = 0.0) -> Pose:
    """Move a pose onto the field, or to at most ``beyond`` meters from it."""
    x, y = (min(max(each, -beyond), SIZE + beyond) for each in pose[:2])
    return Pose(x, y, pose.theta)


def _pixel(pose: Pose) -> tuple[float, float]:
    return pose.x * METER, (SIZE - pose.y) * METER


def _check(numbers: tuple[float, ...]) -> None:
    if not all(map(isfinite, numbers)):
        raise FieldError(f"expected finite numbers, got {', '.join(map(str, numbers))}")
