"""Types as mypy checks them: a needless ``type: ignore`` is an error, too."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

TOPICS = """
from typing import Any

from typing_extensions import assert_type

import fibws
from fibws.msg.std_msgs import Int32, String


async def program(node: fibws.Node) -> None:
    numbers = await node.advertise("numbers", Int32)
    await numbers.publish(5)
    await numbers.publish(data=5)
    await numbers.publish(Int32(5))
    await numbers.publish()
    await numbers.publish(String("x"))  # type: ignore[call-overload]
    await numbers.publish(dat=5)  # type: ignore[call-overload]
    await numbers.publish("five")  # type: ignore[call-overload]
    await numbers.publish(5, 6)  # type: ignore[call-overload]
    await node.advertise("numbers", int)  # type: ignore[type-var]
    named = await node.advertise("numbers", "std_msgs/Int32")
    await named.publish(5, what="ever")
    kept: fibws.Publisher[Int32] = numbers
    await kept.publish(Int32(5))
    numbers._send(numbers._encode(5))
    numbers._send(numbers._encode_to("/listener", data=5))
    numbers._encode("five")  # type: ignore[call-overload]
    numbers._encode_to("/listener", String("x"))  # type: ignore[call-overload]
    numbers._encode_to(data=5)  # type: ignore[call-overload]
    async for names in numbers.peers.changes():
        assert_type(names, list[str])
    await node.advertise("numbers", Int32, headers={"user": 5})  # type: ignore[dict-item]
    async for number in node.subscribe("numbers", Int32):
        assert_type(number, Int32)
    all_ = node.subscribe("numbers", Int32, queue_size=None, headers=True, peers=True)
    assert_type(all_, fibws.Subscription[Int32])
    assert_type(all_.connection_header, dict[str, str])
    all_._hand_to(lambda number: assert_type(number, Int32))
"""


SERVICES = """
from typing import Any

from typing_extensions import assert_type

import fibws
from fibws.msg.std_msgs import Int32
from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsRequest, AddTwoIntsResponse, BadTwoInts
from fibws.srv.std_srvs import Trigger


def add(request: AddTwoIntsRequest) -> AddTwoIntsResponse:
    return AddTwoInts.Response(request.a + request.b)


async def add_later(request: AddTwoIntsRequest) -> AddTwoIntsResponse:
    return add(request)


async def add_as_the_service_says(request: AddTwoInts.Request) -> AddTwoInts.Response:
    return add(request)


def nothing(request: AddTwoIntsRequest) -> None:
    pass


def add_for(request: AddTwoIntsRequest, header: dict[str, str]) -> AddTwoIntsResponse:
    return add(request)


async def program(node: fibws.Node) -> None:
    server = await node.service("add", AddTwoInts, add)
    assert_type(server, fibws.ServiceServer[AddTwoIntsRequest, AddTwoIntsResponse])
    await node.service("add", AddTwoInts, add_later)
    await node.service("add", AddTwoInts, add_as_the_service_says)
    await node.service("add", AddTwoInts, None)  # type: ignore[call-overload]
    await node.service("add", AddTwoInts, lambda request: request.a + request.b)
    await node.service("add", AddTwoInts, lambda request: {"sum": request.a + request.b})
    await node.service("add", AddTwoInts, nothing)  # type: ignore[arg-type]
    await node.service("add", Trigger, add)  # type: ignore[arg-type]
    server = await node.service("add", AddTwoInts, add_for, headers=True)
    await node.service("add", AddTwoInts, add_for)  # type: ignore[arg-type]
    await node.service("add", AddTwoInts, add, headers=True)  # type: ignore[call-overload]
    await node.service("add", "rospy_tutorials/AddTwoInts", add_for, headers=True)
    await node.service("add", "rospy_tutorials/AddTwoInts", add)
    assert_type(await node.call("add", AddTwoInts, AddTwoInts.Request(1, 2)), AddTwoIntsResponse)
    assert_type(await node.call("add", AddTwoInts, {"a": 1}), AddTwoIntsResponse)
    assert_type(await node.call("add", "rospy_tutorials/AddTwoInts", {"a": 1}), Any)
    await node.call("add", AddTwoInts, BadTwoInts.Request(1, 2))  # type: ignore[misc]
    await node.call("add", Int32)  # type: ignore[arg-type]
    assert_type(await node.wait_for_message("numbers", Int32), Int32)
"""


ACTIONS = """
from typing import Any

from typing_extensions import assert_type

import fibws
from fibws.action.actionlib_tutorials import Fibonacci
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.msg.std_msgs import Int32

Goal = fibws.ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback]


async def execute(goal: Goal) -> FibonacciResult:
    assert_type(goal.request, FibonacciGoal)
    await goal.publish_feedback(FibonacciFeedback([1]))
    await goal.publish_feedback({"sequence": [1]})
    await goal.publish_feedback(FibonacciResult([1]))  # type: ignore[arg-type]
    await goal.cancellation(1)  # type: ignore[call-arg]
    return goal.canceled()


def execute_at_once(goal: Goal) -> dict[str, Any]:
    return {"sequence": [goal.request.order]}


def nothing(goal: Goal) -> None:
    pass


async def program(node: fibws.Node, over: fibws.Over) -> None:
    server = await node.action_server("fibonacci", Fibonacci, execute, over=over)
    assert_type(
        server, fibws.ActionServer[FibonacciGoal, FibonacciResult, FibonacciFeedback]
    )
    await node.action_server("fibonacci", Fibonacci, execute_at_once)
    await node.action_server("fibonacci", Fibonacci, nothing)  # type: ignore[arg-type]
    await node.action_server("fibonacci", "actionlib_tutorials/Fibonacci", execute)
    kept: fibws.Execute[FibonacciGoal, FibonacciResult, FibonacciFeedback] = execute
    client = node.action_client("fibonacci", Fibonacci, over="topics")
    goal = await client.send(FibonacciGoal(5))
    assert_type(await goal.result(timeout=5), FibonacciResult)
    async for feedback in goal.feedback():
        assert_type(feedback, FibonacciFeedback)
    await client.send({"order": 5})
    await client.send(Int32(5))  # type: ignore[arg-type]
    node.action_client("fibonacci", Fibonacci, over="air")  # type: ignore[arg-type]
    named = await node.action_client("fibonacci", "actionlib_tutorials/Fibonacci").send({})
    assert_type(await named.result(), Any)
"""


@pytest.mark.parametrize(
    "program", [TOPICS, SERVICES, ACTIONS], ids=["topics", "services", "actions"]
)
def test_publishers_services_and_actions_are_of_their_types(tmp_path: Path, program: str) -> None:
    script = tmp_path / "program.py"
    script.write_text(program, "utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", str(script)], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
