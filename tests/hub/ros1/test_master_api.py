"""The Master API and the parameter server, call by call beside ROS's own rosmaster.

One difference is left out: a topic keeps its type while it is used, and rosmaster reports the type
of the newest publisher.
"""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from datetime import datetime
from pathlib import Path
from typing import Any

from recorded_answers import Answers, shortened
from ros_masters import roscore

from fibws.hub import Settings
from fibws.hub.server import HubServer

from .peer import Peer, request

A, B = "<api of a>", "<api of b>"
"""In calls and answers, the URIs of the two nodes."""
INT32, STRING = "std_msgs/Int32", "std_msgs/String"
LONG = "x" * 100_000
DATE = datetime(2020, 2, 29, 12, 34, 56)
TREE = {"gains": {"p": 1.5, "i": 0, "d": -3}, "names": ["a", "ä", "<&>"], "empty": {}, "on": True}

KEYS = (
    "/t /t/ /t/int /t/tree/gains /t/tree/gains/p /t/none /t/int/below t/int ~private /a/private "
    "/t//tree//names /t/tree/empty"
).split(" ")

CALLS: list[tuple[Any, ...]] = [
    # Topics.
    ("a", "registerPublisher", "/t/one", INT32, A),
    ("b", "registerSubscriber", "/t/one", INT32, B),
    ("b", "registerSubscriber", "/t/one", INT32, B),
    ("b", "registerSubscriber", "/t/any", "*", B),
    ("a", "registerPublisher", "/t/any", STRING, A),
    ("a", "registerPublisher", "/t/any", "*", A),
    ("a", "registerPublisher", "t/relative", INT32, A),
    ("a", "registerPublisher", "~private", INT32, A),
    ("b", "registerSubscriber", "/t/unknown", "my_msgs/Unknown", B),
    ("a", "registerPublisher", "/t/unknown", "my_msgs/Unknown", A),
    ("a", "getPublishedTopics", ""),
    ("a", "getPublishedTopics", "/"),
    ("a", "getPublishedTopics", "/t"),
    ("a", "getPublishedTopics", "t"),
    ("a", "getPublishedTopics", "/none"),
    ("a", "getTopicTypes"),
    ("a", "getSystemState"),
    ("a", "unregisterPublisher", "/t/one", B),
    ("b", "unregisterPublisher", "/t/one", B),
    ("a", "unregisterPublisher", "/t/one", A),
    ("a", "unregisterPublisher", "/t/one", A),
    ("a", "unregisterPublisher", "/t/never", A),
    ("b", "unregisterSubscriber", "/t/never", B),
    ("b", "unregisterSubscriber", "/t/one", A),
    ("b", "unregisterSubscriber", "/t/one", B),
    ("b", "unregisterSubscriber", "/t/one", B),
    ("c", "unregisterSubscriber", "/t/any", B),
    # Services.
    ("a", "registerService", "/t/add", "rosrpc://127.0.0.1:9", A),
    ("a", "lookupService", "/t/add"),
    ("a", "lookupService", "t/add"),
    ("a", "lookupService", "/t/none"),
    ("b", "registerService", "/t/add", "rosrpc://127.0.0.1:8", B),
    ("a", "lookupService", "/t/add"),
    ("a", "unregisterService", "/t/add", "rosrpc://127.0.0.1:9"),
    ("b", "unregisterService", "/t/none", "rosrpc://127.0.0.1:9"),
    ("a", "registerService", "/t/invalid", "http://127.0.0.1:9", A),
    ("a", "getSystemState"),
    ("b", "unregisterService", "/t/add", "rosrpc://127.0.0.1:8"),
    ("b", "unregisterService", "/t/add", "rosrpc://127.0.0.1:8"),
    # Nodes.
    ("a", "lookupNode", "/a"),
    ("a", "lookupNode", "b"),
    ("a", "lookupNode", "/none"),
    # Parameters.
    ("a", "setParam", "/t/int", 5),
    ("a", "setParam", "/t/negative", -(2**31)),
    ("a", "setParam", "/t/float", 0.1),
    ("a", "setParam", "/t/bool", True),
    ("a", "setParam", "/t/text", "ä <&> \n 'x' \"y\""),
    ("a", "setParam", "/t/empty", ""),
    ("a", "setParam", "/t/long", LONG),
    ("a", "setParam", "/t/list", [1, "two", 3.5, [False], []]),
    ("a", "setParam", "/t/binary", b"\x00\xff"),
    ("a", "setParam", "/t/date", DATE),
    ("a", "setParam", "/t/tree", TREE),
    ("a", "setParam", "t/relative", 1),
    ("a", "setParam", "~private", 2),
    ("a", "setParam", "/t/", 3),
    *(("a", "getParam", f"/t{key}") for key in ("", "/", "/int")),
    ("a", "setParam", "/t", {"int": 5, "tree": TREE, "text": "ä <&>", "deep": {"er": {"est": 1}}}),
    *(("b", "getParam", key) for key in KEYS),
    *(("a", "hasParam", key) for key in ("/t", "/t/int", "/t/none", "~private", "t/int")),
    ("a", "getParamNames"),
    ("a", "searchParam", "int"),
    ("a", "searchParam", "private"),
    ("a", "searchParam", "/t/int"),
    ("a", "searchParam", "t/int"),
    ("a", "searchParam", "t/int/below"),
    ("a", "searchParam", "none"),
    ("/t/tree/node", "searchParam", "int"),
    ("/t/tree/node", "searchParam", "gains/p"),
    ("/t/tree/node", "getParam", "gains"),
    ("/t/tree/node", "getParam", "~gains"),
    ("a", "setParam", "/t/tree", 1),
    ("a", "getParam", "/t/tree/gains"),
    ("a", "setParam", "/t/tree/new", 2),
    ("a", "getParam", "/t/tree"),
    ("a", "deleteParam", "/t/int"),
    ("a", "deleteParam", "/t/int"),
    ("a", "deleteParam", "/t/deep/er"),
    ("a", "getParam", "/t/deep"),
    ("a", "deleteParam", "~private"),
    # Subscriptions to parameters.
    ("b", "subscribeParam", B, "/t/watched"),
    ("b", "subscribeParam", B, "/t/deep"),
    ("a", "setParam", "/t/watched", 1),
    ("b", "setParam", "/t/watched", 2),
    ("a", "setParam", "/t/deep/er/est", 7),
    ("a", "setParam", "/t/deep", {"other": "x"}),
    ("a", "deleteParam", "/t/watched"),
    ("b", "unsubscribeParam", B, "/t/watched"),
    ("b", "unsubscribeParam", B, "/t/watched"),
    ("b", "unsubscribeParam", B, "/t/never"),
    ("b", "unsubscribeParam", A, "/t/deep"),
    ("a", "setParam", "/t/watched", 3),
    # Several at once.
    (
        None,
        "system.multicall",
        [
            {"methodName": "setParam", "params": ["/a", "/t/multi", 1]},
            {"methodName": "getParam", "params": ["/a", "/t/multi"]},
            {"methodName": "getParam", "params": ["/a", "/t/none"]},
            {"methodName": "getParam", "params": ["/a"]},
        ],
    ),
    (None, "system.multicall", []),
    # Invalid arguments.
    (None, "getParam"),
    (None, "getParam", 1, "/t/int"),
    (None, "getParam", "", "/t/int"),
    ("a", "getParam"),
    ("a", "getParam", "/t/int", "more"),
    ("a", "getParam", 5),
    ("a", "setParam", "", 5),
    ("a", "registerPublisher", "", INT32, A),
    ("a", "registerPublisher", 5, INT32, A),
    ("a", "registerPublisher", "/t/a b", INT32, A),
    ("a", "registerPublisher", "/t/a:b", INT32, A),
    ("a", "registerPublisher", "/", INT32, A),
    ("a", "registerPublisher", "/t/x", "", A),
    ("a", "registerPublisher", "/t/x", "Int32", A),
    ("a", "registerPublisher", "/t/x", "a/b/c", A),
    ("a", "registerPublisher", "/t/x", INT32, ""),
    ("a", "registerPublisher", "/t/x", INT32, "ftp://x"),
    ("a", "registerPublisher", "/t/x", INT32, 5),
    ("a", "registerSubscriber", "/t/x", INT32),
    ("a", "registerService", "", "rosrpc://x:1", A),
    ("a", "registerService", "/t/s", "", A),
    ("a", "unregisterService", "/t/s", 5),
    ("a", "lookupService", ""),
    ("a", "lookupNode", ""),
    ("a", "getPublishedTopics"),
    ("a", "hasParam", ""),
    ("a", "searchParam", ""),
    ("a", "subscribeParam", "", "/t/int"),
    ("a", "subscribeParam", A, ""),
    ("a", "noSuchMethod"),
    ("a", "getUri"),
]


class Node(Peer):
    """A node that records what it is told."""

    async def told(self) -> dict[str, Any]:
        """Return the last publishers of each topic, and all other calls, up to the present."""
        last, found = f"/last{self.name}", dict[str, Any]()
        await self.subscribe(last)
        await self.advertise(last)
        async with asyncio.timeout(60):
            while True:
                match await self.calls.get():
                    case ("publisherUpdate", [topic, [*_, _]]) if topic == last:
                        return found
                    case ("publisherUpdate", [topic, apis]):
                        found[topic] = sorted(apis)
                    case (method, params):
                        found.setdefault(method, []).append(params)


@asynccontextmanager
async def hub() -> AsyncIterator[str]:
    async with HubServer(Settings(port=0, ros1=0, ros1_host="127.0.0.1")) as hub:
        assert hub.ros1 is not None
        yield hub.ros1.uri


async def play(master: str) -> dict[str, Any]:
    """Make all calls; return the answers, and what each node was told."""
    async with Node("/a", master) as a, Node("/b", master) as b:
        apis = {A: a.api, B: b.api}
        names = {a.api: A, b.api: B, master: "<master>"}
        answers = []
        for caller, method, *params in CALLS:
            caller_id = [] if caller is None else [caller if caller[0] == "/" else f"/{caller}"]
            given = [apis.get(each, each) if isinstance(each, str) else each for each in params]
            try:
                answer = await request(master, method, *caller_id, *given)
            except Exception as error:
                answer = type(error).__name__
            answers.append(normal(answer, names))
        return {
            "answers": answers,
            "a": normal(await a.told(), names),
            "b": normal(await b.told(), names),
        }


def normal(value: Any, names: dict[str, str]) -> Any:
    """Return a value without what differs between any two masters, lists of the graph sorted."""
    match value:
        case list() if value and all(isinstance(each, list) and len(each) == 2 for each in value):
            kept = [each for each in value if str(each[0]).startswith(("/t", "/a"))]
            return sorted(([name, normal(of, names)] for name, of in kept), key=repr)
        case list() if value and all(isinstance(each, str) and each[:1] == "/" for each in value):
            return sorted(each for each in value if each.startswith(("/t", "/a", "/b")))
        case list():
            return [normal(each, names) for each in value]
        case dict():
            return {key: normal(each, names) for key, each in value.items()}
        case str():
            for uri, name in names.items():
                value = value.replace(uri, name)
            return shortened(value)
        case datetime():
            return str(value)
    return value


async def test_answers_are_those_of_rosmaster(answers: Answers, tmp_path: Path) -> None:
    async def ask() -> dict[str, Any]:
        with roscore(tmp_path) as environment:
            return await play(environment["ROS_MASTER_URI"])

    expected = await answers.once("all calls", ask)
    async with hub() as ours:
        found = await play(ours)
    faults = [
        f"{str(call)[:200]}: expected {str(wanted)[:500]}, got {str(got)[:500]}"
        for call, wanted, got in zip(CALLS, expected["answers"], found["answers"], strict=True)
        if wanted != got
    ]
    assert not faults, "\n".join(faults)
    assert (found["a"], found["b"]) == (expected["a"], expected["b"])
    assert {"paramUpdate", "/t/one"} <= found["b"].keys()
