"""Attacks on a hub with tokens, each with its refusal.

The attackers are those who might try: a client without a token where anonymous clients may enter, a
client whose token allows little, and one whose token allows everything but to be an admin, so that
its victim is protected by what it is and not by a missing glob. Whatever they send, their victims
go on as before.
"""

from __future__ import annotations

import asyncio
import json
import logging
from collections.abc import AsyncIterator, Callable, Iterable
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any

import pytest
from conftest import Faults, StartHub
from patience import PATIENCE
from websockets.exceptions import InvalidStatus

from fibws.access.token_file import Tokens
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.nodes import ExternalNode
from fibws.hub.server import HubServer
from fibws.interfaces import Interfaces, Validators
from fibws.interfaces.serialization import Serializers
from fibws.protocol.serialized import publish_head

from .raw_client import until
from .token_clients import Client, World, closing, entering, entry

INT32 = "std_msgs/Int32"
ADD, EMPTY, LOG = "rospy_tutorials/AddTwoInts", "std_srvs/Empty", "rosgraph_msgs/Log"
FIBONACCI = "action_tutorials_interfaces/Fibonacci"
RIGHTS = ("publish", "subscribe", "call", "provide", "param_read", "param_write")
EVERYTHING = ", ".join(f'{right} = ["/**"]' for right in RIGHTS)
OWN = EVERYTHING.replace("/**", "/eve/**")
TOKENS = "\n".join(
    (
        entry("ann", f'allow = {{{EVERYTHING}, node = ["/ann*", "/ann/**"]}}'),
        entry("boss", "admin = true"),
        entry("eve", f"allow = {{{OWN}}}"),
        entry("rival", f"allow = {{{EVERYTHING}}}"),
        '[anonymous]\nallow = {subscribe = ["/map"]}',
    )
)


@pytest.fixture
async def hub(start_hub: StartHub, tmp_path: Path) -> HubServer:
    """A hub that needs tokens."""
    path = tmp_path / "tokens.toml"
    path.write_text(TOKENS, "utf-8")
    return await start_hub(tokens=path)


@pytest.fixture
async def world(hub: HubServer) -> AsyncIterator[World]:
    async with asyncio.timeout(PATIENCE), AsyncExitStack() as stack:
        yield World(hub, stack)


@pytest.fixture
async def ann(world: World) -> Client:
    """The victim, who may do everything but what is the operator's alone."""
    return await world.client("ann", "/ann")


FEW_RIGHTS: dict[str, str | None] = {"anonymous": None, "with few rights": "eve"}
ATTACKERS = {**FEW_RIGHTS, "with most rights": "rival"}
"""The tokens of the attackers."""


@pytest.fixture(params=[False, True], ids=["json", "fibws.v1"])
def serialized(request: pytest.FixtureRequest) -> bool:
    """Whether the attackers' connections are of ``fibws.v1``."""
    value: bool = request.param
    return value


@pytest.fixture(params=[*ATTACKERS.values()], ids=[*ATTACKERS])
async def attacker(request: pytest.FixtureRequest, world: World, serialized: bool) -> Client:
    """A client that attacks, of each kind."""
    return await world.client(request.param, serialized=serialized)


@pytest.fixture
async def eve(world: World, serialized: bool) -> Client:
    """A client that may do everything below ``/eve``, and nothing else."""
    return await world.client("eve", serialized=serialized)


@pytest.fixture
async def rival(world: World, serialized: bool) -> Client:
    """A client that may do everything but what is the operator's alone."""
    return await world.client("rival", serialized=serialized)


def is_refused(answers: list[dict[str, Any]], *facts: str) -> bool:
    """Return whether one operation was refused, and the reason holds some facts."""
    errors = [each["msg"] for each in answers if each["op"] == "status"]
    return len(answers) == len(errors) == 1 and all(fact in errors[0] for fact in facts)


# Names of nodes.


async def test_living_node_keeps_its_name(hub: HubServer, world: World, attacker: Client) -> None:
    """Chosen names, and those that the hub makes up: ``/client_1_...``."""
    chosen, unnamed = await world.client("ann", "/ann/move_base"), await world.client("ann")
    boss = await world.client("boss", "/boss")
    for victim in (chosen, unnamed, boss):
        for token in ATTACKERS.values():
            async with entering(hub, token, victim.name) as connection:
                code, reason = await closing(connection)
            assert code == 4403
            assert victim.name in reason
        assert await victim.is_alive()


@pytest.mark.parametrize("name", ["/rosapi", "rosapi", "/rosbridge_websocket"])
@pytest.mark.parametrize("token", [*ATTACKERS.values(), "boss"])
async def test_names_of_the_hubs_nodes_are_its_own(
    hub: HubServer, name: str, token: str | None
) -> None:
    with pytest.raises(InvalidStatus) as raised:
        async with entering(hub, token, name):
            pass
    assert raised.value.response.status_code == 400


@pytest.mark.parametrize("token", [*ATTACKERS.values(), "boss"])
async def test_rosout_is_the_hubs_if_there_are_tokens(hub: HubServer, token: str | None) -> None:
    async with entering(hub, token, "/rosout") as connection:
        assert (await closing(connection))[0] == 4403


async def test_name_that_is_kept_for_a_principal_is_not_taken(hub: HubServer) -> None:
    for token in ATTACKERS.values():
        async with entering(hub, token, "/annex") as connection:
            assert (await closing(connection))[0] == 4403


async def test_node_of_another_is_not_killed(world: World, ann: Client, attacker: Client) -> None:
    for victim in (ann, await world.client("ann"), await world.client("boss", "/boss")):
        # The attacker may see the node, or not.
        for topic in ("/map", "/eve/x"):
            await ann.does("advertise", topic=topic, type=INT32)
            response = await attacker.call("/rosapi/kill_node", node=victim.name)
            values = response["values"]
            assert not response["result"] or not values["success"], response
        assert await victim.is_alive()


@pytest.mark.parametrize("attack", ["name", "kill"])
async def test_anonymous_clients_do_not_end_each_other(
    hub: HubServer, world: World, attack: str
) -> None:
    victim, attacker = await world.client(None), await world.client(None)
    if attack == "name":
        async with entering(hub, None, victim.name):
            assert await victim.is_alive()
    else:
        await attacker.call("/rosapi/kill_node", node=victim.name)
        assert await victim.is_alive()


class SilentNode(ExternalNode):
    """A ROS 1 node that does not answer."""

    api, fault, since = "http://127.0.0.1:9/", "Connection refused", 0

    def __init__(self, graph: Graph) -> None:
        self._graph = graph

    def publishing(self) -> Iterable[str]:
        return "/map", "/eve/x"

    def subscribing(self) -> Iterable[str]:
        return ()

    providing = subscribing

    def replaced(self) -> None:
        raise AssertionError

    def ping(self, done: Callable[[str], object]) -> Callable[[], object]:
        raise AssertionError

    def shut_down(self, reason: str, done: Callable[[str], object]) -> Callable[[], object]:
        raise AssertionError

    def unregister(self) -> None:
        self._graph.leave(self, "/lidar")


async def test_ros1_node_is_unregistered_by_admins_alone(
    hub: HubServer, world: World, attacker: Client
) -> None:
    hub.graph.enter(SilentNode(hub.graph), "/lidar", Tokens({}, {}, None).networks["ros1"])
    response = await attacker.call("/rosapi/unregister_node", node="/lidar")
    assert not response["result"] or not response["values"]["success"], response
    assert "/lidar" in hub.graph.nodes
    boss = await world.client("boss", "/boss")
    response = await boss.call("/rosapi/unregister_node", node="/lidar")
    assert response["values"]["success"] and "/lidar" not in hub.graph.nodes


# Topics, services and actions of others.


@pytest.mark.parametrize("token", FEW_RIGHTS.values(), ids=FEW_RIGHTS)
async def test_without_a_right_nothing_is_used(
    world: World, ann: Client, token: str | None, serialized: bool
) -> None:
    attacker = await world.client(token, serialized=serialized)
    await ann.does("advertise", topic="/x", type=INT32)
    await ann.does("subscribe", topic="/x")
    await ann.does("advertise_service", service="/x", type=ADD)
    await ann.does("advertise_action", action="/x", type=FIBONACCI)
    for right, operation in (
        ("publish", {"op": "advertise", "topic": "/x", "type": INT32}),
        ("publish", {"op": "advertise", "topic": "x", "type": INT32}),
        ("publish", {"op": "publish", "topic": "/x", "msg": {"data": 1}}),
        ("publish", {"op": "publish", "topic": "/x", "msg": {"data": 1}, "to": "/ann"}),
        ("publish", {"op": "set_will", "topic": "/x", "msg": {"data": 1}}),
        ("publish", {"op": "set_will", "topic": "/x", "type": INT32, "timeout": 1}),
        ("subscribe", {"op": "subscribe", "topic": "/x"}),
        ("subscribe", {"op": "subscribe", "topic": "/x", "type": INT32, "peers": True}),
        ("provide", {"op": "advertise_service", "service": "/x", "type": ADD}),
        ("provide", {"op": "advertise_action", "action": "/x", "type": FIBONACCI}),
    ):
        await attacker.answers("unadvertise", topic="/x")  # So that the next refusal is reported.
        answers = await attacker.answers(**operation)
        errors = [each for each in answers if each["op"] == "status"]
        assert is_refused(errors, f"missing right {right} for /x"), (operation, answers)
    call = await attacker.call("/x", a=1, b=2)
    assert not call["result"]
    assert "missing right call for /x" in call["values"]
    goal = {"action": "/x", "action_type": FIBONACCI, "args": {}, "id": "g"}
    (result,) = await attacker.answers("send_action_goal", **goal)
    assert (result["op"], result["result"]) == ("action_result", False)
    assert await ann.answers("set_level", level="error") == []  # It has got nothing.


async def test_service_and_action_of_a_living_node_are_not_taken(
    hub: HubServer, ann: Client, rival: Client
) -> None:
    await ann.does("advertise_service", service="/x", type=ADD)
    await ann.does("advertise_action", action="/x", type=FIBONACCI)
    for op, fields in (
        ("advertise_service", {"service": "/x", "type": ADD}),
        ("advertise_service", {"service": "x", "type": EMPTY}),
        ("advertise_action", {"action": "/x", "type": FIBONACCI}),
        ("advertise_service", {"service": "/x/_action/cancel_goal", "type": EMPTY}),
    ):
        assert is_refused(await rival.answers(op, **fields)), op
    for op, fields in (
        ("unadvertise_service", {"service": "/x"}),
        ("unadvertise_action", {"action": "/x"}),
        ("unadvertise", {"topic": "/x"}),
    ):
        await rival.does(op, **fields)
    assert hub.graph.services["/x"].node == hub.graph.actions["/x"].node == "/ann"
    assert await ann.answers("set_level", level="error") == []


async def test_service_is_not_taken_by_the_one_that_cancels_goals(
    hub: HubServer, ann: Client, rival: Client
) -> None:
    name = "/x/_action/cancel_goal"
    await ann.does("advertise_service", service=name, type=EMPTY)
    await rival.answers("advertise_action", action="/x", type=FIBONACCI)
    assert hub.graph.services[name].node == "/ann"


async def test_services_of_the_hub_are_not_replaced(hub: HubServer, rival: Client) -> None:
    own = list(hub.graph.services)
    for service in own:
        answers = await rival.answers("advertise_service", service=service, type=EMPTY)
        assert is_refused(answers), service
    assert list(hub.graph.services) == own


@pytest.mark.parametrize("fields", [{}, {"definition": "int32 other"}, {"compression": "cbor-raw"}])
async def test_type_of_a_topic_is_not_fixed_by_a_subscriber(
    world: World, ann: Client, fields: dict[str, str]
) -> None:
    spy = await world.client(None)
    await spy.answers("subscribe", topic="/map", type="own_msgs/Wrong", **fields)
    assert is_refused(await spy.answers("advertise", topic="/map", type="own_msgs/Wrong"))
    await ann.does("advertise", topic="/map", type=INT32)
    type_ = world.hub.graph.topics["/map"].type
    assert type_ is not None
    assert type_.name == INT32


async def test_response_to_another_nodes_call_is_not_forged(
    world: World, ann: Client, attacker: Client
) -> None:
    await ann.does("advertise_service", service="/x", type=ADD)
    caller = await world.client("rival")
    await caller.send("call_service", service="/x", args={"a": 1, "b": 2}, id="sum")
    call = await ann.receive("call_service")
    guess = f"{call['id'][:-1]}{int(call['id'][-1]) + 1}"
    # Even the whole id is of no use to those who may not provide the service.
    for id_ in [guess] if attacker.token == "rival" else [guess, call["id"]]:
        await attacker.answers(
            "service_response", service="/x", id=id_, values={"sum": 0}, result=True
        )
        await attacker.answers("service_response", service="/x", id=id_, values=0, result=0)
    await ann.send("service_response", service="/x", id=call["id"], values={"sum": 3}, result=True)
    assert (await caller.receive("service_response"))["values"] == {"sum": 3}


async def test_goal_of_another_is_not_ended(world: World, ann: Client, attacker: Client) -> None:
    await ann.does("advertise_action", action="/x", type=FIBONACCI)
    caller = await world.client("ann")
    goal = {"action": "/x", "action_type": FIBONACCI, "args": {"order": 3}, "feedback": True}
    await caller.send("send_action_goal", id="g", **goal)
    id_ = (await ann.receive("send_action_goal"))["id"]
    service = "/x/_action/cancel_goal"
    response = await attacker.call(service, goal_info={})  # All goals.
    assert not response["result"] or response["values"]["goals_canceling"] == []
    uuid = {"uuid": [0] * 15 + [1]}
    await attacker.call(service, goal_info={"goal_id": uuid})
    for each in ("g", id_):
        await attacker.answers("cancel_action_goal", action="/x", id=each)
        await attacker.answers(
            "action_feedback", action="/x", id=each, values={"partial_sequence": [1]}
        )
        values = {"sequence": [6]}
        await attacker.answers(
            "action_result", action="/x", id=each, values=values, status=4, result=True
        )
    assert await ann.answers("set_level", level="error") == []  # Nothing is to be cancelled.
    values = {"sequence": [0, 1, 1]}
    await ann.send("action_result", action="/x", id=id_, values=values, status=4, result=True)
    result = json.loads(await caller.connection.recv())
    assert (result["op"], result["values"]) == ("action_result", values)


# In the name of another.


def log_line(name: str) -> bytes:
    """Return a log line of a node in ROS 1's serialization."""
    interfaces = Interfaces()
    values = Validators(interfaces, lambda: 0).of(LOG).validate({"name": name, "msg": "forged"})
    return bytes(Serializers(interfaces).of(LOG).serialize(values))


async def test_log_lines_have_the_name_of_their_node(
    world: World, ann: Client, attacker: Client, serialized: bool
) -> None:
    boss = await world.client("boss")
    await boss.does("subscribe", topic="/rosout", type=LOG)
    fields = {"publisher": 1} if serialized else {}
    await attacker.does("advertise", topic="/rosout", type=LOG, **fields)
    for name in ("/ann", "ann", "/rosbridge_websocket", "/rosapi", f"{attacker.name} ", "/"):
        answers = await attacker.answers("publish", topic="/rosout", msg={"name": name})
        assert is_refused(answers, "name"), name
        if serialized:
            await attacker.connection.send(publish_head(1) + log_line(name))
            assert is_refused(await attacker.answers("set_level", level="error"), "name"), name
    own = {"name": attacker.name, "msg": "own"}
    await attacker.does("publish", topic="/rosout", msg=own)
    lines = [(await boss.receive("publish"))["msg"]]
    while lines[-1]["msg"] != "own":
        lines.append((await boss.receive("publish"))["msg"])
    # The others are the hub's, which says what it has refused.
    assert {line["name"] for line in lines[:-1]} <= {"/rosbridge_websocket"}


@pytest.mark.parametrize("token", ATTACKERS.values(), ids=ATTACKERS)
async def test_will_on_rosout_has_the_name_of_its_node(
    hub: HubServer, world: World, token: str | None, faults: Faults
) -> None:
    boss = await world.client("boss")
    await boss.does("subscribe", topic="/rosout", type=LOG)
    async with entering(hub, token) as connection:
        (node,) = hub.graph.nodes.keys() - {boss.name, *hub.graph.rights.internal}
        attacker = Client(connection, node, token)
        forged = {"name": "/ann", "msg": "forged"}
        await attacker.answers("set_will", topic="/rosout", type=LOG, msg=forged)
    await until(lambda: node not in hub.graph.nodes)
    lines = await boss.answers("set_level", level="error")
    assert "/ann" not in [line["msg"]["name"] for line in lines]
    faults.expect("will cannot be published")


@pytest.mark.parametrize("topic", ["/client_count", "/connected_clients", "/rosout_agg"])
@pytest.mark.parametrize("token", [*ATTACKERS.values(), "boss"])
async def test_topics_of_the_hub_are_published_by_it_alone(
    hub: HubServer, world: World, topic: str, token: str | None
) -> None:
    client, type_ = await world.client(token), hub.graph.topics[topic].type
    assert type_ is not None
    before = list(hub.graph.topics[topic].sources)
    assert is_refused(await client.answers("advertise", topic=topic, type=type_.name))
    assert is_refused(await client.answers("advertise", topic=topic, type="own_msgs/Other"))
    assert is_refused(await client.answers("publish", topic=topic, msg={}))
    assert is_refused(await client.answers("set_will", topic=topic, type=type_.name))
    assert list(hub.graph.topics[topic].sources) == before


async def test_caller_of_a_service_is_not_forged(ann: Client, rival: Client) -> None:
    await ann.does("advertise_service", service="/x", type=EMPTY, headers=True)
    await rival.send("call_service", service="/x", headers={"callerid": "/boss", "a": "b"})
    header = (await ann.receive("call_service"))["header"]
    assert header == {"callerid": rival.name, "a": "b"}


async def test_publisher_of_a_message_is_not_forged(ann: Client, rival: Client) -> None:
    await ann.does("subscribe", topic="/x", type=INT32, headers=True)
    headers = {"callerid": "/boss", "a": "b"}
    await rival.does("advertise", topic="/x", type=INT32, headers=headers)
    await rival.does("publish", topic="/x", msg={"data": 1})
    header = (await ann.receive("publish"))["header"]
    assert (header["callerid"], header["a"]) == (rival.name, "b")


# The log.


async def test_log_is_not_silenced(
    ann: Client, attacker: Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    logger = logging.getLogger("fibws.hub")
    level = logger.level
    monkeypatch.setattr(logger, "level", level)  # Whatever happens, it is so again afterwards.
    await ann.does(
        "advertise_service", service="/ann/set_logger_level", type="roscpp/SetLoggerLevel"
    )
    for service in (
        *("/rosapi/set_logger_level", "/rosout/set_logger_level", "rosapi/set_logger_level"),
        *("/rosbridge_websocket/set_logger_level", "~set_logger_level"),
        "/ann/set_logger_level",
    ):
        for name in ("rosout", "fibws.hub"):
            response = await attacker.call(service, logger=name, level="fatal")
            assert not response["result"], service
            assert "missing right call" in response["values"]
    assert logger.level == level
    assert await ann.answers("set_level", level="error") == []


# Parameters and types.


async def test_parameters_of_others_are_not_touched(
    hub: HubServer, ann: Client, eve: Client
) -> None:
    await ann.values("/rosapi/set_param", name="/ann/x", value="1")
    await ann.values("/rosapi/set_param", name="/eve/x", value="1")
    before = hub.graph.parameters.text("/")
    for name, value in (
        *(("/ann/x", "2"), ("/ann", "{}"), ("/", "{}"), ("/", '{"ann": 1}')),
        *(("/evening", "1"), ("/ann/x/y", "1"), ("//ann//x", "2")),
        *(("/", '{"eve": {"x": 2}}'), ("/", '{"/ann/x": 1}'), ("/run_id", '"x"')),
        *(("/use_sim_time", "true"), ("ann/x", "2"), ("", "{}")),
    ):
        response = await eve.call("/rosapi/set_param", name=name, value=value)
        assert not response["result"], (name, response)
    for name in ("/ann/x", "/ann", "/", "//ann/", "ann", "/run_id"):
        response = await eve.call("/rosapi/delete_param", name=name)
        assert not response["result"], (name, response)
    assert hub.graph.parameters.text("/") == before
    assert (await eve.values("/rosapi/get_param", name="/"))["value"].count("x") == 1


async def test_keys_of_a_value_are_no_way_to_parameters_of_others(
    hub: HubServer, ann: Client, eve: Client
) -> None:
    await ann.values("/rosapi/set_param", name="/ann/x", value="1")
    before = hub.graph.parameters.text("/ann")
    for value in ('{"/ann/x": 2}', '{"../ann": {"x": 2}}', '{"x/../../ann": 2}'):
        await eve.values("/rosapi/set_param", name="/eve/y", value=value)
        assert json.loads(hub.graph.parameters.text("/eve/y")) == json.loads(value)
    assert hub.graph.parameters.text("/ann") == before


async def test_parameter_is_not_set_in_place_of_those_below_it(ann: Client, eve: Client) -> None:
    await ann.values("/rosapi/set_param", name="/eve/x", value="1")
    assert not (await eve.call("/rosapi/set_param", name="/eve", value="1"))["result"]


@pytest.mark.parametrize("token", FEW_RIGHTS.values(), ids=FEW_RIGHTS)
async def test_parameters_and_types_are_not_filled(
    hub: HubServer, world: World, token: str | None, serialized: bool
) -> None:
    attacker = await world.client(token, serialized=serialized)
    parameters, types = hub.graph.parameters.text("/"), len(hub.graph._types._brought)
    value = json.dumps("x" * 2**20)
    for number in range(5):
        response = await attacker.call("/rosapi/set_param", name=f"/x{number}", value=value)
        assert not response["result"]
        definition = {"type": f"own_msgs/T{number}", "definition": "int32 data"}
        await attacker.answers("advertise", topic="/x", **definition)
        await attacker.answers("subscribe", topic="/x", **definition)
        definition["definition"] = "---"
        await attacker.answers("advertise_service", service="/x", **definition)
        definition["definition"] = "---\n---"
        await attacker.answers("advertise_action", action="/x", **definition)
    assert hub.graph.parameters.text("/") == parameters
    assert len(hub.graph._types._brought) == types


# What may not be seen.
async def test_addresses_of_others_are_published_for_admins_only(rival: Client) -> None:
    (status,) = await rival.answers("subscribe", topic="/connected_clients")
    assert "missing right subscribe for /connected_clients" in status["msg"]


async def test_nothing_of_others_is_seen(ann: Client, eve: Client) -> None:
    await ann.does("advertise", topic="/hidden_topic", type=INT32)
    await ann.does("subscribe", topic="/hidden_heard", type=INT32)
    await ann.does("advertise_service", service="/hidden_service", type=ADD)
    await ann.does("advertise_action", action="/hidden_action", type=FIBONACCI)
    await ann.values("/rosapi/set_param", name="/hidden_parameter", value="1")
    for service in (
        *("topics", "topics_and_raw_types", "services", "nodes", "action_servers", "graph"),
        *("statistics", "get_param_names"),
    ):
        values = json.dumps(await eve.values(f"/rosapi/{service}"))
        assert "hidden" not in values, service
        assert '"/ann' not in values, service
    assert "hidden" not in (await eve.values("/rosapi/get_param", name="/"))["value"]


@pytest.mark.parametrize("token", FEW_RIGHTS.values(), ids=FEW_RIGHTS)
async def test_nodes_are_not_seen_by_their_log_services(
    world: World, ann: Client, token: str | None
) -> None:
    """Every node of ROS has them."""
    spy = await world.client(token)
    await ann.does("advertise_service", service="/ann/get_loggers", type="roscpp/GetLoggers")
    for service in ("nodes", "services", "graph"):
        assert '"/ann' not in json.dumps(await spy.values(f"/rosapi/{service}")), service


def _id(operation: dict[str, Any]) -> str:
    return " ".join(str(each) for each in operation.values())


OPERATIONS: list[dict[str, Any]] = [
    {"op": "advertise", "topic": "/NAME", "type": INT32},
    {"op": "advertise", "topic": "/NAME", "type": "std_msgs/String"},
    {"op": "publish", "topic": "/NAME", "msg": {"data": 1}},
    {"op": "publish", "topic": "/NAME", "msg": 1},
    {"op": "set_will", "topic": "/NAME"},
    {"op": "unadvertise", "topic": "/NAME"},
    {"op": "set_will", "topic": "/NAME", "type": INT32},
    {"op": "clear_will", "topic": "/NAME"},
    {"op": "subscribe", "topic": "/NAME"},
    {"op": "subscribe", "topic": "/NAME", "type": "std_msgs/String"},
    {"op": "subscribe", "topic": "/NAME", "compression": "cbor-raw", "peers": True},
    {"op": "unsubscribe", "topic": "/NAME"},
    {"op": "acknowledge", "topic": "/NAME"},
    {"op": "call_service", "service": "/NAME", "args": {"a": "x"}},
    {"op": "call_service", "service": "/NAME", "args": [1, 2], "headers": {}},
    {"op": "call_service", "service": "/NAME/_action/cancel_goal"},
    {"op": "call_service", "service": "/NAME/set_logger_level"},
    {"op": "call_service", "service": "/NAME/get_loggers"},
    {"op": "advertise_service", "service": "/NAME", "type": ADD},
    {"op": "unadvertise_service", "service": "/NAME"},
    {"op": "service_response", "service": "/NAME", "id": "x", "result": True},
    {"op": "send_action_goal", "action": "/NAME", "action_type": FIBONACCI, "id": "g"},
    {"op": "send_action_goal", "action": "/NAME", "action_type": ADD, "id": "g"},
    {"op": "cancel_action_goal", "action": "/NAME", "id": "g"},
    {"op": "advertise_action", "action": "/NAME", "type": FIBONACCI},
    {"op": "unadvertise_action", "action": "/NAME"},
    *(
        {"op": "call_service", "service": f"/rosapi/{service}", "args": {key: "/NAME"}}
        for service, key in (
            *(("topic_type", "topic"), ("publishers", "topic"), ("subscribers", "topic")),
            *(("service_type", "service"), ("service_node", "service")),
            *(("service_host", "service"), ("service_providers", "service")),
            *(("node_details", "node"), ("ping_node", "node"), ("kill_node", "node")),
            ("unregister_node", "node"),
            *(("get_param", "name"), ("has_param", "name"), ("delete_param", "name")),
            *(("search_param", "name"), ("set_param", "name")),
        )
    ),
]
"""Operations on a name that may be that of a topic, a service, an action, a node or a parameter."""


@pytest.mark.parametrize("operation", OPERATIONS, ids=_id)
async def test_what_is_hidden_looks_missing(
    world: World, ann: Client, operation: dict[str, Any]
) -> None:
    await ann.does("advertise", topic="/h1dden", type=INT32)
    await ann.does("advertise_service", service="/h1dden", type=ADD)
    await ann.does("advertise_service", service="/h1dden/get_loggers", type="roscpp/GetLoggers")
    await ann.does("advertise_service", service="/h1dden/set_logger_level", type=EMPTY)
    await ann.does("advertise_action", action="/h1dden", type=FIBONACCI)
    await ann.values("/rosapi/set_param", name="/h1dden", value="1")
    await world.client("boss", "/h1dden")
    spy, text = await world.client("eve"), json.dumps(operation)
    hidden, missing = [
        json.dumps(await spy.answers(**json.loads(text.replace("NAME", name)))).replace(
            name, "NAME"
        )
        for name in ("h1dden", "m1ssing")
    ]
    assert hidden == missing
