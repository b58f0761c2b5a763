"""rospy on a rosbridge_suite server, which has no peers, no headers and no graph."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any, cast

import pytest
from rospy import core
from rospy.background import Background
from websockets.asyncio.server import ServerConnection, serve

from fibws.hub.server import HubServer
from ros1.rospy.programs import Programs

RESPONSES: dict[str, dict[str, Any]] = {
    "/rosapi/get_param": {"value": "null"},
    "/rosapi/subscribers": {"subscribers": ["/rosbridge_websocket"]},
    "/rosapi/publishers": {"publishers": ["/talker", "/other"]},
    "/rosapi/topic_type": {"type": "std_msgs/String"},
    "/rosapi/topics": {"topics": ["/chatter"], "types": ["std_msgs/String"]},
}


async def rosbridge(client: ServerConnection) -> None:
    async for text in client:
        asked = json.loads(text)
        if asked["op"] == "publish" and asked["topic"] == "/relayed":
            publish = {"op": "publish", "topic": "/responses", "msg": asked["msg"]}
            await client.send(json.dumps(publish))
        if asked["op"] == "call_service":
            answer = RESPONSES.get(asked["service"], "Service does not exist")
            fields = {"values": answer, "result": isinstance(answer, dict)}
            reply = {"op": "service_response", "service": asked["service"], "id": asked["id"]}
            await client.send(json.dumps({**reply, **fields}))
        elif asked["op"] == "subscribe" and asked["topic"] == "/chatter":
            publish = {"op": "publish", "topic": "/chatter", "msg": {"data": "hello"}}
            await client.send(json.dumps(publish))


async def test_script_runs_on_rosbridge_suite() -> None:
    async with serve(rosbridge, "127.0.0.1", 0) as server:
        port = server.sockets[0].getsockname()[1]
        running_hub = Programs(cast(HubServer, SimpleNamespace(url=f"ws://127.0.0.1:{port}")))
        program = await running_hub.start(
            """
            import rospy, threading
            from std_msgs.msg import String
            rospy.init_node("script")
            message = rospy.wait_for_message("chatter", String)
            print(message.data, sorted(message._connection_header))
            publisher = rospy.Publisher("chatter", String, queue_size=1)
            subscriber = rospy.Subscriber("chatter", String)
            print(publisher.get_num_connections(), subscriber.get_num_connections())
            print(rospy.get_published_topics())
            raw = rospy.wait_for_message("chatter", rospy.AnyMsg)
            print(raw._buff, raw._connection_header["type"])
            responded = threading.Event()

            def respond(message):
                print(message.data)
                responded.set()

            rospy.Subscriber("responses", String, respond)
            rospy.Publisher("relayed", rospy.AnyMsg, queue_size=1).publish(raw)
            responded.wait(60)
            """
        )
        try:
            assert await program.finish() == [
                "hello ['md5sum', 'message_definition', 'topic', 'type']",
                "1 2",
                "[['/chatter', 'std_msgs/String']]",
                r"b'\x05\x00\x00\x00hello' std_msgs/String",
                "hello",
            ]
        finally:
            await running_hub.kill()


def test_default_is_returned_when_the_hub_does_not_respond(monkeypatch: pytest.MonkeyPatch) -> None:
    async def question() -> list[str]:
        return ["/talker"]

    monkeypatch.setattr(core, "background", Background())
    assert core.ask(question(), []) == []
