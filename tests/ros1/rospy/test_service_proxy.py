"""Service calls of nodes, and of programs that are not nodes."""

from __future__ import annotations

import asyncio
from importlib import import_module
from typing import Any

import pytest
from rospy import core
from rospy.exceptions import ROSInterruptException
from rospy.service import ServiceException
from rospy.service_proxy import ServiceProxy, wait_for_service

import fibws
from fibws.errors import CallRefused, HubLost, ServiceError, ServiceLost
from ros1.rospy.programs import running_hub

NODE = "import rospy; rospy.init_node('caller')\n"
NO_NODE = "import rospy\n"

ADD, EMPTY = "6a2e34150c00229791cc89ff309fff21", "d41d8cd98f00b204e9800998ecf8427e"
"""Substitutes for rospy_tutorials/AddTwoInts and std_srvs/Empty of ROS."""


async def serve(node: fibws.Node) -> None:
    def add(request: Any, header: dict[str, str]) -> int:
        if request.a == 13:
            raise ValueError(f"no {request.a}")
        if request.a == 14:
            raise ValueError("request from [/me]: md5sums do not match: [1] vs. [2]")
        if request.a == 15:
            raise CallRefused("Service /add does not exist")
        return int(request.a + request.b)

    await node.service("add", "rospy_tutorials/AddTwoInts", add, headers=True)


@pytest.mark.parametrize("beginning", [NODE, NO_NODE], ids=["a node", "no node"])
async def test_service_can_be_called_in_all_ways(beginning: str) -> None:
    async with running_hub() as programs, fibws.Node("server", hub=programs.hub.url) as node:
        await serve(node)
        assert await programs.run(
            beginning
            + """
from rospy_tutorials.srv import AddTwoInts, AddTwoIntsRequest

rospy.wait_for_service("add", rospy.Duration(60))
add = rospy.ServiceProxy("add", AddTwoInts, persistent=True)
add.wait_for_service(timeout=60)
print(add(1, 2).sum, add(a=3).sum, add.call(AddTwoIntsRequest(4, 5)).sum, add().sum)
header = add()._connection_header
print(*(header[name] for name in ("callerid", "service", "type")))
for arguments in ((13, 0), (14, 0), (15, 0), ("one", 2), (AddTwoIntsRequest,), (1, 2, 3)):
    try:
        print(add(*arguments))
    except Exception as fault:
        print(type(fault).__name__, fault)
add.close()
for call in (lambda: rospy.ServiceProxy("none", AddTwoInts)(1, 2), lambda: add(1, b=2)):
    try:
        print(call())
    except Exception as fault:
        print(type(fault).__name__, fault)
"""
        ) == [
            "3 3 9 0",
            "/server /add rospy_tutorials/AddTwoInts",
            "ServiceException service [/add] responded with an error: "
            "b'error processing request: ValueError: no 13'",
            "ServiceException service [/add] responded with an error: b'error processing request: "
            "ValueError: request from [/me]: md5sums do not match: [1] vs. [2]'",
            "ServiceException service [/add] responded with an error: "
            "b'Service /add does not exist'",
            "SerializationError field a must be an integer type",
            "TypeError request object is not a valid request message instance",
            "TypeError Invalid number of arguments, args should be ['a', 'b'] args are(1, 2, 3)",
            "ServiceException service [/none] unavailable",
            "TypeError publish() can be called with arguments or keywords, but not both.",
        ]


@pytest.mark.parametrize("beginning", [NODE, NO_NODE], ids=["a node", "no node"])
async def test_service_of_another_type_is_refused(beginning: str) -> None:
    async with running_hub() as programs, fibws.Node("server", hub=programs.hub.url) as node:
        await serve(node)
        said = await programs.run(
            beginning
            + """
from std_srvs.srv import Empty

for persistent in (False, True):
    try:
        print(rospy.ServiceProxy("add", Empty, persistent)())
    except rospy.ServiceException as fault:
        print(fault)
"""
        )
        assert len(said) == 2
        for line in said:
            assert line.startswith("unable to connect to service: remote error reported: request ")
            assert line.endswith(f"]: md5sums do not match: [{EMPTY}] vs. [{ADD}]")


@pytest.mark.parametrize("beginning", [NODE, NO_NODE], ids=["a node", "no node"])
async def test_type_of_a_service_is_checked_before_the_fields(beginning: str) -> None:
    async with running_hub() as programs, fibws.Node("server", hub=programs.hub.url) as node:
        await serve(node)
        printed = await programs.run(
            beginning
            + """
from std_srvs.srv import SetBool

for name in ("add", "none", "not legal"):
    try:
        rospy.ServiceProxy(name, SetBool)("no bool")
    except rospy.ServiceException as fault:
        print(fault)
"""
        )
        assert printed == [
            "unable to connect to service: [/add] has type [rospy_tutorials/AddTwoInts], "
            "expected [std_srvs/SetBool]",
            "service [/none] unavailable",
            "service [/not legal] unavailable",
        ]


@pytest.mark.parametrize("beginning", [NODE, NO_NODE], ids=["a node", "no node"])
async def test_handler_gets_the_headers_of_the_caller(beginning: str) -> None:
    async with running_hub() as programs, fibws.Node("server", hub=programs.hub.url) as node:
        headers: list[dict[str, str]] = []

        async def tell(request: Any, header: dict[str, str]) -> dict[str, Any]:
            headers.append(header)
            return {}

        await node.service("tell", "std_srvs/Empty", tell, headers=True)
        await programs.run(
            beginning
            + """
from std_srvs.srv import Empty

rospy.ServiceProxy("tell", Empty, headers={"number": 5})()
"""
        )
        [header] = headers
        del header["callerid"]
        assert header == {"number": "5", "md5sum": EMPTY}


@pytest.mark.parametrize("beginning", [NODE, NO_NODE], ids=["a node", "no node"])
async def test_wait_for_service_times_out(beginning: str) -> None:
    async with running_hub() as programs:
        assert (
            await programs.run(
                beginning
                + """
for name in ("never", "not legal"):
    for timeout in (0.05, rospy.Duration(0.05), -1):
        try:
            rospy.wait_for_service(name, timeout)
        except rospy.ROSException as fault:
            print(fault)
"""
            )
            == ["timeout exceeded while waiting for service /never"] * 3
            + ["timeout exceeded while waiting for service /not legal"] * 3
        )


@pytest.mark.parametrize("name", ["never", "not legal"])
async def test_shutdown_interrupts_wait_for_service(name: str) -> None:
    async with running_hub() as programs:
        program = await programs.start(
            NODE
            + f"""
print("waiting")
try:
    rospy.wait_for_service({name!r})
except rospy.ROSInterruptException as fault:
    print(fault)
"""
        )
        assert await program.read_line() == "waiting"
        program.interrupt()
        assert await program.finish() == ["rospy shutdown"]


def test_timeout_of_zero_is_an_error() -> None:
    with pytest.raises(ValueError, match="timeout must be non-zero"):
        wait_for_service("add", 0)


async def test_wait_for_service_ends_when_the_service_exists() -> None:
    async with running_hub() as programs, fibws.Node("server", hub=programs.hub.url) as node:
        program = await programs.start("""
            import rospy
            print("ready")
            rospy.wait_for_service("add")
            print("there it is")
        """)
        assert await program.read_line() == "ready"
        await serve(node)
        assert await program.finish() == ["there it is"]


CALL = """
from std_srvs.srv import Empty
rospy.wait_for_service("slow")
print("calling")
try:
    rospy.ServiceProxy("slow", Empty, headers={"number": 5})()
except (rospy.ServiceException, rospy.ROSInterruptException) as fault:
    print(type(fault).__name__, fault)
"""


async def test_shutdown_interrupts_a_call() -> None:
    async with running_hub() as programs, fibws.Node("server", hub=programs.hub.url) as node:
        headers: asyncio.Queue[dict[str, str]] = asyncio.Queue()

        async def slow(request: Any, header: dict[str, str]) -> None:
            headers.put_nowait(header)
            await asyncio.Event().wait()

        await node.service("slow", "std_srvs/Empty", slow, headers=True)
        program = await programs.start(NODE + CALL)
        assert await program.read_line() == "calling"
        async with asyncio.timeout(60):
            header = await headers.get()
        assert header == {"callerid": "/caller", "number": "5", "md5sum": EMPTY}
        program.interrupt()
        fault = "node shutdown interrupted service call"
        assert await program.finish() == [f"ROSInterruptException {fault}"]


FAILURES = [
    ServiceError("/slow", "error processing request: ROS shutdown request"),
    ServiceLost("/slow"),
    HubLost("ws://127.0.0.1:1", "it ends"),
]


@pytest.mark.parametrize("failure", FAILURES, ids=repr)
def test_failure_during_shutdown_is_an_interruption(
    failure: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise failure

    slow = ServiceProxy("slow", import_module("std_srvs.srv").Empty)
    monkeypatch.setattr(slow, "_call", fail)
    with pytest.raises(ServiceException):
        slow()
    monkeypatch.setattr(core, "is_shutdown", lambda: True)
    with pytest.raises(ROSInterruptException, match="node shutdown interrupted service call"):
        slow()


@pytest.mark.parametrize("beginning", [NODE, NO_NODE], ids=["a node", "no node"])
async def test_lost_server_is_a_transport_error(beginning: str) -> None:
    async with running_hub() as programs:
        called = asyncio.Event()

        async def slow(request: Any) -> None:
            called.set()
            await asyncio.Event().wait()

        async with fibws.Node("server", hub=programs.hub.url) as node:
            await node.service("slow", "std_srvs/Empty", slow)
            program = await programs.start(beginning + CALL)
            async with asyncio.timeout(60):
                await called.wait()
        assert await program.finish() == [
            "calling",
            "ServiceException transport error completing service call: "
            "service [/slow] unavailable: /server has left",
        ]


async def test_call_without_a_hub_is_an_error() -> None:
    async with running_hub() as programs:
        assert await programs.run("""
            import os, rospy
            from std_srvs.srv import Empty

            os.environ["FIBWS_HUB"] = "127.0.0.1:1"
            try:
                rospy.ServiceProxy("add", Empty)()
            except rospy.ServiceException as fault:
                print(fault)
            try:
                rospy.wait_for_service("add", 0.01)
            except rospy.ROSException as fault:
                print(fault)
        """) == ["unable to contact master", "timeout exceeded while waiting for service /add"]
