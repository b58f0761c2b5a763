"""rospy on a rosbridge that is no hub of fibws: it tells no peers, no headers and no graph."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any, cast

import pytest
from rospy import core, foreign
from rospy.background import Background
from websockets.asyncio.server import ServerConnection, serve

from fibws.hub import Hub
from ros1.rospy.programs import World

ANSWERS: dict[str, dict[str, Any]] = {
    "/rosapi/get_param": {"value": "null"},
    "/rosapi/subscribers": {"subscribers": ["/rosbridge_websocket"]},
    "/rosapi/publishers": {"publishers": ["/talker", "/other"]},
    "/rosapi/topics": {"topics": ["/chatter"], "types": ["std_msgs/String"]},
}


async def rosbridge(client: ServerConnection) -> None:
    async for text in client:
        asked = json.loads(text)
        if asked["op"] == "call_service":
            answer = ANSWERS.get(asked["service"], "there is no such service")
            fields = {"values": answer, "result": isinstance(answer, dict)}
            reply = {"op": "service_response", "service": asked["service"], "id": asked["id"]}
            await client.send(json.dumps({**reply, **fields}))
        elif asked["op"] == "subscribe" and asked["topic"] == "/chatter":
            publish = {"op": "publish", "topic": "/chatter", "msg": {"data": "hello"}}
            await client.send(json.dumps(publish))


async def test_a_script_runs_on_a_rosbridge() -> None:
    async with serve(rosbridge, "127.0.0.1", 0) as server:
        port = server.sockets[0].getsockname()[1]
        world = World(cast(Hub, SimpleNamespace(url=f"ws://127.0.0.1:{port}")))
        program = await world.start(
            """
            import rospy
            from std_msgs.msg import String
            rospy.init_node("script")
            message = rospy.wait_for_message("chatter", String)
            print(message.data, sorted(message._connection_header))
            publisher = rospy.Publisher("chatter", String, queue_size=1)
            subscriber = rospy.Subscriber("chatter", String)
            print(publisher.get_num_connections(), subscriber.get_num_connections())
            print(rospy.get_published_topics())
            """
        )
        try:
            assert await program.ends() == [
                "hello ['md5sum', 'message_definition', 'topic', 'type']",
                "1 2",
                "[['/chatter', 'std_msgs/String']]",
            ]
        finally:
            await world.end()


def test_a_rosbridge_that_does_not_answer_names_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    async def question() -> list[str]:
        return ["/talker"]

    monkeypatch.setattr(core, "background", Background())
    assert foreign.count_nodes(question()) == 0
