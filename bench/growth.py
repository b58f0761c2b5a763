"""CPU of the hub per operation while what it holds doubles three times: none may grow with it."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any

from bench.client import Client, connect_all, operation
from bench.machine import on_load_cpu
from bench.measure import BenchError, Plan
from bench.report import Report
from bench.servers import Server, running

FIRST, QUICK_FIRST = 250, 25
"""The smallest number of clients, topics, and so on; the others are its doubles."""
DOUBLINGS = 3
LIMIT_GROWTH = 2.0
"""Of the cost per operation, from the smallest number to the largest, which is eight times that."""
NOISE_US = 0.5
"""Least cost to compare with."""
WARM_UP = 10
MOST_REPS = 3
IDS_OPERATION = "subscribe to one topic again"
"""It may grow, as the ids are few, and has no limit."""
MESSAGES, DELIVERIES = 500, 40_000
TIMEOUTS_PER_SECOND = 2000
WATCHERS_SHARE = 5
"""Fewer nodes watch each other: there are as many reports as pairs of them."""
NODES, QUICK_NODES = 400, 50
NODE = "fleet/robot_state_publisher"
LIMIT_TRAFFIC_MB = 20.0
IDS = 12
"""The smallest number of subscriptions of one client to one topic, of which it may have 100."""
OPTIONS = [f"--max-{what}=100000" for what in ("advertisements", "subscriptions", "calls", "goals")]
TYPE, SERVICE_TYPE, ACTION_TYPE = "std_msgs/Int32", "std_srvs/Empty", "example_interfaces/Fibonacci"
TOPIC, SERVICE, ACTION = "/bench/topic", "/bench/service", "/bench/action"


class Meter:
    """Measures the hub's CPU time per operation, and connects clients to it.

    Args:
        n: how much of something the hub is to hold.
        times: that in multiples of the smallest number.
        costs: gets the µs per operation, by its name.
    """

    def __init__(self, server: Server, n: int, times: int, costs: dict[str, float]) -> None:
        self.n = n
        self.times = times
        self._server = server
        self._costs = costs
        self._witness = Client(server.port, "/witness")

    @contextmanager
    def measured(self, what: str, count: int | None = None) -> Iterator[None]:
        """Measure the block, which performs the operation ``count`` times, else ``n`` times."""
        before = self._server.cpu_seconds
        yield
        used = self._server.cpu_seconds - before
        self._costs[what] = used / (self.n if count is None else count) * 1e6

    @contextmanager
    def client(self, name: str) -> Iterator[Client]:
        """Connect a client, and wait at the end until the hub has removed it."""
        with self.clients(1, name) as (client,):
            yield client

    @contextmanager
    def clients(self, count: int, name: str) -> Iterator[list[Client]]:
        """Connect several clients, named after ``name`` and a number, as `client`."""
        with connect_all(self._server.port, count, name) as clients:
            yield clients
        self.settle()

    def settle(self) -> None:
        """Wait until the hub has processed what all clients have done, ends of connections too."""
        for _ in range(3):  # It may read from this client first.
            self._witness.settle()

    def close(self) -> None:
        """Check that the hub holds nothing any more, and disconnect."""
        self._witness.send(operation("call_service", service="/rosapi/nodes"))
        nodes = set(json.loads(self._witness.receive()[0])["values"]["nodes"])
        if left := nodes - {"/witness", "/rosapi", "/rosbridge_websocket", "/rosout"}:
            raise BenchError(f"the hub still has {len(left)} nodes, such as {left.pop()}")
        self._witness.close()


def perform(client: Client, op: str, each: Iterable[dict[str, Any]], **common: Any) -> list[bytes]:
    """Perform an operation for each of some fields; return the messages that arrive meanwhile."""
    client.send(b"".join(operation(op, **common, **fields) for fields in each))
    return client.settle()


def named(field: str, name: str, n: int) -> list[dict[str, Any]]:
    """Return fields that name ``n`` different topics or the like."""
    return [{field: f"{name}_{number}"} for number in range(n)]


def idle_clients(meter: Meter) -> None:
    """Connect clients that do nothing, and send messages beside them."""
    with meter.client("pair") as pair, ExitStack() as stack:
        perform(pair, "advertise", [{"topic": TOPIC}], type=TYPE)
        perform(pair, "subscribe", [{"topic": TOPIC}])
        with meter.measured("connect a client"):
            clients = stack.enter_context(meter.clients(meter.n, "idle"))
        with meter.measured("message beside idle clients", MESSAGES):
            perform(pair, "publish", [{"topic": TOPIC}] * MESSAGES, msg={"data": 1})
        with meter.measured("disconnect a client"):
            for client in clients:
                client.close()
            meter.settle()


def topics(meter: Meter) -> None:
    """Have one client publish many topics, and another one subscribe to them."""
    each = named("topic", TOPIC, meter.n)
    with meter.client("talker") as talker, meter.client("listener") as listener:
        with meter.measured("advertise one of many topics"):
            perform(talker, "advertise", each, type=TYPE)
        with meter.measured("subscribe to one of many topics"):
            perform(listener, "subscribe", each)
        with meter.measured("message of one of many topics"):
            perform(talker, "publish", each, msg={"data": 1})
            listener.settle()
        with meter.measured("unsubscribe from one of many topics"):
            perform(listener, "unsubscribe", each)
        with meter.measured("unadvertise one of many topics"):
            perform(talker, "unadvertise", each)
        perform(talker, "advertise", each, type=TYPE)
        perform(listener, "subscribe", each)
        with meter.measured("disconnect: of each topic"):
            talker.close()
            listener.close()
            meter.settle()


def pending_publishes(meter: Meter) -> None:
    """Publish on topics before they are advertised, as roslibpy does after a reconnection."""
    each = named("topic", TOPIC, meter.n)
    with meter.client("talker") as talker, meter.measured("publish early, then advertise"):
        talker.send(b"".join(operation("publish", msg={"data": 1}, **topic) for topic in each))
        perform(talker, "advertise", each, type=TYPE)


def subscribers(meter: Meter) -> None:
    """Have many clients subscribe to one topic."""
    _subscribers(meter, "subscriber", lambda number: {})


def encodings(meter: Meter) -> None:
    """Have many clients subscribe to one topic, each in another encoding."""
    _subscribers(meter, "encoding", lambda number: {"fragment_size": 1000 + number})


def _subscribers(meter: Meter, what: str, fields: Callable[[int], dict[str, Any]]) -> None:
    frames = [operation("subscribe", topic=TOPIC, **fields(number)) for number in range(meter.n)]
    with meter.client("talker") as talker, meter.clients(meter.n, "listener") as listeners:
        perform(talker, "advertise", [{"topic": TOPIC}], type=TYPE)
        with meter.measured(f"subscribe as one {what} of many"):
            _each(listeners, frames)
            meter.settle()
        messages = DELIVERIES // meter.n
        with meter.measured(f"message to one {what} of many", messages * meter.n):
            perform(talker, "publish", [{"topic": TOPIC}] * messages, msg={"data": 1})
        for listener in listeners:
            listener.settle()
        with meter.measured(f"unsubscribe one {what} of many"):
            _each(listeners, [operation("unsubscribe", topic=TOPIC)] * meter.n)
            meter.settle()


def _each(clients: Sequence[Client], frames: Sequence[bytes]) -> None:
    for client, frame in zip(clients, frames, strict=True):
        client.send(frame)


def ids(meter: Meter) -> None:
    """Have one client subscribe to one topic many times; the number is limited."""
    n = IDS * meter.times
    each = [{"id": str(number)} for number in range(n)]
    with meter.client("listener") as listener:
        perform(listener, "advertise", [{"topic": TOPIC}], type=TYPE)
        with meter.measured(IDS_OPERATION, 20 * n):
            for _ in range(20):
                perform(listener, "subscribe", each, topic=TOPIC)
        with meter.measured("message to one of many ids", MESSAGES):
            perform(listener, "publish", [{"topic": TOPIC}] * MESSAGES, msg={"data": 1})


def publishers(meter: Meter) -> None:
    """Have many clients publish one topic."""
    with meter.client("listener") as listener, meter.clients(meter.n, "talker") as talkers:
        perform(listener, "subscribe", [{"topic": TOPIC}])
        for what, op, fields in (
            ("advertise as one publisher of many", "advertise", {"type": TYPE}),
            ("message of one publisher of many", "publish", {"msg": {"data": 1}}),
            ("unadvertise as one publisher of many", "unadvertise", {}),
        ):
            with meter.measured(what):
                _each(talkers, [operation(op, topic=TOPIC, **fields)] * meter.n)
                meter.settle()


def calls(meter: Meter) -> None:
    """Let calls wait for their responses, each with its own timeout."""
    n = meter.n
    timeouts = [{"timeout": 60 + number % 977} for number in range(n)]
    with meter.client("server") as server, meter.client("caller") as caller:
        perform(server, "advertise_service", [{"service": SERVICE}], type=SERVICE_TYPE)
        perform(server, "advertise_service", [{"service": "/bench/other"}], type=SERVICE_TYPE)
        with meter.measured("call, while many calls wait"):
            perform(caller, "call_service", timeouts, service=SERVICE)
        requests = server.settle()
        with meter.measured("respond, while many calls wait"):
            answers = [{"id": json.loads(text)["id"]} for text in reversed(requests)]
            perform(server, "service_response", answers, service=SERVICE, result=True)
            caller.settle()
        perform(caller, "call_service", [{}] * n, service=SERVICE)
        perform(caller, "call_service", [{}] * n, service="/bench/other")
        server.settle()
        with meter.measured("respond without an id, while many calls wait"):
            perform(server, "service_response", [{}] * n, service="/bench/other", result=True)
            caller.settle()
        others = named("service", "/bench/unused", n)
        perform(server, "advertise_service", others, type=SERVICE_TYPE)
        with meter.measured("unadvertise a service, while many calls wait"):
            perform(server, "unadvertise_service", others)
        perform(server, "unadvertise_service", [{"service": SERVICE}])
        caller.settle()


def timeouts(meter: Meter) -> None:
    """Let calls time out one after the other."""
    each = [{"timeout": 0.1 + number / TIMEOUTS_PER_SECOND} for number in range(meter.n)]
    with meter.client("server") as server, meter.client("caller") as caller:
        perform(server, "advertise_service", [{"service": SERVICE}], type=SERVICE_TYPE)
        with meter.measured("call that times out"):
            failed = len(perform(caller, "call_service", each, service=SERVICE))
            while failed < meter.n:
                failed += len(caller.receive())


def services(meter: Meter) -> None:
    """Have one client serve many services."""
    each = named("service", SERVICE, meter.n)
    with meter.client("server") as server:
        with meter.measured("advertise one of many services"):
            perform(server, "advertise_service", each, type=SERVICE_TYPE)
        with meter.measured("unadvertise one of many services"):
            perform(server, "unadvertise_service", each)
        perform(server, "advertise_service", each, type=SERVICE_TYPE)
        with meter.measured("disconnect: of each service"):
            server.close()
            meter.settle()


def goals(meter: Meter) -> None:
    """Have goals wait for their results."""
    each = [{"id": str(number)} for number in range(meter.n)]
    others = named("action", "/bench/unused", meter.n)
    common = {"action": ACTION, "action_type": ACTION_TYPE}
    with meter.client("server") as server, meter.client("sender") as client:
        perform(server, "advertise_action", [{"action": ACTION}], type=ACTION_TYPE)
        with meter.measured("send a goal, while many have not ended"):
            perform(client, "send_action_goal", each, **common)
        known = [{"id": json.loads(text)["id"]} for text in server.settle()]
        with meter.measured("cancel one of many goals"):
            perform(client, "cancel_action_goal", reversed(each), action=ACTION)
            server.settle()
        with meter.measured("advertise one of many actions"):
            perform(server, "advertise_action", others, type=ACTION_TYPE)
        with meter.measured("unadvertise an action, while many goals have not ended"):
            perform(server, "unadvertise_action", others)
        with meter.measured("result of one of many goals"):
            ended = {"action": ACTION, "status": 4, "result": True}
            perform(server, "action_result", reversed(known), **ended)
            client.settle()


def parameters(meter: Meter) -> None:
    """Have many parameters in one namespace."""
    names = [f"/bench/parameter_{number}" for number in range(meter.n)]
    with meter.client("caller") as caller:
        for what, service, args in (
            ("set one of many parameters", "set_param", {"value": "1"}),
            ("get one of many parameters", "get_param", {}),
            ("delete one of many parameters", "delete_param", {}),
        ):
            arguments = [{"args": {"name": name, **args}} for name in names]
            with meter.measured(what):
                perform(caller, "call_service", arguments, service=f"/rosapi/{service}")


def lookups(meter: Meter) -> None:
    """Look topics and nodes up through rosapi."""
    each = named("topic", TOPIC, meter.n)
    with meter.clients(meter.n, "talker") as talkers, meter.client("caller") as caller:
        perform(caller, "advertise", each, type=TYPE)
        for talker in talkers:
            talker.settle()
        arguments = [{"args": fields} for fields in each]
        for what in ("topic_type", "publishers"):
            with meter.measured(f"/rosapi/{what} of one of many topics"):
                perform(caller, "call_service", arguments, service=f"/rosapi/{what}")


def peers(meter: Meter) -> None:
    """Have nodes publish and subscribe to one topic that all of them watch."""
    with meter.clients(meter.n // WATCHERS_SHARE, "node") as nodes:
        with meter.measured("report of one node to another", len(nodes) ** 2):
            _join(nodes)


def _join(nodes: Sequence[Client]) -> int:
    """Join a topic one after the other; return the bytes that all receive."""
    common = {"topic": TOPIC, "id": f"peers:{TOPIC}:1", "peers": True, "peer_changes": True}
    frames = operation("advertise", type=TYPE, **common) + operation("subscribe", **common)
    messages = []
    for node in nodes:
        node.send(frames)
        messages += node.settle()
    for node in nodes:
        messages += node.settle()
    return sum(map(len, messages))


DIMENSIONS = (
    idle_clients,
    topics,
    pending_publishes,
    subscribers,
    encodings,
    ids,
    publishers,
    calls,
    timeouts,
    services,
    goals,
    parameters,
    lookups,
    peers,
)


def growth(plan: Plan, report: Report) -> None:
    """Measure a new hub at each size; its clients are those of one dimension after the other."""
    first = QUICK_FIRST if plan.quick else FIRST
    multiples = [2**doubling for doubling in range(DOUBLINGS + 1)]
    reps = min(plan.reps, MOST_REPS)
    for hub in plan.hubs:
        costs: dict[str, dict[int, list[float]]] = defaultdict(lambda: defaultdict(list))
        for rep in range(reps):
            for times in multiples:
                found = _costs(hub, first * times, times, rep)
                report.record("growth", server=hub, n=first * times, rep=rep, cpu_us=found)
                for what, cost in found.items():
                    costs[what][times].append(cost)
        report.table(
            f"CPU of the hub, µs per operation, minimum of {reps}, while it holds N, 2 N, 4 N and "
            f"8 N; N is {first}, or {IDS} for the ids of one topic",
            ("operation", *(f"{times} N" for times in multiples), "growth", "limit"),
            [_row(hub, what, by_size, report) for what, by_size in costs.items()],
        )
        _measure_traffic(hub, QUICK_NODES if plan.quick else NODES, report)


def _measure_traffic(hub: str, count: int, report: Report) -> None:
    with (
        on_load_cpu(),
        running(hub) as server,
        connect_all(server.port, count, NODE) as nodes,
    ):
        cpu = server.cpu_seconds
        megabytes = _join(nodes) / 1e6
        cpu = server.cpu_seconds - cpu
    verdict = report.check(hub, f"{count} nodes join a topic", megabytes, LIMIT_TRAFFIC_MB, " MB")
    report.record("peers", server=hub, nodes=count, megabytes=megabytes, cpu_seconds=cpu)
    report.table(
        f"{count} nodes join a topic one after the other as publishers and subscribers, "
        "and watch its nodes",
        ("server", "traffic, MB", "CPU of the hub, s", "limit"),
        [(hub, f"{megabytes:.1f}", f"{cpu:.2f}", verdict)],
    )


def _costs(hub: str, n: int, times: int, rep: int) -> dict[str, float]:
    costs: dict[str, float] = {}
    with on_load_cpu(), running(hub, options=OPTIONS) as server:
        _measure(Meter(server, WARM_UP, 1, {}), rep)  # Everything is loaded and compiled then.
        _measure(Meter(server, n, times, costs), rep)
    return costs


def _measure(meter: Meter, rep: int) -> None:
    # Each repetition in another order: Python's full collections of garbage fall elsewhere then.
    first = rep * len(DIMENSIONS) // MOST_REPS
    for measure in DIMENSIONS[first:] + DIMENSIONS[:first]:
        measure(meter)
    meter.close()


def _row(hub: str, what: str, costs: dict[int, list[float]], report: Report) -> list[str]:
    least = [min(found) for found in costs.values()]
    # Ignore the growth of an operation that stays cheap.
    factor = least[-1] / max(least[0], NOISE_US)
    limit = LIMIT_GROWTH if what != IDS_OPERATION else None
    verdict = report.check(hub, f"growth of: {what}", factor, limit, "x")
    return [what, *(f"{cost:.1f}" for cost in least), f"{factor:.1f} x", verdict]
