"""The program tf_echo."""

from __future__ import annotations

from math import sqrt

import pytest
from click.testing import CliRunner
from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.programs.tf_echo import Moment, command, text_of
from fibws.tf.history import Sample
from fibws.tf.transform import Transform

from .conftest import Publish

ECHO = "fibws.programs.tf_echo"


def test_transform_is_printed_as_in_ros() -> None:
    half = sqrt(0.5)
    sample = Sample(1_500_000_000, "map", Transform((1.0, -2.0, 0.0), (0.0, 0.0, half, half)))
    assert text_of(sample).splitlines() == [
        "At time 1.500",
        "- Translation: [1.000, -2.000, 0.000]",
        "- Rotation: in Quaternion [0.000, 0.000, 0.707, 0.707]",
        "            in RPY (radian) [0.000, 0.000, 1.571]",
        "            in RPY (degree) [0.000, 0.000, 90.000]",
    ]
    assert "[1.0, -2.0, 0.0]" in text_of(sample, precision=1)


async def test_static_and_moving_transforms_are_printed(
    hub: HubServer, start: Start, publish: Publish
) -> None:
    await publish(("camera", "base", 2.0), static=True)
    program = await start(ECHO, "base", "camera", "100", "--limit", "2", "--hub", hub.url)
    for _ in range(2):
        assert await program.line() == "At time 0.000\n"
        assert await program.line() == "- Translation: [2.000, 0.000, 0.000]\n"
        for _ in range(3):
            await program.line()
    assert await program.line() == ""


async def test_failure_is_printed_with_the_frames(
    hub: HubServer, start: Start, publish: Publish
) -> None:
    await publish(("camera", "base", 2.0), static=True)
    program = await start(ECHO, "base", "moon", "-l", "1", "--hub", hub.url)
    assert (await program.line()).startswith("Failure at ")
    assert await program.line() == (
        'Exception thrown:"moon" passed to lookupTransform argument source_frame does not exist. \n'
    )
    assert await program.line() == "The current list of frames is:\n"
    assert await program.line() == "Frame camera exists with parent base.\n"


async def test_times_can_be_given(node: fibws.Node) -> None:
    assert Moment().stamp(node) == 0
    assert Moment(time=2.5).stamp(node) == 2_500_000_000
    now = node.now().to_nanoseconds()
    assert now - 2e9 <= Moment(offset=-1).stamp(node) <= now


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        ("map", "expected SOURCE_FRAME TARGET_FRAME [RATE], got 1 arguments"),
        ("map base fast", "RATE must be a number, got 'fast'"),
        ("map base 0", "RATE must be > 0, got 0"),
        ("map base nan", "RATE must be > 0, got nan"),
        ("map base -c 0", "--cache_time must be > 0, got 0"),
        ("map /", "a frame's id is empty"),
    ],
)
def test_wrong_argument_is_an_error(arguments: str, fault: str) -> None:
    result = CliRunner().invoke(command, arguments.split())
    assert result.exit_code == 2
    assert fault in result.stderr
