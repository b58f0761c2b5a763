"""Topics, as the documentation of roslibpy uses them."""

from __future__ import annotations

import math
from typing import Any

from roslibpy import Message, Topic

from .world import Collected, World

NUMBER = "std_msgs/Int32"


def message_reaches_another_client(world: World) -> Any:
    talker, listener = world.connect(), world.connect()
    received = Collected()
    Topic(listener, "/chatter", "std_msgs/String").subscribe(received.put)
    world.settled(listener)
    topic = Topic(talker, "/chatter", "std_msgs/String")
    topic.publish(Message({"data": "hello"}))
    topic.publish(Message({"data": "wörld 🌍"}))
    return received.many(2)


def client_receives_its_own_messages(world: World) -> Any:
    ros, received = world.connect(), Collected()
    Topic(ros, "/monologue", NUMBER).subscribe(received.put)
    Topic(ros, "/monologue", NUMBER).publish(Message({"data": 8}))
    return received.many(1)


def message_of_many_fields_arrives_as_it_was_sent(world: World) -> Any:
    ros, received = world.connect(), Collected()
    Topic(ros, "/imu", "sensor_msgs/Imu").subscribe(received.put)
    message = {
        "header": {"seq": 0, "stamp": {"secs": 12, "nsecs": 34}, "frame_id": "base_link"},
        "orientation": {"x": 0, "y": 0, "z": 0, "w": 1},
        "orientation_covariance": [1.5, 0, 0, 0, math.nan, 0, 0, 0, -2],
        "linear_acceleration": {"z": -9.81},
    }
    Topic(ros, "/imu", "sensor_msgs/Imu").publish(Message(message))
    return received.many(1)[0]


def late_subscriber_receives_the_latched_message_once(world: World) -> Any:
    talker, listener = world.connect(), world.connect()
    topic = Topic(talker, "/map_name", "std_msgs/String", latch=True)
    topic.publish(Message({"data": "attic"}))
    topic.publish(Message({"data": "cellar"}))
    world.settled(talker)
    received = Collected()
    Topic(listener, "/map_name", "std_msgs/String").subscribe(received.put)
    world.settled(listener)
    return received.many(received.qsize())


def throttled_subscriber_receives_the_first_message_and_then_the_newest(world: World) -> Any:
    _, received = _throttled(world, "/newest", queue_length=1)
    return received.many(2)


def queue_of_a_throttled_subscriber_is_sent_after_the_first_message(world: World) -> Any:
    _, received = _throttled(world, "/drained", queue_length=3)
    return received.many(4)


def throttled_subscriber_without_a_queue_misses_early_messages(world: World) -> Any:
    talker, received = _throttled(world, "/missed", queue_length=0)
    while received.qsize() < 2:
        talker.publish(Message({"data": 10}))
        world.settled(talker.ros)
    return received.many(2)


def _throttled(
    world: World, name: str, queue_length: int, rate: int = 300
) -> tuple[Topic, Collected]:
    """Publish ten messages to a throttled subscriber; return the publisher, and what it receives.

    All ten must reach the hub before it may send a second one. If one has come by then, they were
    too slow for that, and are sent again at a lower rate.
    """
    ros, received = world.connect(), Collected()
    topic = f"{name}/{rate}"
    listener = Topic(ros, topic, NUMBER, throttle_rate=rate, queue_length=queue_length)
    listener.subscribe(lambda message: received.put(message["data"]))
    talker = Topic(ros, topic, NUMBER)
    for number in range(10):
        talker.publish(Message({"data": number}))
    world.settled(ros)
    if received.qsize() > 1 and rate < 10_000:
        return _throttled(world, name, queue_length, 2 * rate)
    return talker, received


def two_subscribers_of_one_client_receive_each_message_once(world: World) -> Any:
    ros, received = world.connect(), [Collected(), Collected()]
    for each in received:
        Topic(ros, "/shared", NUMBER).subscribe(
            lambda message, each=each: each.put(message["data"])
        )
    talker = Topic(ros, "/shared", NUMBER)
    for number in (1, 2):
        talker.publish(Message({"data": number}))
    world.settled(ros)
    return [each.many(each.qsize()) for each in received]


def topic_may_be_spelled_without_its_slash_and_its_type_as_in_ROS_2(world: World) -> Any:
    talker, listener = world.connect(), world.connect()
    received = Collected()
    Topic(listener, "spelled/chatter", "std_msgs/msg/String").subscribe(received.put)
    world.settled(listener)
    Topic(talker, "/spelled/chatter", "std_msgs/String").publish(Message({"data": "hello"}))
    return received.many(1)


def message_of_megabytes_arrives(world: World) -> Any:
    ros, received = world.connect(), Collected()
    sent = "0123456789" * 300_000
    Topic(ros, "/essay", "std_msgs/String").subscribe(received.put)
    Topic(ros, "/essay", "std_msgs/String").publish(Message({"data": sent}))
    return received.many(1)[0]["data"] == sent


def no_message_arrives_after_unsubscribing(world: World) -> Any:
    ros, received = world.connect(), Collected()
    talker, listener = Topic(ros, "/number", NUMBER), Topic(ros, "/number", NUMBER)
    listener.subscribe(received.put)
    talker.publish(Message({"data": 1}))
    first = received.many(1)
    listener.unsubscribe()
    talker.publish(Message({"data": 2}))
    world.settled(ros)
    listener.subscribe(received.put)
    talker.publish(Message({"data": 3}))
    return first + received.many(1)


def topic_disappears_with_its_last_publisher(world: World) -> Any:
    ros = world.connect()
    topic = Topic(ros, "/gone", NUMBER)
    topic.advertise()
    before = "/gone" in ros.get_topics()
    topic.unadvertise()
    world.settled(ros)
    return {"before": before, "after": "/gone" in ros.get_topics()}
