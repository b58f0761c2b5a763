"""Commands and programs of an installed ROS 1 work with the hub's master, on nodes of all kinds."""

from __future__ import annotations

import asyncio
import re
import signal
from collections.abc import AsyncIterator

import pytest
from patience import PATIENCE
from ports import port as port

import fibws
from fibws.bags import open_reader, reindex
from fibws.msg import std_msgs
from fibws.srv.std_srvs import SetBool

from .world import World, until

pytestmark = pytest.mark.real_ros

URDF = """\
<robot name="arm">
  <link name="base_link"/>
  <link name="upper_arm"/>
  <link name="gripper"/>
  <joint name="shoulder" type="revolute">
    <parent link="base_link"/><child link="upper_arm"/><origin xyz="1 2 3"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="wrist" type="fixed">
    <parent link="upper_arm"/><child link="gripper"/><origin xyz="0 0 0.5"/>
  </joint>
</robot>
"""
LAUNCH = """\
<launch>
  <param name="limit" value="3.5"/>
  <node name="mount" pkg="tf2_ros" type="static_transform_publisher" args="1 2 3 0 0 0 1 map odom"/>
</launch>
"""
OUR_LAUNCH = """\
<launch>
  <node name="relay" pkg="topic_tools" type="relay" args="/chatter /again"/>
</launch>
"""


@pytest.fixture
async def client(ros: World) -> AsyncIterator[fibws.Node]:
    """A node of the hub, which publishes /chatter and provides /switch."""
    async with fibws.Node("client", hub=ros.url) as node:
        publisher = await node.advertise("/chatter", std_msgs.String, latch=True)
        await publisher.publish(std_msgs.String("hello"))

        async def switch(request: SetBool.Request) -> SetBool.Response:
            return SetBool.Response(success=request.data, message="done")

        await node.service("/switch", SetBool, switch)
        yield node


async def test_rosnode(ros: World, client: fibws.Node) -> None:
    relay = await ros.program("/usr/lib/topic_tools/relay", "/chatter", "/again", "__name:=relay")
    await client.wait_for_message("/again", std_msgs.String, timeout=60)
    listed = await ros.output("rosnode", "list")
    assert {"/client", "/relay"} <= set(listed.split())
    info = await ros.output("rosnode", "info", "/client")
    assert "* /chatter [std_msgs/String]" in info
    assert "* /switch" in info
    assert re.search(r"topic: /chatter\n +\* to: /relay\n +\* direction: outbound", info)
    for name in ("/client", "/relay"):
        assert "xmlrpc reply from" in await ros.output("rosnode", "ping", "-c", "1", name)
    # One that is killed stays until it is cleaned up.
    relay.kill()
    await relay.ended()
    assert "/relay" in (await ros.output("rosnode", "list")).split()
    await ros.output("rosnode", "cleanup", given="y\n")
    assert "/relay" not in (await ros.output("rosnode", "list")).split()
    assert "/client" in (await ros.output("rosnode", "list")).split()
    await ros.output("rosnode", "kill", "/client")
    with pytest.raises(fibws.NodeError):
        await client.spin()


async def test_rostopic(ros: World, client: fibws.Node) -> None:
    assert "/chatter" in (await ros.output("rostopic", "list")).split()
    info = await ros.output("rostopic", "info", "/chatter")
    assert "Type: std_msgs/String" in info
    assert "* /client (http://" in info
    assert 'data: "hello"' in await ros.output("rostopic", "echo", "-n", "1", "/chatter")
    numbers = client.subscribe("/numbers", std_msgs.Int32)
    talker = await ros.program(
        "/usr/bin/rostopic", "pub", "-r", "50", "/numbers", "std_msgs/Int32", "7"
    )
    assert (await anext(numbers)).data == 7
    hz = await ros.program("/usr/bin/rostopic", "hz", "/numbers")
    bw = await ros.program("/usr/bin/rostopic", "bw", "/numbers")
    rate = await hz.found(r"average rate: ([\d.]+)")
    assert 25 < float(rate[1]) < 100
    await bw.found(r"average: [\d.]+.?B/s")
    for each in (hz, bw, talker):
        each.process.send_signal(signal.SIGINT)
        await each.ended()


async def test_rosservice(ros: World, client: fibws.Node) -> None:
    assert "/switch" in (await ros.output("rosservice", "list")).split()
    assert await ros.output("rosservice", "type", "/switch") == "std_srvs/SetBool\n"
    called = await ros.output("rosservice", "call", "/switch", "true")
    assert called.split() == ["success:", "True", "message:", '"done"']


async def test_rosparam(ros: World, client: fibws.Node) -> None:
    robot, dumped = ros.folder / "robot.yaml", ros.folder / "all.yaml"
    robot.write_text("{joints: [a, b], gain: 1.5, name: ten}\n")
    await client.params.set("/large", 2**40)  # More than XML-RPC's integers hold.
    await ros.output("rosparam", "load", str(robot), "/arm")
    found = await client.params.get("/arm")
    assert found == {"joints": ["a", "b"], "gain": 1.5, "name": "ten"}
    await client.params.set("/arm/joints", ["c"])
    assert (await ros.output("rosparam", "get", "/arm/joints")).split() == ["-", "c"]
    await ros.output("rosparam", "set", "/arm/gain", "2.5")
    assert await client.params.get("/arm/gain") == 2.5
    await ros.output("rosparam", "dump", str(dumped))
    assert "gain: 2.5" in dumped.read_text()


async def test_roslaunch(ros: World, client: fibws.Node) -> None:
    file = ros.folder / "mount.launch"
    file.write_text(LAUNCH)
    launched = await ros.program("/usr/bin/roslaunch", str(file))
    message = await client.wait_for_message("/tf_static", "tf2_msgs/TFMessage", timeout=PATIENCE)
    assert message.transforms[0].child_frame_id == "odom"
    assert await client.params.get("/limit") == 3.5
    assert "/mount" in (await ros.output("rosnode", "list")).split()
    launched.process.send_signal(signal.SIGINT)
    assert await launched.ended() == 0
    assert "/mount" not in (await ros.output("rosnode", "list")).split()


async def test_rosrun(ros: World, client: fibws.Node) -> None:
    words = "tf2_ros static_transform_publisher 1 2 3 0 0 0 1 map odom __name:=mount".split()
    await ros.program("/usr/bin/rosrun", *words)
    message = await client.wait_for_message("/tf_static", "tf2_msgs/TFMessage", timeout=PATIENCE)
    assert message.transforms[0].child_frame_id == "odom"
    assert "xmlrpc reply from" in await ros.output("rosnode", "ping", "-c", "1", "/mount")


@pytest.mark.parametrize("command", ["run", "launch"])
async def test_fibws_starts_installed_programs(
    ros: World, client: fibws.Node, command: str
) -> None:
    if command == "run":
        words = ["run", "topic_tools", "relay", "/chatter", "/again"]
    else:
        (ros.folder / "relay.launch").write_text(OUR_LAUNCH)
        words = ["launch", str(ros.folder / "relay.launch")]
    program = await ros.our(command, "-m", "fibws", *words)
    message = await client.wait_for_message("/again", std_msgs.String, timeout=60)
    assert message.data == "hello"
    program.process.send_signal(signal.SIGINT)
    await program.ended()


async def test_launch_starts_a_master_for_installed_programs(ros: World, port: int) -> None:
    file = ros.folder / "relay.launch"
    file.write_text(OUR_LAUNCH)
    words = ["-m", "fibws", "launch", "-p", "0", str(file)]
    program = await ros.our("launch", *words, ROS_MASTER_URI=f"http://127.0.0.1:{port}")
    page = await program.found(r"FIBWS_HUB=(ws:\S+\d)")
    async with fibws.Node("client", hub=page[1]) as node:
        publisher = await node.advertise("/chatter", std_msgs.String, latch=True)
        await publisher.publish(std_msgs.String("hello"))
        assert (
            await node.wait_for_message("/again", std_msgs.String, timeout=PATIENCE)
        ).data == "hello"
    program.process.send_signal(signal.SIGINT)
    await program.ended()


async def test_rosbag(ros: World, client: fibws.Node) -> None:
    bag = ros.folder / "one.bag"
    await ros.output("rosbag", "record", "-O", str(bag), "-l", "1", "/chatter")
    info = await ros.output("rosbag", "info", str(bag))
    assert re.search(r"/chatter +1 msg +: std_msgs/String", info)
    heard = client.subscribe("/played", std_msgs.String)
    await client.flush()
    played = await ros.program(
        "/usr/bin/rosbag", "play", "--wait-for-subscribers", str(bag), "/chatter:=/played"
    )
    assert (await anext(heard)).data == "hello"
    await played.ended()


@pytest.mark.parametrize("options", [(), ("--bz2",), ("--lz4",)])
async def test_bag_of_a_killed_recorder_is_restored(
    ros: World, client: fibws.Node, options: tuple[str, ...]
) -> None:
    active, restored = ros.folder / "it.bag.active", ros.folder / "restored.bag"
    recorder = await ros.program(
        *("/usr/lib/rosbag/record", "-O", str(ros.folder / "it.bag"), "--chunksize", "4"),
        *(*options, "/numbers"),
    )
    publisher = await client.advertise("/numbers", std_msgs.Int32)
    number = 0

    async def has_chunks() -> bool:
        nonlocal number
        for _ in range(100):
            await publisher.publish(std_msgs.Int32(number))
            number += 1
        return active.exists() and active.stat().st_size > 20_000

    await until(has_chunks)
    recorder.kill()
    await recorder.ended()
    found = reindex(active, restored)
    with open_reader(restored) as bag:
        [connection] = bag.connections
        assert (connection.topic, connection.type) == ("/numbers", "std_msgs/Int32")
        numbers = [int.from_bytes(data, "little") for _, _, data in bag.messages()]
    # In order, and each once; a recorder that was too slow has missed some.
    assert numbers == sorted(set(numbers)) and len(numbers) == found.messages > 200
    assert f"{found.messages} msgs" in await ros.output("rosbag", "info", str(restored))


async def test_transforms_of_robot_state_publisher_and_tf2(ros: World, client: fibws.Node) -> None:
    await client.params.set("/robot_description", URDF)
    static = client.subscribe("/tf_static", "tf2_msgs/TFMessage")
    moving = client.subscribe("/tf", "tf2_msgs/TFMessage")
    joints = await client.advertise("/joint_states", "sensor_msgs/JointState", latch=True)
    header = std_msgs.Header(stamp=client.now())
    await joints.publish(header=header, name=["shoulder"], position=[0.5])
    await ros.program("/usr/lib/robot_state_publisher/robot_state_publisher")
    await ros.program(
        "/usr/lib/tf2_ros/static_transform_publisher", *"1 2 3 0 0 0 1 map odom".split()
    )
    frames: dict[str, str] = {}
    async with asyncio.timeout(60):
        async for message in static:
            for each in message.transforms:
                frames[each.child_frame_id] = each.header.frame_id
            if len(frames) == 2:
                break
        (transform,) = (await anext(moving)).transforms
    assert frames == {"gripper": "upper_arm", "odom": "map"}
    assert transform.child_frame_id == "upper_arm"
    position = transform.transform.translation
    assert (position.x, position.y, position.z) == (1, 2, 3)
