"""A peer of the matrix with the node library: fibws_peer.py NAME PEERS MESSAGES."""

from __future__ import annotations

import asyncio
import json
import sys
from pathlib import Path
from typing import Any

import fibws
from fibws.action.actionlib import Test
from fibws.interfaces.serialization import Serializers
from fibws.msg import default_interfaces
from fibws.msg.sensor_msgs import CompressedImage
from fibws.msg.std_msgs import Float64MultiArray, Int64MultiArray
from fibws.srv.std_srvs import SetBool, SetBoolRequest, SetBoolResponse

TYPES: dict[str, Any] = {
    "ints": Int64MultiArray,
    "floats": Float64MultiArray,
    "image": CompressedImage,
}
SERIALIZERS = {
    kind: Serializers(default_interfaces()).of(type_._type) for kind, type_ in TYPES.items()
}
NAME, PEERS, PATH = sys.argv[1:4]
FINISH = asyncio.Event()
"""Set when a line of standard input lets the server finish its goal."""
MESSAGES = json.loads(Path(PATH).read_text())


def saw(what: str, peer: str, value: object) -> None:
    print(json.dumps({"saw": what, "of": peer, "value": value}), flush=True)


def message(kind: str) -> Any:
    return TYPES[kind].from_dict(
        SERIALIZERS[kind].deserialize(bytes.fromhex(MESSAGES[kind]["bytes"]))
    )


async def hear(node: fibws.Node, what: str, peer: str, kind: str) -> None:
    heard = await anext(node.subscribe(f"/{peer}/{what}/{kind}", TYPES[kind]))
    saw(f"{what} {kind}", peer, SERIALIZERS[kind].serialize(heard.to_dict()).hex())


async def answer(request: SetBoolRequest) -> SetBoolResponse:
    if not request.data:
        raise ValueError(f"refused by {NAME}")
    return SetBoolResponse(True, f"from {NAME}, ä")


async def execute(goal: Any) -> dict[str, int]:
    FINISH.clear()
    await goal.publish_feedback({"feedback": goal.request.goal})
    await FINISH.wait()  # Feedback and result come on two connections, in any order.
    return {"result": 2 * goal.request.goal}


async def call(node: fibws.Node, peer: str) -> None:
    service = f"/{peer}/set_bool"
    await node.wait_for_service(service)
    response = await node.call(service, SetBool, {"data": True})
    saw("service", peer, [response.success, response.message])
    try:
        await node.call(service, SetBool, {"data": False})
    except fibws.ServiceError:
        saw("refusal", peer, None)


async def act(node: fibws.Node, peer: str) -> None:
    client = node.action_client(f"/{peer}/act", Test)
    await client.wait_for_server()
    goal = await client.send({"goal": 21})
    feedback = []
    async for each in goal.feedback():
        feedback.append(each.feedback)
        saw("feedback", peer, each.feedback)
    saw("action", peer, [feedback, (await goal.result()).result])


async def follow(node: fibws.Node, tasks: asyncio.TaskGroup) -> None:
    while line := (await asyncio.to_thread(sys.stdin.readline)).strip():
        if line == "finish":
            FINISH.set()
        else:
            tasks.create_task(act(node, line))


async def read(node: fibws.Node, peer: str) -> None:
    saw("parameters", peer, await node.params.get(f"/parameters/{peer}"))


async def main() -> None:
    async with fibws.Node(NAME) as node, asyncio.TaskGroup() as tasks:
        publishers = {}
        for kind, type_ in TYPES.items():
            latched = await node.advertise(f"/{NAME}/latched/{kind}", type_, latch=True)
            await latched.publish(message(kind))
            publishers[kind] = await node.advertise(f"/{NAME}/plain/{kind}", type_)
        await node.params.set(f"/parameters/{NAME}", MESSAGES["parameters"])
        await node.service(f"/{NAME}/set_bool", SetBool, answer)
        await node.action_server(f"/{NAME}/act", Test, execute)
        print("ready", flush=True)
        await asyncio.to_thread(sys.stdin.readline)
        for peer in PEERS.split(","):
            for kind in TYPES:
                tasks.create_task(hear(node, "latched", peer, kind))
                tasks.create_task(hear(node, "plain", peer, kind))
            tasks.create_task(read(node, peer))
        for peer in MESSAGES["serving"]:
            tasks.create_task(call(node, peer))
        tasks.create_task(follow(node, tasks))
        async for _ in node.rate(10):
            for kind, publisher in publishers.items():
                await publisher.publish(message(kind))


asyncio.run(main())
