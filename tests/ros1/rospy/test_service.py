"""Calls are answered, each in a thread of its own, with rospy's texts for what goes wrong."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
from genpy.message import get_service_class
from rospy.service import Service, ServiceException, convert_return_to_response

import fibws
from fibws.errors import ServiceError
from ros1.rospy.programs import running_hub

AddTwoInts: Any = get_service_class("rospy_tutorials/AddTwoInts")
Trigger: Any = get_service_class("std_srvs/Trigger")
Empty: Any = get_service_class("std_srvs/Empty")


@pytest.mark.parametrize(
    "returned", [Trigger._response_class(True, "x"), {"message": "x"}, (True, "x"), [True, "x"]]
)
def test_handler_can_return_a_response_in_many_forms(returned: Any) -> None:
    assert convert_return_to_response(returned, Trigger._response_class).message == "x"


def test_handler_can_return_the_only_field() -> None:
    assert convert_return_to_response(3, AddTwoInts._response_class).sum == 3
    empty = Empty._response_class
    assert convert_return_to_response([], empty) == convert_return_to_response({}, empty) == empty()


@pytest.mark.parametrize(
    ("returned", "fault"),
    [
        (None, "service handler returned None"),
        ({"text": "x"}, "handler returned invalid value: text is not an attribute of "),
        ("x", "handler returned invalid value: Invalid number of arguments, "),
        ((True,), "handler returned wrong number of values: Invalid number of arguments, "),
    ],
)
def test_invalid_response_is_refused(returned: Any, fault: str) -> None:
    with pytest.raises(ServiceException) as raised:
        convert_return_to_response(returned, Trigger._response_class)
    assert str(raised.value).startswith(fault)


def test_service_can_be_provided_only_once_by_a_node() -> None:
    service = Service("twice", Empty, print)
    with pytest.raises(ServiceException) as raised:
        Service("twice", Empty, print)
    assert str(raised.value) == "service [/twice] already registered"
    service.shutdown()
    Service("twice", Empty, print).shutdown("it is over")


def test_service_needs_a_name() -> None:
    with pytest.raises(ValueError, match="service name is not a non-empty string"):
        Service("", Empty, print)
    with pytest.warns(UserWarning, match="'no name' is not a legal ROS graph resource name"):
        Service("no name", Empty, print).shutdown()


async def test_calls_are_handled_concurrently() -> None:
    async with running_hub() as programs, fibws.Node("caller", hub=programs.hub.url) as node:
        program = await programs.start("""
            import rospy, sys, threading
            from rospy_tutorials.srv import AddTwoInts

            both = threading.Barrier(2)

            def add(request):
                both.wait(60)
                header = request._connection_header
                names = ("callerid", "service", "cookies")
                sys.stdout.write(" ".join(header[name] for name in names) + "\\n")
                return request.a + request.b

            rospy.init_node("server")
            rospy.Service("add", AddTwoInts, add)
            print("ready")
            rospy.spin()
        """)
        assert await program.read_line() == "ready"
        first, second = await asyncio.gather(
            *(
                node.call("add", "rospy_tutorials/AddTwoInts", request, headers={"cookies": "oreo"})
                for request in ({"a": 1, "b": 2}, {"a": 3, "b": 4})
            )
        )
        assert (first.sum, second.sum) == (3, 7)
        assert [await program.read_line() for _ in range(2)] == ["/caller /add oreo"] * 2
        program.interrupt()
        assert await program.finish() == []


async def test_callers_get_the_errors_of_handlers() -> None:
    async with running_hub() as programs, fibws.Node("caller", hub=programs.hub.url) as node:
        program = await programs.start("""
            import rospy
            from rospy_tutorials.srv import AddTwoInts

            def add(request):
                if request.a == 1:
                    raise ValueError("not one")
                if request.a == 2:
                    raise rospy.ServiceException("not two")
                if request.a == 3:
                    return "three"
                if request.a == 5:
                    raise SystemExit
                return None

            def tell(fault, kind, value, traceback):
                print("told of", fault, kind.__name__, value is fault, traceback is not None)

            rospy.init_node("server")
            rospy.Service("add", AddTwoInts, add, error_handler=tell)
            print("ready")
            rospy.spin()
        """)
        assert await program.read_line() == "ready"
        faults = []
        for number in range(1, 6):
            with pytest.raises(ServiceError) as raised:
                await node.call("add", "rospy_tutorials/AddTwoInts", {"a": number})
            faults.append(raised.value.text)
        assert faults == [
            "error processing request: not one",
            "service cannot process request: not two",
            "error processing request: field sum must be an integer type",
            "service cannot process request: service handler returned None",
            "error processing request: its thread has ended",
        ]
        program.interrupt()
        assert await program.finish() == [
            "told of not one ValueError True True",
            "told of field sum must be an integer type SerializationError True True",
        ]


async def test_arrays_of_a_response_may_be_any_iterables() -> None:
    async with running_hub() as programs, fibws.Node("caller", hub=programs.hub.url) as node:
        program = await programs.start("""
            import rospy
            from roscpp.msg import Logger
            from roscpp.srv import GetLoggers, GetLoggersResponse

            loggers = {"one": Logger("one", "info"), "two": Logger("two", "warn")}
            responses = iter([
                GetLoggersResponse(loggers.values()),
                GetLoggersResponse(Logger(name, "info") for name in loggers),
                map(loggers.get, loggers),
                {"loggers": (loggers["one"], loggers["two"])},
            ])

            rospy.init_node("server")
            rospy.Service("list", GetLoggers, lambda request: next(responses))
            print("ready")
            rospy.spin()
        """)
        assert await program.read_line() == "ready"
        for _ in range(4):
            response = await node.call("list", "roscpp/GetLoggers")
            assert [logger.name for logger in response.loggers] == ["one", "two"]
        program.interrupt()
        assert await program.finish() == []


async def test_error_of_a_handler_is_logged() -> None:
    async with running_hub() as programs, fibws.Node("caller", hub=programs.hub.url) as node:
        program = await programs.start("""
            import rospy
            from std_srvs.srv import Empty

            def fail(request):
                rospy.signal_shutdown("done") if failed else failed.append(1)
                raise ValueError("of no use")

            failed = []
            rospy.init_node("server")
            service = rospy.Service("fail", Empty, fail)
            print("ready", flush=True)
            service.spin()
        """)
        assert await program.read_line() == "ready"
        with pytest.raises(ServiceError):
            await node.call("fail", "std_srvs/Empty")
        program.interrupt()
        text = await program.read_errors()
        assert "Error processing request: of no use\n['Traceback (most recent call last):" in text
        assert "Service /fail failed" not in text, "once is enough"


async def test_service_is_gone_after_shutdown() -> None:
    async with running_hub() as programs, fibws.Node("caller", hub=programs.hub.url) as node:
        program = await programs.start("""
            import rospy, threading
            from std_srvs.srv import Empty

            rospy.init_node("server")
            service = rospy.Service("end", Empty, lambda request: None)
            timer = threading.Timer(0.01, service.shutdown, ["enough"])
            timer.start()
            service.spin()
            is_shutdown = rospy.is_shutdown()
            rospy.Service("end", Empty, lambda request: {})
            print(is_shutdown)
            rospy.spin()
        """)
        assert await program.read_line() == "False"
        await node.wait_for_service("end", timeout=60)
        await node.call("end", "std_srvs/Empty")
        program.interrupt()
        assert await program.finish() == []
