"""Turtles that move, draw, hit walls and are moved; numbers by hand."""

from __future__ import annotations

from math import inf, nan, pi

import pytest

from fibws.programs.turtlesim.field import (
    BACKGROUND,
    MOST_TURTLES,
    PEN,
    SIZE,
    STEP,
    FieldError,
    Pose,
    Seen,
    Turtle,
    TurtleField,
)

MIDDLE = Pose(SIZE / 2, SIZE / 2, 0.0)


@pytest.fixture
def field() -> TurtleField:
    return TurtleField()


@pytest.fixture
def turtle(field: TurtleField) -> Turtle:
    return field.spawn_first()


def step(field: TurtleField, turtle: Turtle, count: int = 1) -> tuple[Seen, list[str]]:
    """Return what the turtle sees at last, and its warnings."""
    warnings: list[str] = []
    for _ in range(count):
        seen, _ = turtle.step(field.canvas, warnings.append)
    return seen, warnings


def test_first_turtle_is_in_the_middle(turtle: Turtle) -> None:
    assert turtle.name == "turtle1"
    assert turtle.pose == pytest.approx((5.544445, 5.544445, 0.0))


def test_turtle_moves_with_its_velocity(field: TurtleField, turtle: Turtle) -> None:
    turtle.command(2.0, 0.0)
    seen, _ = step(field, turtle, 10)
    assert seen.pose == pytest.approx((MIDDLE.x + 2.0 * 10 * STEP, MIDDLE.y, 0.0))
    assert (seen.linear, seen.angular) == (2.0, 0.0)


def test_turtle_draws_a_circle(field: TurtleField, turtle: Turtle) -> None:
    turtle.command(1.0, 2 * pi / (50 * STEP))
    assert step(field, turtle, 50)[0].pose == pytest.approx(MIDDLE, abs=1e-6)


def test_angle_stays_between_minus_pi_and_pi(field: TurtleField, turtle: Turtle) -> None:
    turtle.command(0.0, 3.0 / STEP)
    assert step(field, turtle, 2)[0].pose.theta == pytest.approx(6.0 - 2 * pi)


def test_turtle_stops_a_second_after_the_last_command(field: TurtleField, turtle: Turtle) -> None:
    turtle.command(1.0, 0.0)
    step(field, turtle, 80)
    assert 1.0 <= turtle.pose.x - MIDDLE.x <= 1.0 + 2 * STEP
    assert turtle.linear == 0.0


def test_wall_stops_a_turtle_with_a_warning(field: TurtleField, turtle: Turtle) -> None:
    turtle.command(1000.0, 0.0)
    seen, warnings = step(field, turtle)
    assert seen.pose.x == SIZE
    assert warnings == ["Oh no! I hit the wall! (Clamping from [x=21.544445, y=5.544445])"]


def test_turtle_sees_the_color_below_it_before_it_draws(field: TurtleField, turtle: Turtle) -> None:
    turtle.command(4.0, 0.0)
    assert step(field, turtle, 20)[0].color == BACKGROUND
    turtle.command(-4.0, 0.0)
    assert step(field, turtle, 10)[0].color == PEN


def test_pen_can_be_lifted_and_changed(field: TurtleField, turtle: Turtle) -> None:
    turtle.set_pen((1, 2, 3), 9, off=True)
    turtle.command(4.0, 0.0)
    step(field, turtle, 20)
    assert turtle.pen == PEN
    turtle.set_pen((255, 0, 0), 0, off=False)
    assert turtle.pen_width == 1
    turtle.teleport_absolute(MIDDLE)
    assert step(field, turtle)[0].color == (255, 0, 0)


def test_teleports_are_done_in_order(field: TurtleField, turtle: Turtle) -> None:
    turtle.teleport_absolute(Pose(1.0, 2.0, pi / 2))
    turtle.teleport_relative(3.0, -pi / 2)
    assert step(field, turtle)[0].pose == pytest.approx((4.0, 2.0, 0.0))


@pytest.mark.parametrize("x", [1e300, -1e300])
def test_teleport_off_the_field_ends_at_the_wall(
    field: TurtleField, turtle: Turtle, x: float
) -> None:
    turtle.teleport_absolute(Pose(x, 1.0, 1e300))
    turtle.teleport_relative(x, 1e300)
    seen, warnings = step(field, turtle)
    assert 0 <= seen.pose.x <= SIZE
    assert len(warnings) == 1


def test_numbers_that_are_not_finite_are_refused(field: TurtleField, turtle: Turtle) -> None:
    turtle.command(nan, 0.0)
    turtle.command(0.0, inf)
    assert step(field, turtle)[0].pose == pytest.approx(MIDDLE)
    with pytest.raises(FieldError, match="nan"):
        turtle.teleport_absolute(Pose(nan, 0, 0))
    with pytest.raises(FieldError, match="inf"):
        turtle.teleport_relative(0, inf)
    with pytest.raises(FieldError, match="inf"):
        field.spawn("x", Pose(0, inf, 0))


def test_turtles_without_a_name_are_counted(field: TurtleField, turtle: Turtle) -> None:
    field.spawn("turtle2", MIDDLE)
    assert field.spawn("", MIDDLE).name == "turtle3"
    with pytest.raises(FieldError, match=r"A turtle named \[turtle2\] already exists"):
        field.spawn("turtle2", MIDDLE)
    field.kill("turtle3")
    with pytest.raises(FieldError, match=r"turtle \[turtle3\], which does not exist"):
        field.kill("turtle3")
    assert field.spawn("", MIDDLE).name == "turtle4"
    field.reset()
    assert field.spawn_first().name == "turtle1"


def test_number_of_turtles_is_limited(field: TurtleField) -> None:
    for _ in range(MOST_TURTLES):
        field.spawn("", MIDDLE)
    with pytest.raises(FieldError, match=str(MOST_TURTLES)):
        field.spawn("", MIDDLE)
