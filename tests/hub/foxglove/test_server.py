"""Foxglove's protocol on a real hub's port, beside rosbridge."""

from __future__ import annotations

import asyncio
import json
import os
import struct
import sys
import threading
from contextlib import suppress
from pathlib import Path

import pytest
from conftest import StartHub
from hub_reload import reloaded
from websockets.exceptions import ConnectionClosed

from fibws.bags import open_writer
from fibws.hub.foxglove import SUBPROTOCOLS
from fibws.hub.worker_threads import MOST_THREADS

from ..fakes import STANDARD
from ..raw_client import BINARY, PING, connected, frame, nodes, until
from ..token_clients import entry
from .real_client import foxglove

pytestmark = pytest.mark.both_loops

INT32 = "std_msgs/Int32"
LARGE = 6_220_800
"""Bytes of an image of 1920 by 1080 pixels."""


@pytest.mark.parametrize("subprotocol", SUBPROTOCOLS)
async def test_both_subprotocols_are_accepted(start_hub: StartHub, subprotocol: str) -> None:
    hub = await start_hub()
    async with foxglove(hub, "", subprotocol) as client:
        assert client.websocket.subprotocol == subprotocol
        info = await client.find("serverInfo")
        assert info["name"].startswith("fibws")
        [name] = nodes(hub)
        [(connection, _)] = hub._own.clients
        assert connection.protocol == subprotocol
        assert connection.name == name
    await until(lambda: not nodes(hub))


async def test_client_of_foxglove_and_a_page_exchange_messages(start_hub: StartHub) -> None:
    hub = await start_hub()
    async with foxglove(hub) as client, connected(hub.port, "/?node=/page") as page:
        await page.subscribes("/from_studio")
        await page.advertises("/from_page")
        await page.send_operation("advertise_service", service="/add", type="std_srvs/SetBool")
        await client.subscribe("/from_page", 5)
        channel = {"id": 1, "topic": "/from_studio", "encoding": "ros1", "schemaName": INT32}
        await client.send("advertise", channels=[channel])
        await client.is_processed()
        await page.send_operation("publish", topic="/from_page", msg={"data": 7})
        message = await client.find_binary(1)
        assert (message[1:5], message[13:]) == (struct.pack("<I", 5), struct.pack("<i", 7))
        await client.websocket.send(struct.pack("<BIi", 1, 1, 9))
        assert (await page.receive())["msg"] == {"data": 9}
        service = await client.service("/add")
        request = struct.pack("<BIII", 2, service, 3, 4) + b"ros1\1"
        await client.websocket.send(request)
        call = await page.receive()
        assert call["args"] == {"data": True}
        values = {"success": True, "message": "on"}
        await page.send_operation(
            "service_response", service="/add", id=call["id"], result=True, values=values
        )
        response = await client.find_binary(3)
        assert response[5:9] == struct.pack("<I", 3)
        assert response[13:] == b"ros1\1\2\0\0\0on"


async def test_steps_of_the_application(start_hub: StartHub) -> None:
    """Lichtblick's player does these at once after each serverInfo."""
    hub = await start_hub()
    async with connected(hub.port) as page, foxglove(hub) as client:
        await page.advertises("/fib")
        info = await client.find("serverInfo")
        assert "connectionGraph" in info["capabilities"]
        await client.send("getParameters", parameterNames=[], id="get-all-params")
        await client.send("subscribeConnectionGraph")
        values = await client.find("parameterValues")
        assert values["id"] == "get-all-params"
        names = [each["name"] for each in values["parameters"]]
        assert "/rosdistro" in names
        published = set[str]()
        while "/fib" not in published:  # The graph comes in parts on a busy machine.
            graph = await client.find("connectionGraphUpdate")
            published.update(each["name"] for each in graph["publishedTopics"])
        await client.send("subscribeParameterUpdates", parameterNames=names)
        await client.is_processed()
        hub.graph.set_parameter("/page", "/rosdistro", "another")
        update = await client.find("parameterValues")
        assert update["parameters"] == [{"name": "/rosdistro", "value": "another"}]
        await client.subscribe("/fib")
        update = await client.find("connectionGraphUpdate")
        assert update["subscribedTopics"] == [{"name": "/fib", "subscriberIds": ["/studio"]}]
        await page.send_operation("unadvertise", topic="/fib")
        gone = await client.find("unadvertise")
        assert gone["channelIds"] == [client.channels["/fib"]["id"]]
        await client.send("unsubscribe", subscriptionIds=[0])
        await client.is_processed()


async def test_simulated_time(start_hub: StartHub) -> None:
    hub = await start_hub()
    async with connected(hub.port) as page, foxglove(hub) as client:
        await client.find("serverInfo")
        await page.send_operation(
            "call_service",
            service="/rosapi/set_param",
            args={"name": "/use_sim_time", "value": "true"},
        )
        assert "time" in (await client.find("serverInfo"))["capabilities"]
        await page.send_operation("advertise", topic="/clock", type="rosgraph_msgs/Clock")
        time = {"clock": {"secs": 5, "nsecs": 6}}
        await page.send_operation("publish", topic="/clock", msg=time)
        while await client.find_binary(2) != struct.pack("<BQ", 2, 5_000_000_006):
            pass


async def test_large_messages_arrive_whole_in_both_directions(start_hub: StartHub) -> None:
    hub = await start_hub()
    async with foxglove(hub) as studio, foxglove(hub, "?node=/other") as other:
        channel = {"id": 1, "topic": "/big", "encoding": "ros1", "schemaName": "std_msgs/String"}
        await studio.send("advertise", channels=[channel])
        await other.subscribe("/big")
        await other.is_processed()
        message = struct.pack("<I", LARGE) + bytes(range(256)) * (LARGE // 256)
        await studio.websocket.send(struct.pack("<BI", 1, 1) + message)
        assert (await other.find_binary(1))[13:] == message


async def test_slow_client_loses_the_oldest_and_delays_nobody(start_hub: StartHub) -> None:
    hub = await start_hub(queue_length=20)
    size, count = 100_000, 300
    async with (
        connected(hub.port, "/?node=/camera") as camera,
        connected(
            hub.port,
            "/?node=/slow",
            receive_buffer=4096,
            Sec_WebSocket_Protocol=SUBPROTOCOLS[0],
        ) as slow,
        foxglove(hub) as fast,
    ):
        await camera.advertises("/image", "std_msgs/String")
        await fast.subscribe("/image")
        await fast.is_processed()
        wanted = [{"id": 0, "channelId": fast.channels["/image"]["id"]}]
        text = json.dumps({"op": "subscribe", "subscriptions": wanted}).encode()
        await slow.send(frame(1, text), frame(PING, b"done"))
        await until(lambda: "/slow" in hub.graph.topics["/image"].subscribers())
        for number in range(count):
            await camera.send_operation(
                "publish", topic="/image", msg={"data": f"{number:05}" + "x" * size}
            )
            message = await fast.find_binary(1)
            assert message[17:22] == b"%05d" % number
        assert hub._own.clients.find("/slow") is not None
        dropped = hub.health()["slow_clients"]
        assert [each["node"] for each in dropped] == ["/slow"]  # type: ignore[attr-defined]
        numbers: list[int] = []
        status = None
        while not numbers or numbers[-1] < count - 1:
            opcode, payload = await slow.frame()
            if opcode == BINARY:
                numbers.append(int(payload[17:22]))
            elif b"Send buffer limit reached" in payload:
                status = json.loads(payload)
        assert status is not None
        assert (status["op"], status["level"]) == ("status", 1)
        assert numbers == sorted(numbers)
        assert numbers[-20:] == list(range(count - 20, count))
        assert len(numbers) < count


async def test_bag_that_is_played_has_a_time_line(start_hub: StartHub, tmp_path: Path) -> None:
    hub = await start_hub()
    path = tmp_path / "walk.bag"
    with open_writer(path, "none") as bag:
        text, md5sum = STANDARD.full_text(INT32), STANDARD.md5(INT32)
        connection = bag.connection("/n", INT32, md5sum, text, callerid="/talker", latching=False)
        for second in (100, 105, 110):
            bag.write(connection, second * 10**9, struct.pack("<i", second))
    words = ("bag", "play", str(path), "--pause", "-k", "-d", "0", "--node-name", "player")
    environment = {**os.environ, "FIBWS_HUB": hub.url}
    player = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "fibws", *words),
        env=environment,
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.DEVNULL,
    )
    try:
        async with foxglove(hub) as client:
            info = await client.find("serverInfo")
            while "playbackControl" not in info["capabilities"]:
                info = await client.find("serverInfo")
            assert (info["dataStartTime"]["sec"], info["dataEndTime"]["sec"]) == (100, 110)
            await client.subscribe("/n")
            await client.is_processed()
            request = struct.pack("<BBfBQI", 3, 0, 1000.0, 1, 105 * 10**9, 2) + b"id"
            await client.websocket.send(request)
            answers: list[int] = []
            numbers: list[bytes] = []
            while not answers or struct.pack("<i", 105) not in numbers:
                message = await client.receive()
                if isinstance(message, bytes) and message[0] == 1:
                    numbers.append(message[13:])
                elif isinstance(message, bytes) and message[19:] == b"id":
                    answers.append(message[14])
            assert answers == [1]  # It comes after a seek.
            player.terminate()
            while "playbackControl" in info["capabilities"]:
                info = await client.find("serverInfo")
    finally:
        with suppress(ProcessLookupError):
            player.kill()
        await player.wait()


async def test_meshes_of_loaded_robots_are_sent(
    start_hub: StartHub, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "my_robot"
    (package / "meshes").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>my_robot</name></package>", "utf-8")
    mesh = bytes(range(256)) * 10_000
    (package / "meshes" / "arm.stl").write_bytes(mesh)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    hub = await start_hub()
    uri = "package://my_robot/meshes/arm.stl"
    async with foxglove(hub) as client:
        assert "assets" in (await client.find("serverInfo"))["capabilities"]
        await client.send("fetchAsset", uri=uri, requestId=1)
        assert b"robot_description" in await client.find_binary(4)
        hub.graph.parameters.set("/robot_description", f'<mesh filename="{uri}"/>')
        for name in (uri, uri, "package://my_robot/../my_robot/package.xml"):
            await client.send("fetchAsset", uri=name, requestId=2)
        head = struct.pack("<BIBI", 4, 2, 0, 0)
        for _ in range(2):
            assert await client.find_binary(4) == head + mesh
        assert (await client.find_binary(4))[5] == 1
        # A disk that hangs must not delay the images of others, nor the other way round.
        are_free = threading.Event()
        for _ in range(MOST_THREADS):
            hub._threads.run(are_free.wait, lambda: None)
        try:
            await client.send("fetchAsset", uri=uri, requestId=2)
            assert await client.find_binary(4) == head + mesh
        finally:
            are_free.set()


async def test_tokens_and_rights(start_hub: StartHub, tmp_path: Path) -> None:
    file = tmp_path / "tokens.toml"
    file.write_text(
        entry("ann", 'allow = {subscribe = ["/open"], publish = ["/mine"]}')
        + entry("boss", "admin = true"),
        "utf-8",
    )
    hub = await start_hub(tokens=file)
    async with foxglove(hub, "?token=boss") as boss, foxglove(hub, "?token=ann") as ann:
        channels = [
            {"id": number, "topic": topic, "encoding": "ros1", "schemaName": INT32}
            for number, topic in enumerate(("/open", "/secret"))
        ]
        await boss.send("advertise", channels=channels)
        await ann.channel("/open")
        await ann.send("advertise", channels=channels)
        for topic in ("/open", "/secret"):
            assert topic in (await ann.find("status"))["message"]
        assert set(ann.channels) == {"/open"}
        file.write_text(entry("boss", "admin = true"), "utf-8")
        await reloaded(hub)
        with pytest.raises(ConnectionClosed) as closed:
            await ann.is_processed()
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 4401
    by_subprotocol = ("fibws.token.boss", SUBPROTOCOLS[1])
    async with foxglove(hub, "", *by_subprotocol) as boss:
        assert boss.websocket.subprotocol == SUBPROTOCOLS[1]
        await boss.find("serverInfo")
    async with foxglove(hub, "") as nobody:
        with pytest.raises(ConnectionClosed) as closed:
            await nobody.receive()
        assert closed.value.rcvd is not None
        assert (closed.value.rcvd.code, "token" in closed.value.rcvd.reason) == (4401, True)


async def test_client_that_sends_too_much_is_refused(start_hub: StartHub) -> None:
    hub = await start_hub(max_messages_per_second=0.1)
    async with foxglove(hub) as client:
        channel = {"id": 1, "topic": "/fib", "encoding": "ros1", "schemaName": INT32}
        await client.send("advertise", channels=[channel])

        async def flood() -> None:
            while True:
                await client.websocket.send(struct.pack("<BIi", 1, 1, 9))
                await asyncio.sleep(0.001)

        flooding = asyncio.create_task(flood())
        assert "messages dropped: 1" in (await client.find("status"))["message"]
        flooding.cancel()
        await asyncio.wait([flooding])


async def test_text_that_is_not_utf8_closes_the_connection(start_hub: StartHub) -> None:
    hub = await start_hub()
    async with connected(hub.port, Sec_WebSocket_Protocol=SUBPROTOCOLS[0]) as client:
        await client.send(frame(1, b"{", fin=True), frame(1, b"\xff"))
        while True:
            opcode, payload = await client.frame()
            if opcode == 8:
                break
        assert payload[:2] == struct.pack("!H", 1007)
