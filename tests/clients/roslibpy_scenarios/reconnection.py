"""A hub that goes away and another one in its place: roslibpy comes back by itself."""

from __future__ import annotations

from typing import Any

from patience import PATIENCE
from roslibpy import Message, Service, ServiceRequest, Topic

from .world import Collected, World, eventually


def client_reconnects_when_the_hub_returns(world: World) -> Any:
    talker, listener = world.connect(), world.connect()
    received = Collected()
    Topic(listener, "/chatter", "std_msgs/String").subscribe(received.put)
    world.settled(listener)
    topic = Topic(talker, "/chatter", "std_msgs/String")
    topic.publish(Message({"data": "before"}))
    before = received.many(1)
    lost, back = Collected(), Collected()
    for ros in (talker, listener):
        ros.on("close", lost.put)
        ros.on("ready", back.put)
    world.report({"restart": True})
    lost.many(2)
    back.many(2)
    # It advertises and subscribes again a while after it is back, and meanwhile publishes all the
    # same, which a real rosbridge does not answer.
    topic.publish(Message({"data": "early"}))
    eventually(lambda: _nodes(talker, "publishers") and _nodes(listener, "subscribers"))
    topic.publish(Message({"data": "after"}))
    while (after := received.many(1)) == [{"data": "early"}]:
        pass
    return before + after


def _nodes(ros: Any, role: str) -> bool:
    service = Service(ros, f"/rosapi/{role}", f"rosapi/{role.capitalize()}")
    return bool(service.call(ServiceRequest({"topic": "/chatter"}), timeout=PATIENCE)[role])
