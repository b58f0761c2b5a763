"""The program static_transform_publisher."""

from __future__ import annotations

import asyncio
import re
from math import pi, sqrt

import pytest
from click.testing import CliRunner
from patience import PATIENCE
from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.msg.tf2_msgs import TFMessage
from fibws.programs.static_transform_publisher import command, place
from fibws.tf.transform import Transform

PUBLISHER = "fibws.programs.static_transform_publisher"
HALF = sqrt(0.5)


@pytest.mark.parametrize(
    ("arguments", "rotation"),
    [
        (f"1 -2 .5 {pi / 2} 0 0 base camera", (0, 0, HALF, HALF)),
        (f"1 -2 .5 0 {pi / 2} 0 base camera", (0, HALF, 0, HALF)),
        (f"1 -2 .5 0 0 {-pi / 2} base camera", (-HALF, 0, 0, HALF)),
        ("1 -2 .5 0 0 1 0 base camera", (0, 0, 1, 0)),
        ("1 -2 .5 0 0 1e0 -0 /base /camera", (0, 0, 1, 0)),
        ("1 -2 .5 0 0 1 0 base camera 100", (0, 0, 1, 0)),
        (f"1 -2 .5 {pi} 0 0 base camera 100", (0, 0, 1, 0)),
    ],
)
def test_rotation_is_given_by_angles_or_a_quaternion(
    arguments: str, rotation: tuple[float, ...]
) -> None:
    frame, sample = place(tuple(arguments.split()))
    assert (frame, sample.parent) == ("camera", "base")
    assert sample.transform.translation == (1.0, -2.0, 0.5)
    assert sample.transform.rotation == pytest.approx(rotation)


def test_frames_may_be_numbers() -> None:
    assert place(("1", "2", "3", "0", "0", "0", "4", "5"))[0] == "5"


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        ("", "X Y Z {YAW PITCH ROLL | QX QY QZ QW} FRAME_ID"),
        ("1 2 3 0 0 0 base", "got 7 arguments"),
        ("1 2 3 0 0 0 1 base camera 100 extra", "got 11 arguments"),
        ("1 2 c 0 0 0 base camera", "Z must be a number, got 'c'"),
        ("1 2 3 0 0 base camera 100 fast", "ROLL must be a number, got 'base'"),
        ("1 2 3 0 0 0 base camera fast", "PERIOD must be a number, got 'fast'"),
        ("1 2 3 0 0 0 here base camera 100", "QW must be a number, got 'here'"),
        ("1 2 3 0 0 0 base /base", "the frame 'base' cannot be its own parent"),
        ("1 2 3 0 0 2 0 base camera", "quaternion (x, y, z, w) of length 1"),
        ("1 2 nan 0 0 0 base camera", "Z must be a number, got 'nan'"),
        ("1 2 3 inf 0 0 base camera", "YAW must be a number, got 'inf'"),
        ("1 2 3 0 0 0 base camera --hup=here", "No such option: --hup=here"),
    ],
)
def test_wrong_argument_is_an_error(arguments: str, fault: str) -> None:
    result = CliRunner().invoke(command, arguments.split())
    assert result.exit_code == 2
    assert fault in result.stderr


async def test_late_subscriber_receives_the_transform(hub: HubServer, start: Start) -> None:
    arguments = ("1", "-2", "3", "0", "0", "0", "base", "camera", "__name:=mast")
    program = await start(PUBLISHER, *arguments, "--hub", hub.url)
    line = await program.line()
    assert re.fullmatch(r"\[INFO\] \[.*\]: Spinning until killed publishing base to camera\n", line)
    async with asyncio.timeout(PATIENCE), fibws.Node("test", hub=hub.url) as node:
        transforms = (await anext(node.subscribe("/tf_static", TFMessage))).transforms
        assert await node.graph.publishers("/tf_static") == ["/mast"]
    (camera,) = transforms
    assert (camera.header.frame_id, camera.child_frame_id) == ("base", "camera")
    assert camera.header.stamp.secs > 1_700_000_000
    translation = camera.transform.translation
    assert (translation.x, translation.y, translation.z) == (1, -2, 3)
    await program.stop()


async def test_late_subscriber_receives_transforms_of_all_publishers(
    hub: HubServer, start: Start
) -> None:
    frames = {"camera", "laser", "imu"}
    for frame in frames:
        program = await start(
            PUBLISHER, "0", "0", "0", "0", "0", "0", "base", frame, FIBWS_HUB=hub.url
        )
        await program.line()
    async with asyncio.timeout(PATIENCE), fibws.Node("test", hub=hub.url) as node:
        static = node.subscribe("/tf_static", TFMessage)
        messages = [await anext(static) for _ in frames]
    assert {each.child_frame_id for message in messages for each in message.transforms} == frames


def test_identity_is_published() -> None:
    assert place(tuple("0 0 0 0 0 0 base camera".split()))[1].transform == Transform()


async def test_transform_may_be_in_a_parameter(
    hub: HubServer, start: Start, node: fibws.Node
) -> None:
    value = {
        "header": {"frame_id": "base"},
        "child_frame_id": "camera",
        "transform": {
            "translation": {"x": 1, "y": 2, "z": 3.5},
            "rotation": {"x": 0, "y": 0, "z": 0, "w": 1},
        },
    }
    await node.params.set("/mount", value)
    program = await start(PUBLISHER, "/mount", "--hub", hub.url)
    assert "publishing base to camera" in await program.line()
    async with asyncio.timeout(PATIENCE):
        (camera,) = (await anext(node.subscribe("/tf_static", TFMessage))).transforms
    assert (camera.child_frame_id, camera.transform.translation.z) == ("camera", 3.5)


@pytest.mark.parametrize(
    ("value", "fault"),
    [
        (None, "parameter /mount: "),
        (5, "parameter /mount is not a transform"),
        ({"transform": {}}, "parameter /mount is not a transform"),
    ],
)
async def test_wrong_parameter_is_an_error(
    hub: HubServer, start: Start, node: fibws.Node, value: object, fault: str
) -> None:
    if value is not None:
        await node.params.set("/mount", value)
    program = await start(PUBLISHER, "/mount", "--hub", hub.url)
    code, _, err = await program.end()
    assert code == 1
    assert fault in err
