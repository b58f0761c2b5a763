"""Publishes the transform of a static frame, such as a camera on its robot."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

import click

import fibws
from fibws.cli import node_program
from fibws.msg.tf2_msgs import TFMessage
from fibws.tf.buffer import checked
from fibws.tf.history import LATEST, Sample
from fibws.tf.messages import write
from fibws.tf.transform import Transform, of_yaw_pitch_roll

ARGUMENTS = "{X Y Z {YAW PITCH ROLL | QX QY QZ QW} FRAME_ID CHILD_FRAME_ID [PERIOD] | PARAMETER}"


def place(arguments: tuple[str, ...]) -> tuple[str, Sample]:
    """Read the frame and its transform from the arguments.

    Raises:
        UsageError: the arguments are invalid.
    """
    if unknown := [argument for argument in arguments if argument.startswith("--")]:
        raise click.UsageError(f"No such option: {unknown[0]}")
    if not 8 <= len(arguments) <= 10:
        raise click.UsageError(f"expected {ARGUMENTS}, got {len(arguments)} arguments")
    # The seventh of nine arguments is QW, or FRAME_ID if PERIOD is given.
    is_quaternion = len(arguments) == 10 or (len(arguments) == 9 and _is_number(arguments[6]))
    if is_quaternion:
        x, y, z, qx, qy, qz, qw, *_ = _numbers("X Y Z QX QY QZ QW", arguments)
        rotation = (qx, qy, qz, qw)
    else:
        x, y, z, *angles = _numbers("X Y Z YAW PITCH ROLL", arguments)
        rotation = of_yaw_pitch_roll(*angles)
    parent, frame, *period = arguments[7 if is_quaternion else 6 :]
    _numbers("PERIOD", period)
    try:
        return checked(frame, Sample(LATEST, parent, Transform((x, y, z), rotation)))
    except fibws.FibwsError as error:
        raise click.UsageError(str(error)) from None


def _numbers(names: str, arguments: Sequence[str]) -> list[float]:
    for name, argument in zip(names.split(), arguments, strict=False):
        if not _is_number(argument):
            raise click.UsageError(f"{name} must be a number, got {argument!r}")
    return [float(argument) for argument in arguments[: len(names.split())]]


def _is_number(argument: str) -> bool:
    try:
        return isfinite(float(argument))
    except ValueError:
        return False


async def place_in(node: fibws.Node, parameter: str) -> tuple[str, Sample]:
    """Read the frame and its transform from a parameter that holds a TransformStamped.

    Raises:
        ClickException: there is no such parameter, or it is not a transform.
    """
    try:
        value: Any = await node.params.get(parameter)
        transform = value["transform"]
        translation, rotation = transform["translation"], transform["rotation"]
        x, y, z = (float(translation[name]) for name in "xyz")
        qx, qy, qz, qw = (float(rotation[name]) for name in "xyzw")
        frame, parent = str(value["child_frame_id"]), str(value["header"]["frame_id"])
        return checked(frame, Sample(LATEST, parent, Transform((x, y, z), (qx, qy, qz, qw))))
    except fibws.FibwsError as error:
        raise click.ClickException(f"parameter {parameter}: {error}") from None
    except (KeyError, TypeError, ValueError):
        raise click.ClickException(
            f"parameter {parameter} is not a transform: expected header, child_frame_id and "
            "transform, as in geometry_msgs/TransformStamped"
        ) from None


async def publish(node: fibws.Node, frame: str, sample: Sample) -> None:
    """Publish a static transform until the node ends."""
    static = await node.advertise("/tf_static", TFMessage, latch=True)
    now = node.now().to_nanoseconds()
    await static.publish(TFMessage([write(frame, sample._replace(stamp=now))]))
    node.log.info("Spinning until killed publishing %s to %s", sample.parent, frame)
    await node.spin()


# Unknown options may be negative numbers.
@click.command(context_settings={**node_program.SETTINGS, "ignore_unknown_options": True})
@node_program.node("static_transform_publisher", arguments=ARGUMENTS)
def command(node: fibws.Node, arguments: tuple[str, ...]) -> None:
    """Publish the static transform from FRAME_ID to CHILD_FRAME_ID on /tf_static.

    X, Y and Z are metres; YAW, PITCH and ROLL are radians about the axes z, y and x of FRAME_ID,
    ROLL first; QX, QY, QZ and QW are a quaternion.

    PARAMETER is a parameter that holds these values as a geometry_msgs/TransformStamped.

    The transform is published once, on a latched topic, as by tf2_ros. PERIOD is ignored; accepted
    for compatibility with tf.
    """
    known = None if len(arguments) == 1 else place(arguments)

    async def program() -> None:
        async with node:
            await publish(node, *(known or await place_in(node, arguments[0])))

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.static_transform_publisher")
