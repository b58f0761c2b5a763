"""Scripts with tf at a hub, and nodes of fibws that share their tree."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
import rospy
from patience import PATIENCE

import fibws
from fibws.msg.tf2_msgs import TFMessage
from fibws.tf import Buffer, TransformListener
from fibws.tf.errors import TransformError
from fibws.tf.history import Sample
from fibws.tf.messages import write
from fibws.tf.transform import Transform
from ros1.rospy.programs import Programs, running_hub
from ros1.side_by_side import Part, our_ros

PYTHON = Path(rospy.__file__).parents[1]


@pytest.fixture
async def programs() -> AsyncIterator[Programs]:
    async with running_hub() as programs:
        yield programs


async def lookup(buffer: Buffer, target: str, source: str) -> Sample:
    async with asyncio.timeout(PATIENCE):
        while True:
            try:
                return buffer.lookup(target, source)
            except TransformError:
                await asyncio.sleep(0.01)


async def test_node_sees_the_frames_of_scripts(programs: Programs) -> None:
    script = await programs.start(
        """
        import rospy, tf, tf2_ros
        from geometry_msgs.msg import TransformStamped
        rospy.init_node("script")
        broadcaster = tf.TransformBroadcaster()
        for frame, x in (("camera", 1), ("laser", 2)):
            static = tf2_ros.StaticTransformBroadcaster()
            mounted = TransformStamped(child_frame_id=frame)
            mounted.header.frame_id = "base"
            mounted.transform.translation.x = x
            mounted.transform.rotation.w = 1
            static.sendTransform(mounted)
        rate = rospy.Rate(100)
        while not rospy.is_shutdown():
            broadcaster.sendTransform((5, 0, 0), (0, 0, 0, 1), rospy.Time.now(), "base", "map")
            rate.sleep()
        """
    )
    buffer = Buffer()
    async with fibws.Node("node", hub=programs.hub.url) as node:
        listening = asyncio.create_task(TransformListener(node, buffer, authorities=True).run())
        assert (await lookup(buffer, "map", "camera")).transform.translation == (6, 0, 0)
        assert (await lookup(buffer, "map", "laser")).transform.translation == (7, 0, 0)
        assert {info.authority for info in buffer.infos()} == {"/script"}
        listening.cancel()
    script.interrupt()


async def test_script_sees_the_frames_of_nodes(programs: Programs) -> None:
    async with fibws.Node("node", hub=programs.hub.url) as node:
        static = await node.advertise("/tf_static", TFMessage, latch=True)
        moving = await node.advertise("/tf", TFMessage)
        await static.publish(TFMessage([write("camera", Sample(0, "base", Transform((1, 0, 0))))]))
        script = await programs.start(
            """
            import rospy, tf
            rospy.init_node("script")
            listener = tf.TransformListener()
            listener.waitForTransform("/base", "/camera", rospy.Time(), rospy.Duration(60))
            print(listener.lookupTransform("base", "camera", rospy.Time(7)))
            listener.waitForTransform("map", "camera", rospy.Time(9), rospy.Duration(60))
            print(listener.lookupTransform("map", "camera", rospy.Time(9)))
            print(listener.frameExists("map"), listener.getFrameStrings())
            """
        )
        assert await script.read_line() == "([1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])"
        for at in (8, 10):
            sample = Sample(at * 1_000_000_000, "map", Transform((float(at), 0, 0)))
            await moving.publish(TFMessage([write("base", sample)]))
        assert await script.finish() == [
            "([10.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])",
            "True ['camera', 'base', 'map']",
        ]


async def test_topic_of_the_first_tf_is_the_same(programs: Programs) -> None:
    """tf/tfMessage and tf2_msgs/TFMessage have one definition and share topics, as in ROS."""
    script = await programs.start(
        """
        import rospy, tf2_ros
        from geometry_msgs.msg import TransformStamped
        from tf.msg import tfMessage
        rospy.init_node("script")
        buffer = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(buffer)
        publisher = rospy.Publisher("/tf", tfMessage, queue_size=10, latch=True)
        message = TransformStamped(child_frame_id="base")
        message.header.frame_id = "map"
        message.transform.rotation.w = 1
        publisher.publish(tfMessage([message]))
        print(buffer.can_transform("map", "base", rospy.Time(), rospy.Duration(60)))
        """
    )
    assert await script.finish() == ["1"]


async def test_waiting_ends_in_time_and_with_the_node(programs: Programs) -> None:
    script = await programs.start(
        """
        import rospy, tf2_ros, threading
        rospy.init_node("script")
        buffer = tf2_ros.Buffer()
        start = rospy.get_time()
        print(buffer.can_transform("map", "base", rospy.Time(), rospy.Duration(0.2)))
        print(0.2 <= rospy.get_time() - start)
        threading.Timer(0.1, rospy.signal_shutdown, ["done"]).start()
        try:
            buffer.lookup_transform("map", "base", rospy.Time(), rospy.Duration(600))
        except tf2_ros.LookupException:
            print(rospy.is_shutdown())
        rospy.rostime.set_rostime(rospy.Time(1))
        try:
            buffer.lookup_transform("map", "base", rospy.Time(), rospy.Duration(600))
        except rospy.ROSInterruptException as error:
            print(error)
        """
    )
    assert await script.finish() == ["0", "True", "True", "ROS shutdown request"]


async def test_time_that_goes_back_clears_the_buffer(programs: Programs) -> None:
    script = await programs.start(
        """
        import rospy, tf2_ros
        from geometry_msgs.msg import TransformStamped
        rospy.init_node("script")
        rospy.rostime.set_rostime(rospy.Time(100))
        buffer = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(buffer)
        message = TransformStamped(child_frame_id="base")
        message.header.frame_id = "map"
        message.transform.rotation.w = 1
        broadcaster = tf2_ros.TransformBroadcaster()
        while not buffer.can_transform("map", "base", rospy.Time()):
            broadcaster.sendTransform(message)
            rospy.rostime.wallsleep(0.02)
        rospy.rostime.set_rostime(rospy.Time(50))
        while listener.last_update != rospy.Time(50):
            broadcaster.sendTransform([])
            rospy.rostime.wallsleep(0.02)
        listener.unregister()
        """
    )
    await script.finish()
    assert "Detected jump back in time of 50.000000s. Clearing TF buffer." in script.errors


@pytest.mark.long
async def test_observer_of_a_robot() -> None:
    async with our_ros() as ros:
        _, said = await ros.play(
            Part("tf/robot.py", until="ready"), Part("tf/observer.py", interrupted=False)
        )
    assert "camera 0 0.100 0.000 1.500 0.000 0.000 0.707 0.707" in said.out
    assert "wrench 0.000 1.000 0.000 0.000 0.000 2.000" in said.out
    assert said.out[-1] == "static 1"
    assert (said.err, said.code) == ([], 0)


async def test_lookups_of_a_server() -> None:
    async with our_ros() as ros:
        *_, said = await ros.play(
            Part("tf/robot.py", until="ready"),
            Part("tf/lookup_server.py", until="ready"),
            Part("tf/lookup_client.py", interrupted=False),
        )
    assert said.out[-1] == "point 0.100 1.000 1.500"
    assert (said.err, said.code) == ([], 0)


async def test_all_that_a_buffer_is_asked() -> None:
    async with our_ros() as ros:
        (said,) = await ros.play(Part("tf/buffer.py", errors=False, interrupted=False))
    assert (len(said.out), said.code) == (2627, 0)


@pytest.mark.parametrize("module", ["rospy", "tf", "tf2_ros", "tf2_geometry_msgs"])
def test_modules_load_what_they_need(module: str) -> None:
    """Only a program that uses tf loads it, and none of them numpy, asyncio or actionlib."""
    code = (
        f"from fibws.ros1 import finder; finder.install(); import {module}, sys\n"
        "print(sorted({'numpy', 'asyncio', 'actionlib', 'tf2_ros', 'fibws.tf.buffer'}"
        " & {*sys.modules}))"
    )
    found = subprocess.run(
        [sys.executable, "-c", code],
        env={"PYTHONPATH": f"{PYTHON}:{PYTHON.parents[2]}"},
        capture_output=True,
        text=True,
        check=True,
    )
    expected = [] if module == "rospy" else ["fibws.tf.buffer", "tf2_ros"]
    assert found.stdout == f"{expected}\n"
