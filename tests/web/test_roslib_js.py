"""/roslib.js in a page of another server, written like the first tutorial of roslib 1."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from playwright.async_api import Browser

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import Twist
from fibws.msg.std_msgs import String
from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsRequest, AddTwoIntsResponse
from fibws.srv.std_srvs import SetBool

from .conftest import Complaints, web_address

TUTORIAL = """\
<!DOCTYPE html>
<html>
<head>
<meta charset="utf-8" />
<script type="text/javascript" src="{site}/roslib.js"></script>
<script type="text/javascript">
  var seen = {{}};
  var ros = new ROSLIB.Ros({{
    url : '{hub}'
  }});
  ros.on('connection', function() {{ seen.connection = true; }});
  ros.on('error', function(error) {{ seen.error = String(error); }});

  var cmdVel = new ROSLIB.Topic({{
    ros : ros,
    name : '/cmd_vel',
    messageType : 'geometry_msgs/Twist'
  }});
  var twist = new ROSLIB.Message({{
    linear : {{ x : 0.1, y : 0.2, z : 0.3 }},
    angular : {{ x : -0.1, y : -0.2, z : -0.3 }}
  }});
  cmdVel.publish(twist);

  var listener = new ROSLIB.Topic({{
    ros : ros,
    name : '/listener',
    messageType : 'std_msgs/String'
  }});
  listener.subscribe(function(message) {{
    seen.received = message.data;
    listener.unsubscribe();
  }});

  var addTwoIntsClient = new ROSLIB.Service({{
    ros : ros,
    name : '/add_two_ints',
    serviceType : 'rospy_tutorials/AddTwoInts'
  }});
  var request = new ROSLIB.ServiceRequest({{ a : 1, b : 2 }});
  addTwoIntsClient.callService(request, function(result) {{ seen.sum = result.sum; }});

  var favoriteColor = new ROSLIB.Param({{ ros : ros, name : 'favorite_color' }});
  favoriteColor.set('red');
  favoriteColor.get(function(value) {{ seen.color = value; }});

  var setBool = new ROSLIB.Service({{
    ros : ros,
    name : '/set_bool',
    serviceType : 'std_srvs/SetBool'
  }});
  setBool.advertise(function(request, response) {{
    response.success = true;
    response.message = 'Set to ' + request.data;
    return true;
  }});
</script>
</head>
<body><h1>Simple roslib Example</h1></body>
</html>
"""


@asynccontextmanager
async def served(html: str) -> AsyncIterator[str]:
    """Run a server on another port with this page only; yield its address."""

    async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readuntil(b"\r\n\r\n")
        body = html.encode()
        head = f"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: {len(body)}\r\n"
        writer.write(f"{head}Connection: close\r\n\r\n".encode() + body)
        await writer.drain()
        writer.close()

    server = await asyncio.start_server(answer, "127.0.0.1", 0)
    async with server:
        yield f"http://127.0.0.1:{server.sockets[0].getsockname()[1]}/"


@pytest.mark.smoke
async def test_page_of_an_old_tutorial_works(
    browser: Browser, hub: HubServer, complaints: Complaints
) -> None:
    page = await browser.new_page()
    complaints.watch(page)
    async with fibws.Node("tutorial", hub=hub.url) as node:
        await node.service("add_two_ints", AddTwoInts, add)
        listener = await node.advertise("listener", String, latch=True)
        await listener.publish(data="hello")
        velocities = node.subscribe("cmd_vel", Twist)
        tutorial = TUTORIAL.format(site=web_address(hub), hub=hub.url)
        async with served(tutorial) as address:
            await page.goto(address)
            velocity = await anext(aiter(velocities))
            assert velocity.linear.z == 0.3
            assert velocity.angular.x == -0.1
            await page.wait_for_function(
                "seen.connection && seen.received && seen.sum && seen.color"
            )
            assert await page.evaluate("seen") == {
                "connection": True,
                "received": "hello",
                "sum": 3,
                "color": "red",
            }
            assert await node.params.get("/favorite_color") == "red"
            answer = await node.call("set_bool", SetBool, SetBool.Request(data=True))
            assert answer.message == "Set to true"
    await page.close()
    assert complaints.seen == []


def add(request: AddTwoIntsRequest) -> AddTwoIntsResponse:
    return AddTwoIntsResponse(request.a + request.b)
