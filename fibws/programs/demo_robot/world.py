"""A world of walls on a grid, and a robot that drives in it.

Lengths are in meters, angles in radians; x is to the right on the map, y upwards (REP 103).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import product
from typing import TypeAlias

RESOLUTION = 0.25
"""The edge of a cell."""
PLAN = """\
########################################
#                  #                   #
#                  #                   #
#    ##            #         ##        #
#    ##                      ##        #
#                                      #
#                                      #
#                  #                   #
######   ###########                   #
#                  ########   ##########
#                  #                   #
#                  #                   #
#      ####        #                   #
#      ####                 #####      #
#      ####                 #####      #
#                                      #
#                  #                   #
#                  #                   #
########################################
"""
"""The rooms, as seen from above; # is a wall."""
START = (1.0, 0.6, 0.0)
RADIUS = 0.2
"""The robot's."""
ROOM = 0.3
"""Half of the width of the ways that `World.path` finds, except at their ends."""
MOST_SPEED, MOST_TURN = 1.0, 2.0
WHEEL, TRACK = 0.07, 0.34
"""The radius of the wheels, and the distance between them."""
WALL = 0.5
"""The height of the walls, for the depths that the camera sees."""


@dataclass(slots=True)
class RobotPose:
    """A place, and a direction: 0 is along x, a quarter turn to the left is along y."""

    x: float
    y: float
    yaw: float


class World:
    """Walls on a grid.

    Args:
        plan: rows of cells, the upper one first; all have the same length.
    """

    def __init__(self, plan: str = PLAN) -> None:
        rows = plan.splitlines()
        self.width, self.height = len(rows[0]), len(rows)
        self._walls = [[cell == "#" for cell in row] for row in reversed(rows)]

    def cells(self) -> Iterator[bool]:
        """Yield whether each cell is a wall, row by row, from the lower left one on."""
        for row in self._walls:
            yield from row

    def is_wall(self, x: float, y: float) -> bool:
        """Return whether there is a wall at a place; outside of the world, there is."""
        column, row = math.floor(x / RESOLUTION), math.floor(y / RESOLUTION)
        if not (0 <= column < self.width and 0 <= row < self.height):
            return True
        return self._walls[row][column]

    def is_free(self, x: float, y: float, radius: float = RADIUS) -> bool:
        """Return whether a disk at a place touches no wall, which is tried at eight points."""
        return not any(
            self.is_wall(x + radius * math.cos(angle), y + radius * math.sin(angle))
            for angle in (number * math.pi / 4 for number in range(8))
        )

    def is_clear(self, start: tuple[float, float], end: tuple[float, float]) -> bool:
        """Return whether there is room to drive straight from one place to another."""
        (x, y), (to_x, to_y) = start, end
        steps = math.ceil(math.hypot(to_x - x, to_y - y) / (RESOLUTION / 5)) or 1
        return all(
            self.is_free(x + (to_x - x) * at / steps, y + (to_y - y) * at / steps, ROOM)
            for at in range(1, steps + 1)
        )

    def path(
        self, start: tuple[float, float], goal: tuple[float, float]
    ) -> list[tuple[float, float]] | None:
        """Return the places between which a robot drives straight; None if there is no way.

        It is the shortest way over the centers of free cells, found by A* (Hart, Nilsson and
        Raphael, 1968), less the places at which there is no need to turn. The start is not in it.
        """
        if not self.is_free(*goal):
            return None
        first, last = _cell(*start), _cell(*goal)
        free = {first, last}
        for cell in product(range(self.width), range(self.height)):
            # At the ends of the way, it may be closer to walls.
            is_end = min(math.dist(cell, first), math.dist(cell, last)) < 2
            if self.is_free(*_center(cell), RADIUS if is_end else ROOM):
                free.add(cell)
        before: dict[_Cell, _Cell] = {}
        lengths = {first: 0.0}
        queue = [(math.dist(first, last), first)]
        while queue:
            _, cell = heappop(queue)
            if cell == last:
                break
            for next_cell in _neighbours(cell, free):
                length = lengths[cell] + math.dist(cell, next_cell)
                if length < lengths.get(next_cell, math.inf):
                    lengths[next_cell], before[next_cell] = length, cell
                    heappush(queue, (length + math.dist(next_cell, last), next_cell))
        if last not in lengths:
            return None
        places = [goal]
        while (cell := before.get(cell, first)) != first:
            places.insert(0, _center(cell))
        return self._straightened([start, *places])

    def _straightened(self, places: list[tuple[float, float]]) -> list[tuple[float, float]]:
        """Return a way without the places that can be left out; its start is left out, too."""
        kept, at = [], 0
        while at < len(places) - 1:
            ahead = range(len(places) - 1, at, -1)
            at = next((to for to in ahead if self.is_clear(places[at], places[to])), at + 1)
            kept.append(places[at])
        return kept

    def distance(self, x: float, y: float, angle: float, most: float) -> float:
        """Return how far the next wall is in a direction; ``inf`` if it is further than ``most``.

        The ray goes from one line of the grid to the next (Amanatides and Woo, 1987).
        """
        column, row = math.floor(x / RESOLUTION), math.floor(y / RESOLUTION)
        dx, dy = math.cos(angle), math.sin(angle)
        step_x, next_x, per_x = _steps(x, dx)
        step_y, next_y, per_y = _steps(y, dy)
        while True:
            if next_x < next_y:
                length, next_x, column = next_x, next_x + per_x, column + step_x
            else:
                length, next_y, row = next_y, next_y + per_y, row + step_y
            if length > most:
                return math.inf
            inside = 0 <= column < self.width and 0 <= row < self.height
            if not inside or self._walls[row][column]:
                return length


_Cell: TypeAlias = tuple[int, int]
"""A column and a row."""


def _cell(x: float, y: float) -> _Cell:
    return math.floor(x / RESOLUTION), math.floor(y / RESOLUTION)


def _center(cell: _Cell) -> tuple[float, float]:
    return (cell[0] + 0.5) * RESOLUTION, (cell[1] + 0.5) * RESOLUTION


def _neighbours(cell: _Cell, free: Set[_Cell]) -> Iterator[_Cell]:
    """Yield the free cells around one; diagonally only past two free ones."""
    column, row = cell
    for dx, dy in product((-1, 0, 1), repeat=2):
        if (dx or dy) and {(column + dx, row), (column, row + dy), (column + dx, row + dy)} <= free:
            yield column + dx, row + dy


def _steps(at: float, direction: float) -> tuple[int, float, float]:
    """Return the step of a cell, the length to the first line of the grid, and to each further."""
    if direction == 0:
        return 0, math.inf, math.inf
    step = 1 if direction > 0 else -1
    line = math.floor(at / RESOLUTION) + (1 if step > 0 else 0)
    return step, (line * RESOLUTION - at) / direction, RESOLUTION / abs(direction)


class Robot:
    """A robot with two driven wheels in a world.

    Attributes:
        speed: forwards, at most `MOST_SPEED`.
        turn: to the left, at most `MOST_TURN`.
        is_blocked: whether a wall has kept it from moving.
        wheels: the angles of the left and of the right one.
    """

    def __init__(self, world: World, start: Sequence[float] = START) -> None:
        self.world = world
        self.pose = RobotPose(*start)
        self.speed = 0.0
        self.turn = 0.0
        self.is_blocked = False
        self.wheels = [0.0, 0.0]

    def command(self, speed: float, turn: float) -> None:
        """Set the velocity, within its limits; numbers that are not finite are ignored."""
        if math.isfinite(speed) and math.isfinite(turn):
            self.speed = max(-MOST_SPEED, min(MOST_SPEED, speed))
            self.turn = max(-MOST_TURN, min(MOST_TURN, turn))

    def move(self, seconds: float) -> None:
        """Drive for some time; the robot turns at a wall, but does not go through it."""
        pose = self.pose
        middle = pose.yaw + self.turn * seconds / 2
        x = pose.x + self.speed * seconds * math.cos(middle)
        y = pose.y + self.speed * seconds * math.sin(middle)
        pose.yaw = math.remainder(pose.yaw + self.turn * seconds, math.tau)
        self.is_blocked = not self.world.is_free(x, y)
        if not self.is_blocked:
            pose.x, pose.y = x, y
        forward = 0.0 if self.is_blocked else self.speed
        for wheel, side in enumerate((-1, 1)):
            self.wheels[wheel] += (forward + side * self.turn * TRACK / 2) * seconds / WHEEL

    def scan(self, count: int, most: float) -> list[float]:
        """Return the distances to the walls all around, from behind the robot to the left."""
        pose = self.pose
        return [
            self.world.distance(
                pose.x, pose.y, pose.yaw - math.pi + number * math.tau / count, most
            )
            for number in range(count)
        ]

    def look(self, width: int, height: int, field: float) -> bytes:
        """Return what a camera sees: rows of pixels of three bytes, red, green and blue.

        Args:
            width, height: of the picture.
            field: the angle between its left and its right edge.
        """
        pose, columns = self.pose, []
        for column in range(width):
            angle = field * (0.5 - (column + 0.5) / width)
            length = self.world.distance(pose.x, pose.y, pose.yaw + angle, 30.0)
            # Walls are as high as they would be far away from a flat picture.
            half = 0.5 * height / max(0.05, length * math.cos(angle) * 2)
            shade = max(40, 230 - int(length * 22))
            columns.append((half, bytes((shade, shade * 9 // 10, shade * 7 // 10))))
        rows = []
        for row in range(height):
            away = abs(row + 0.5 - height / 2)
            empty = b"\x8c\xb4\xdc" if row < height / 2 else b"\x5a\x64\x50"
            rows.append(b"".join(wall if away < half else empty for half, wall in columns))
        return b"".join(rows)

    def depths(
        self, columns: int, rows: int, field: float, ahead: float, height: float, most: float
    ) -> list[tuple[float, float, float, int]]:
        """Return the points that a camera sees of walls and of the floor.

        Args:
            columns, rows: how many rays there are.
            field: the angle between those at the left and at the right edge.
            ahead: how far the camera is in front of the robot's middle.
            height: how high it is.
            most: how far it sees.

        Returns:
            Of each point x, y and z in the camera's frame, of which x is ahead and z upwards, and
            its brightness from 0 to 255.
        """
        pose, points = self.pose, []
        x = pose.x + ahead * math.cos(pose.yaw)
        y = pose.y + ahead * math.sin(pose.yaw)
        for column in range(columns):
            angle = field * (0.5 - (column + 0.5) / columns)
            wall = self.world.distance(x, y, pose.yaw + angle, most)
            for row in range(rows):
                slope = math.tan(0.75 * field * (0.5 - (row + 0.5) / rows))
                length, shade = wall, max(40, 230 - int(min(wall, most) * 22))
                if slope < 0 and -height / slope < wall:
                    length, shade = -height / slope, 90
                if length < most and height + length * slope < WALL:
                    points.append(
                        (length * math.cos(angle), length * math.sin(angle), length * slope, shade)
                    )
        return points


def toward(pose: RobotPose, x: float, y: float) -> tuple[float, float]:
    """Return the velocity that drives a robot straight to a place: it turns first, then goes."""
    distance = math.hypot(x - pose.x, y - pose.y)
    error = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.yaw, math.tau)
    turn = max(-1.2, min(1.2, 2.5 * error))
    return (min(0.6, distance) if abs(error) < 0.1 else 0.0), turn
