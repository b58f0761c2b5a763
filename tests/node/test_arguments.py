"""Wrong arguments of the public classes: the errors say what would be right."""

from __future__ import annotations

import asyncio
import inspect
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from conftest import StartHub

import fibws
from fibws.action.actionlib_tutorials import Fibonacci
from fibws.errors import FibwsError
from fibws.msg.std_msgs import Int32, String
from fibws.node.actions.client import ActionClient, ClientGoal
from fibws.node.actions.server import ActionServer, ServerGoal
from fibws.node.clock import Rate
from fibws.node.graph import Graph
from fibws.node.params import Params
from fibws.node.peers import Peers
from fibws.node.services import ServiceServer
from fibws.public_classes import Public
from fibws.srv.rospy_tutorials import AddTwoInts
from fibws.tf import TransformListener

CLASSES: tuple[type[Any], ...] = (
    *(fibws.Node, fibws.Hub, fibws.Publisher, fibws.Subscription, ServiceServer),
    *(ActionClient, ClientGoal, ActionServer, ServerGoal, Rate, Graph, Params, Peers),
    TransformListener,
)
ROS: Any = fibws
"""The same for calls that mypy would refuse."""
PYTHONS = re.compile(r"positional argument|unexpected keyword|not supported between|__init__")
"""Words of Python's own errors."""


def function(*arguments: object) -> None:
    """Stand for a callback."""


def methods() -> Iterator[Any]:
    """Return the public methods that take arguments, of all public classes."""
    for class_ in CLASSES:
        assert issubclass(class_, Public)
        for name, method in inspect.getmembers(class_, inspect.isfunction):
            parameters = inspect.signature(inspect.unwrap(method)).parameters.values()
            kinds = {each.kind for each in parameters}
            takes_all = {inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD}
            is_public = name == "__init__" or name[0] != "_"
            if is_public and len(parameters) > 1 and not takes_all <= kinds:
                yield pytest.param(class_, method, id=f"{class_.__name__}.{name}")


@pytest.mark.parametrize(("class_", "method"), [*methods()])
def test_arguments_that_do_not_fit_are_explained(class_: type[Any], method: Any) -> None:
    parameters = [*inspect.signature(inspect.unwrap(method)).parameters.values()][1:]
    most = [None] * len(parameters)
    misspelled = f"{parameters[0].name}_"
    for arguments, named in (([*most, None], {}), ((), {misspelled: None})):
        with pytest.raises(TypeError) as caught:
            method(None, *arguments, **named)
        text = str(caught.value)
        assert class_.__name__ in text and not PYTHONS.search(text), text
        if [*inspect.signature(method).parameters][1:]:
            assert parameters[0].name in text or class_._hints, text
        else:
            assert "Made by" in text


def test_error_within_a_method_is_its_own() -> None:
    with pytest.raises(TypeError, match=r"got 5$"):
        ROS.Node("talker", hub=5)


def test_methods_look_as_they_are_written() -> None:
    call = inspect.signature(fibws.Node.call)
    assert [*call.parameters] == ["self", "name", "type", "request", "timeout", "headers"]
    assert asyncio.iscoroutinefunction(fibws.Node.call)
    assert not asyncio.iscoroutinefunction(fibws.Node.subscribe)
    assert (fibws.Node.call.__doc__ or "").startswith("Call a service")


def test_methods_of_a_users_class_are_left_alone() -> None:
    class Mine(fibws.Node):
        def greet(self, text: str) -> str:
            return text

    with pytest.raises(TypeError, match="positional argument"):
        Mine("mine").greet()  # type: ignore[call-arg]


def test_names_of_other_libraries_lead_to_those_of_this_one() -> None:
    for class_ in CLASSES:
        for name, right in class_._other_names.items():
            assert not hasattr(class_, name)
            for known in re.findall(r"node\.(\w+)", right):
                assert hasattr(fibws.Node, known) or known in ("log", "params", "graph")
    node: Any = fibws.Node("talker")
    with pytest.raises(AttributeError, match=r"'create_publisher'; write await node\.advertise"):
        node.create_publisher(String, "chatter", 10)
    with pytest.raises(AttributeError, match=r"no attribute 'advertize'$"):
        node.advertize("chatter", String)
    with pytest.raises(TypeError, match=r"node\.params\.get\(name\)"):
        node.params["speed"]
    with pytest.raises(TypeError, match=r"node\.params\.set\(name, value\)"):
        node.params["speed"] = 1


Case = tuple[str, Callable[[Any], Any], str]
CASES: tuple[Case, ...] = (
    ("class for a name", lambda the: ROS.Node(String), "name must be a string, got the class"),
    ("no name", lambda the: ROS.Node(), r"needs name; write Node\(name"),
    ("misspelled option", lambda the: ROS.Node("x", anonymus=True), "did you mean anonymous"),
    ("text for a logger", lambda the: ROS.Node("x", log="info"), "log must be a logging.Logger"),
    ("namespace", lambda the: ROS.Node("x", namespace=5), "name must be a string, got 5"),
    ("token", lambda the: ROS.Node("x", token=5), "argument token must be a string"),
    ("remapping", lambda the: ROS.Node("x", remapping={}), "names.Remapping"),
    ("swapped", lambda the: the.node.advertise(String, "t"), "string, got the class String"),
    ("no type", lambda the: the.node.advertise("t"), r"needs type; write advertise\(topic, type"),
    ("module", lambda the: the.node.advertise("t", fibws.msg.std_msgs), "such as std_msgs/Int32"),
    ("service", lambda the: the.node.advertise("t", AddTwoInts), "AddTwoInts is a service"),
    ("bare type", lambda the: the.node.advertise("t", "String"), "its package, too"),
    ("ROS 1 option", lambda the: the.node.advertise("t", String, latched=True), "mean latch?"),
    ("text", lambda the: the.node.advertise("t", String, queue_size="10"), "number of messages"),
    ("none", lambda the: the.node.advertise("t", String, queue_size=None), "number of messages"),
    ("callback", lambda the: the.node.subscribe("t", String, function), "by: async for"),
    ("callback", lambda the: the.node.subscribe("t", String, callback=function), "async for"),
    ("callback", lambda the: the.node.subscribe("t", function), "expected a message class"),
    ("bytes", lambda the: the.node.subscribe_serialized("t", 5), "take must be a function"),
    ("bytes", lambda the: the.node.advertise_serialized("t", String), "the name of a type"),
    ("seconds", lambda the: the.node.wait_for_message("t", String, 5), r"write .*timeout=\.\.\."),
    ("text", lambda the: the.node.wait_for_message("t", String, timeout="5"), "number of seconds"),
    ("no handler", lambda the: the.node.service("s", AddTwoInts), "needs handler"),
    ("result", lambda the: the.node.service("s", AddTwoInts, None), "must be a function"),
    (
        "swapped",
        lambda the: the.node.service("s", function, AddTwoInts),
        "such as std_srvs/Trigger",
    ),
    ("message", lambda the: the.node.service("s", Int32, function), "Int32 is a message"),
    ("fields", lambda the: the.node.call("s", AddTwoInts, a=1, b=2), r'one value, .*\{"a": 1\}'),
    ("values", lambda the: the.node.call("s", AddTwoInts, 1, 2), "one value"),
    ("list", lambda the: the.node.call("s", AddTwoInts, [1, 2]), "dict of its fields: a, b"),
    ("class", lambda the: the.node.call("s", AddTwoInts, AddTwoInts.Request), "write AddTwoInts"),
    ("text", lambda the: the.node.call("s", AddTwoInts, timeout="5"), "number of seconds"),
    ("seconds", lambda the: the.node.wait_for_service("s", 5), r"wait_for_service\(name, timeout"),
    ("no handler", lambda the: the.node.action_server("a", Fibonacci), "needs execute"),
    ("bare", lambda the: the.node.action_client("a", "Fibonacci"), "as in actionlib_tutorials"),
    ("fields", lambda the: the.client.send(order=5), r'one value, .*\{"order": 5\}'),
    ("value", lambda the: the.client.send(5), "dict of its fields: order"),
    ("seconds", lambda the: the.client.wait_for_server(5), r"wait_for_server\(timeout=\.\.\.\)"),
    ("class", lambda the: the.publisher.publish(String), r"got the class String: write String\(\)"),
    ("field", lambda the: the.publisher.publish(dat="x"), "did you mean data"),
    ("text", lambda the: the.publisher.set_will(data="x", timeout="5"), "number of seconds"),
    ("text", lambda the: the.node.rate("10"), r"a number \(hertz\), got '10'"),
    ("no rate", lambda the: the.node.rate(), r"needs hz; write rate\(hz\)"),
    ("sleep", lambda the: the.node.rate(10).sleep(), r"write async for _ in node\.rate"),
    ("values", lambda the: the.node.params.set(a=1), "known are name, value, timeout"),
    ("seconds", lambda the: the.node.params.get("a", 1, 5), r"get\(name, default=\.\.\., timeout"),
    ("number", lambda the: the.node.params.get(5), "name must be a string, got 5"),
    ("class", lambda the: the.node.graph.topics_of_type(String), "the name of a type, such as"),
    ("class", lambda the: the.node.graph.services_of_type(AddTwoInts), "the name of a type"),
    ("object", lambda the: the.node.graph.node(the.node), "name must be a string"),
    ("rospy", lambda the: the.subscription.unregister(), r"write subscription\.close\(\)"),
    ("constructor", lambda the: ROS.Publisher("t", String), r"Made by Node\.advertise"),
    ("constructor", lambda the: ROS.Subscription("t", String), r"Made by Node\.subscribe"),
    ("settings", lambda the: ROS.Hub(port=9090), r"Hub\(Settings\(port=9090\)\)"),
    ("settings", lambda the: ROS.Settings(9090), "named values, as in port=9090"),
)


class Things:
    """What wrong arguments are given to."""

    def __init__(self, node: fibws.Node, publisher: Any) -> None:
        self.node: Any = node
        self.publisher = publisher
        self.subscription: Any = node.subscribe("t", String)
        self.client: Any = node.action_client("a", Fibonacci)


async def test_wrong_arguments_are_explained(start_hub: StartHub) -> None:
    hub = await start_hub()
    async with fibws.Node("author", hub=hub.url) as node:
        the = Things(node, await node.advertise("t", String))
        for what, call, facts in CASES:
            with pytest.raises((TypeError, ValueError, AttributeError, FibwsError)) as caught:
                result = call(the)
                if inspect.isawaitable(result):
                    await result
            text = str(caught.value)
            assert re.search(facts, text) and not PYTHONS.search(text), (what, text)
