"""What goes through many things of a client is a generator, whose steps share the time of all.

Nothing here is run: the code's structure is looked at, since the next operation with a list is
written by somebody who does not know that one client's list must not make others wait.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import pytest

import fibws.hub
from fibws.hub.federation.records import Announcement
from fibws.hub.foxglove.messages import Operation
from fibws.protocol.operations import Request

HUB = Path(fibws.hub.__file__).parent
MODULES = sorted(
    path.relative_to(HUB).as_posix()
    for folder in ("rosbridge", "foxglove", "federation", "foreign")
    for path in HUB.glob(f"{folder}/*.py")
)
Function = ast.FunctionDef | ast.AsyncFunctionDef
Loop = ast.For | ast.AsyncFor | ast.comprehension

AT_ONCE = {
    ("federation/link.py", "_halves"): "an announcement of this hub, made within a turn",
    ("federation/zenoh_backplane.py", "announce"): "an announcement of this hub, made in a turn",
    ("federation/announced.py", "_set"): "the users of one topic",
    ("federation/announced.py", "_remove_record"): "the users of one topic",
    ("federation/offers.py", "_users_of"): "the users of one topic of this hub",
    ("rosbridge/services.py", "leave"): "lists what is removed later",
    ("rosbridge/actions.py", "leave"): "lists what is removed later",
    ("foxglove/session.py", "leave"): "the parts of a session",
    ("foxglove/playback.py", "leave"): "requests of one player, of which --max-calls may wait",
}
"""The functions that may go through something at once, and why."""


def list_fields(*models: Any) -> set[str]:
    """Return the names of the fields that hold several things."""
    return {
        name
        for model in models
        for name, field in model.model_fields.items()
        if any(kind in str(field.annotation) for kind in ("list[", "tuple[", "dict["))
    }


SENT = list_fields(*get_args(Operation), *get_args(Request), Announcement) - {"headers"}
"""The lists that clients and hubs send; headers are for those who are called."""


def functions(module: str) -> Iterator[Function]:
    tree = ast.parse((HUB / module).read_text("utf-8"))
    return (each for each in ast.walk(tree) if isinstance(each, Function))


def own_nodes(function: Function) -> Iterator[ast.AST]:
    """Yield what is in a function, but not in functions inside it."""
    waiting: list[ast.AST] = [*function.body]
    while waiting:
        node = waiting.pop()
        yield node
        if not isinstance(node, Function | ast.Lambda):
            waiting += ast.iter_child_nodes(node)


def is_generator(function: Function) -> bool:
    return any(isinstance(each, ast.Yield | ast.YieldFrom) for each in own_nodes(function))


def sent_list(expression: ast.expr) -> str | None:
    """Return the name of the list of a message that an expression is, or is made of."""
    for node in ast.walk(expression):
        if isinstance(node, ast.Attribute) and node.attr in SENT:
            if isinstance(node.value, ast.Name) and node.value.id != "self":
                return node.attr
    return None


def loops_at_once(module: str) -> Iterator[tuple[str, Loop]]:
    """Yield the loops of functions that are no generators, with the functions' names."""
    for function in functions(module):
        if not is_generator(function):
            for node in own_nodes(function):
                if isinstance(node, Loop):
                    yield function.name, node


@pytest.mark.parametrize("module", MODULES)
def test_lists_of_messages_are_gone_through_by_generators(module: str) -> None:
    found = {
        (module, name): ast.unparse(loop.iter)
        for name, loop in loops_at_once(module)
        if sent_list(loop.iter)
    }
    assert found.keys() <= AT_ONCE.keys(), found


@pytest.mark.parametrize("module", MODULES)
def test_what_is_left_or_withdrawn_is_gone_through_by_generators(module: str) -> None:
    names = ("leave", "forget", "withdraw_forbidden", "_remove_all")
    found = {
        (module, name): ast.unparse(loop.iter)
        for name, loop in loops_at_once(module)
        if name in names
    }
    assert found.keys() <= AT_ONCE.keys(), found


FIRST = re.compile(r"next\(iter\((?:self\.)?(?:\w+\.)?(\w+)(?:\.items\(\)|\.values\(\))?\)")
FEW = {
    "_holding": "a topic's users, of which the first is named",
    "sources": "a topic's users, of which the first is named",
    "requests": "a client's subscriptions to one topic, of which the first is named",
    "_idle": "connections to one service, at its end",
    "pings": "an OrderedDict of `Rosnode._pings`",
    "calls": "an OrderedDict of `Services._calls_of`",
    "notes": "an OrderedDict of `NodeCalls._notes`",
    "kept": "a `FrameQueue`",
}
"""What the first item may be taken of though it is no attribute with an `OrderedDict`, and why."""


def test_queues_are_no_plain_dicts() -> None:
    """The first of a dict from which many were removed takes long to find: O(n) each time."""
    found = set()
    for path in HUB.rglob("*.py"):
        text = path.read_text("utf-8")
        for name in FIRST.findall(text):
            if name not in FEW and f"{name}: OrderedDict[" not in text:
                found.add((path.name, name))
    assert not found


def test_table_has_no_function_that_is_gone() -> None:
    found = {(module, name) for module in MODULES for name, _ in loops_at_once(module)}
    assert AT_ONCE.keys() <= found


def test_lists_are_known() -> None:
    assert {"subscriptions", "channels", "parameters", "topics", "nodes"} <= SENT
