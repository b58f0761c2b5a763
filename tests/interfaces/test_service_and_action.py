"""A type checker knows which messages a service or an action has."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

PROGRAM = """
from typing import Any, TypeVar

from typing_extensions import assert_type

from fibws.action import action_class
from fibws.action.actionlib_tutorials import Fibonacci
from fibws.interfaces import Action, Message, Service
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.srv import service_class
from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsRequest, AddTwoIntsResponse

Req = TypeVar("Req", bound=Message)
Res = TypeVar("Res", bound=Message)
G = TypeVar("G", bound=Message)
R = TypeVar("R", bound=Message)
F = TypeVar("F", bound=Message)


def call(service: type[Service[Req, Res]], request: Req) -> Res:
    return service.Response()


def empty(service: type[Service[Req, Res]]) -> Req:
    return service.Request()


def send(action: type[Action[G, R, F]], goal: G) -> tuple[R, F]:
    return action.Result(), action.Feedback()


assert_type(AddTwoInts.Request(a=1, b=2), AddTwoIntsRequest)
assert_type(AddTwoInts.Request(1, 2).a, int)


def total(request: AddTwoInts.Request) -> AddTwoInts.Response:
    return AddTwoInts.Response(request.a + request.b)


assert_type(total(AddTwoIntsRequest(1, 2)), AddTwoIntsResponse)
AddTwoInts.Request(c=1)  # type: ignore[call-arg]
assert_type(call(AddTwoInts, AddTwoIntsRequest(1, 2)), AddTwoIntsResponse)
assert_type(empty(AddTwoInts), AddTwoIntsRequest)
call(AddTwoInts, AddTwoIntsResponse())  # type: ignore[misc]
assert_type(AddTwoInts._type, str)

assert_type(Fibonacci.Goal(order=5), FibonacciGoal)
assert_type(send(Fibonacci, FibonacciGoal(5)), tuple[FibonacciResult, FibonacciFeedback])
send(Fibonacci, FibonacciResult())  # type: ignore[misc]

assert_type(service_class("std_srvs/Empty"), type[Service[Any, Any]])
assert_type(action_class("tf2_msgs/LookupTransform"), type[Action[Any, Any, Any]])
call(service_class("std_srvs/Empty"), AddTwoIntsRequest())
"""


@pytest.mark.long
def test_service_and_action_list_their_messages(tmp_path: Path) -> None:
    script = tmp_path / "program.py"
    script.write_text(PROGRAM, "utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", str(script)], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
