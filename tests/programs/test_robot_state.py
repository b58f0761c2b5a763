"""robot_state_publisher and joint_state_publisher, also beside ROS's robot_state_publisher."""

from __future__ import annotations

import asyncio
import os
from pathlib import Path

import pytest
from ros1.test_urdf import ARM
from running_programs import Start

import fibws
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.sensor_msgs import JointState
from fibws.msg.std_msgs import Header
from fibws.msg.tf2_msgs import TFMessage

REAL = Path("/usr/lib/robot_state_publisher/robot_state_publisher")
Numbers = list[float]


def frames_of(message: TFMessage) -> dict[tuple[str, str], Numbers]:
    """Return the numbers of each transform, by its two frames."""
    found = {}
    for each in message.transforms:
        t, r = each.transform.translation, each.transform.rotation
        found[each.header.frame_id, each.child_frame_id] = [t.x, t.y, t.z, r.x, r.y, r.z, r.w]
    return found


async def watch(node: fibws.Node, topic: str) -> dict[tuple[str, str], Numbers]:
    return frames_of(await node.wait_for_message(topic, TFMessage))


@pytest.mark.long
async def test_launch_file_publishes_the_frames_of_a_robot(
    hub: HubServer, start: Start, tmp_path: Path
) -> None:
    (tmp_path / "arm.urdf").write_text(ARM)
    launch = tmp_path / "arm.launch"
    launch.write_text(
        "<launch>"
        f'<param name="robot_description" textfile="{tmp_path}/arm.urdf"/>'
        '<node pkg="robot_state_publisher" type="robot_state_publisher" name="state"/>'
        '<node pkg="joint_state_publisher" type="joint_state_publisher" name="joints">'
        "<rosparam>{zeros: {shoulder: 0.5}, source_list: [others]}</rosparam></node>"
        "</launch>"
    )
    async with fibws.Node("test", hub=hub.url) as node:
        moving = node.subscribe("/tf", TFMessage)
        states = node.subscribe("/joint_states", JointState)
        others = await node.advertise("/others", JointState, latch=True)
        await others.publish(JointState(name=["elbow"], position=[0.25]))
        await start("fibws", "launch", str(launch), FIBWS_HUB=hub.url)
        assert list(await watch(node, "/tf_static")) == [("finger", "tool")]
        async for state in states:
            if state.position[1] == 0.25:
                assert list(state.name) == ["shoulder", "elbow", "slide"]
                assert list(state.position) == [0.5, 0.25, 1.5]
                break
        async for message in moving:
            frames = frames_of(message)
            assert len(frames) == 3
            if frames["upper", "lower"][3]:
                break
        assert frames["lower", "finger"][:3] == pytest.approx([0, 1.5, 0])


@pytest.mark.long
async def test_invalid_or_missing_description_is_an_error(hub: HubServer, start: Start) -> None:
    words = ("fibws", "run", "robot_state_publisher", "robot_state_publisher")
    code, _, err = await (await start(*words, FIBWS_HUB=hub.url)).end()
    assert code == 1
    assert "robot_description not found" in err
    hub.graph.parameters.set("/robot_description", "<robot><link/></robot>")
    code, _, err = await (await start(*words, FIBWS_HUB=hub.url)).end()
    assert code == 1
    assert "/robot_description:1: <link> requires attribute name" in err


@pytest.mark.real_ros
@pytest.mark.skipif(not REAL.is_file(), reason="Debian's robot_state_publisher is not installed")
async def test_transforms_are_those_of_ros(start: Start, tmp_path: Path) -> None:
    settings = Settings(port=0, ros1=0, ros1_host="127.0.0.1")
    async with HubServer(settings) as hub, fibws.Node("test", hub=hub.url) as node:
        assert hub.ros1 is not None
        hub.graph.parameters.set("/robot_description", ARM)
        environment = {key: value for key, value in os.environ.items() if "PYTHON" not in key}
        environment |= {"ROS_MASTER_URI": hub.ros1.uri, "ROS_IP": "127.0.0.1"}
        environment |= {"ROS_LOG_DIR": str(tmp_path), "HOME": str(tmp_path)}
        ours = ("fibws", "run", "robot_state_publisher", "robot_state_publisher")
        await start(
            *ours, "__name:=ours", "/tf:=/our_tf", "/tf_static:=/our_static", FIBWS_HUB=hub.url
        )
        process = await asyncio.create_subprocess_exec(
            str(REAL), "/tf:=/their_tf", "/tf_static:=/their_static", env=environment
        )
        try:
            tops = [node.subscribe(f"/{whose}_tf", TFMessage) for whose in ("our", "their")]
            found = [asyncio.create_task(anext(top)) for top in tops]
            states = await node.advertise("/joint_states", JointState)
            async for _ in node.rate(10):
                header = Header(stamp=node.now())
                names, positions = ["shoulder", "elbow"], [0.4, -2.5]
                await states.publish(JointState(header, names, positions))
                if all(task.done() for task in found):
                    break
            mine, theirs = (frames_of(task.result()) for task in found)
            assert mine.keys() == theirs.keys()
            for key, numbers in theirs.items():
                assert mine[key] == pytest.approx(numbers, abs=1e-12)
            mine, theirs = await watch(node, "/our_static"), await watch(node, "/their_static")
            assert mine.keys() == theirs.keys()
            for key, numbers in theirs.items():
                assert mine[key] == pytest.approx(numbers, abs=1e-12)
        finally:
            process.terminate()
            await process.wait()
