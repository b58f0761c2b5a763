"""CPU of the hub per request and response: by two topics, by a service, by a hub's service."""

from __future__ import annotations

import json
import re
import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import ExitStack
from typing import Any

from bench.client import Client, connect_all, frame, operation
from bench.machine import on_load_cpu
from bench.measure import BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, all_running

WINDOWS = (1, 64)
LIMIT_AGAINST_TOPICS = 3.0
SHARE = 0.5
"""The share of the planned seconds for each of many measurements."""
NUMBERS = 1000
"""The number of different requests; then they repeat."""
SERVICE, PING, PONG = "/bench/add", "/bench/ping", "/bench/pong"
# Types with the fields of rospy_tutorials/AddTwoInts: topics and the service carry equal values.
PING_TYPE, PING_FIELDS = "bench_msgs/TwoInts", "int64 a\nint64 b\n"
PONG_TYPE, PONG_FIELDS = "bench_msgs/Sum", "int64 sum\n"


class RoundTrip(ABC):
    """The path of a request and its response through the hub."""

    name: str
    """The name in the table."""
    served_by_hub = False

    def __init__(self) -> None:
        """Prepare the frames of the requests."""
        self.requests = [self.request(number) for number in range(NUMBERS)]

    @abstractmethod
    def request(self, number: int) -> bytes:
        """Return the client's frame."""

    @abstractmethod
    def prepare(self, client: Client, server: Client) -> None:
        """Register both."""

    @abstractmethod
    def response(self, number: int, request: bytes) -> bytes:
        """Return the server's frame that responds to a received request."""

    @abstractmethod
    def is_response(self, number: int, fields: dict[str, Any]) -> bool:
        """Return whether an operation is the response to a request."""


class TopicRoundTrip(RoundTrip):
    """The client publishes the request, the server publishes the response."""

    name = "topics"

    def __init__(self) -> None:
        """Prepare the frames."""
        super().__init__()
        self._responses = [
            operation("publish", topic=PONG, msg={"sum": 3 * number}) for number in range(NUMBERS)
        ]

    def request(self, number: int) -> bytes:
        """Publish two numbers."""
        return operation("publish", topic=PING, msg={"a": number, "b": 2 * number})

    def prepare(self, client: Client, server: Client) -> None:
        """Advertise and subscribe."""
        for peer, topic, type_, fields in (
            (client, PING, PING_TYPE, PING_FIELDS),
            (server, PONG, PONG_TYPE, PONG_FIELDS),
        ):
            peer.send(operation("advertise", topic=topic, type=type_, definition=fields))
        client.send(operation("subscribe", topic=PONG))
        server.send(operation("subscribe", topic=PING))

    def response(self, number: int, request: bytes) -> bytes:
        """Publish the sum."""
        return self._responses[number]

    def is_response(self, number: int, fields: dict[str, Any]) -> bool:
        """Return whether it is the sum."""
        return fields == {"op": "publish", "topic": PONG, "msg": {"sum": 3 * number}}


class ServiceRoundTrip(RoundTrip):
    """The client calls a service of the server."""

    name = "service"
    _ID = re.compile(rb'"id":("[^"]*")')

    def __init__(self) -> None:
        """Prepare the frames except for the ids, which the hub chooses."""
        super().__init__()
        self._responses = [
            json.dumps({"service": SERVICE, "values": {"sum": 3 * number}, "result": True})
            .removeprefix("{")
            .encode()
            for number in range(NUMBERS)
        ]

    def request(self, number: int) -> bytes:
        """Call the service with two numbers."""
        args = {"a": number, "b": 2 * number}
        return operation("call_service", service=SERVICE, args=args, id=f"call:{number}")

    def prepare(self, client: Client, server: Client) -> None:
        """Advertise the service."""
        type_ = "rospy_tutorials/AddTwoInts"
        server.send(operation("advertise_service", service=SERVICE, type=type_))

    def response(self, number: int, request: bytes) -> bytes:
        """Respond with the sum."""
        id_ = self._ID.search(request)
        if id_ is None:
            raise BenchError(f"call_service without an id: {request.decode()}")
        return frame(b'{"op":"service_response","id":%b,%b' % (id_[1], self._responses[number]))

    def is_response(self, number: int, fields: dict[str, Any]) -> bool:
        """Return whether it is the response to this call."""
        return fields == _response(SERVICE, number, {"sum": 3 * number})


class HubServiceRoundTrip(RoundTrip):
    """The client asks the hub for the type of a topic."""

    name = "/rosapi/topic_type"
    served_by_hub = True

    def request(self, number: int) -> bytes:
        """Call a service of the hub."""
        args = {"topic": PING}
        return operation("call_service", service=self.name, args=args, id=f"call:{number}")

    def prepare(self, client: Client, server: Client) -> None:
        """Do nothing; the topic exists already."""

    def response(self, number: int, request: bytes) -> bytes:
        """Raise: the hub itself responds."""
        raise BenchError(f"the hub forwarded a call of {self.name}: {request.decode()}")

    def is_response(self, number: int, fields: dict[str, Any]) -> bool:
        """Return whether it is the topic's type."""
        return fields == _response(self.name, number, {"type": PING_TYPE})


def _response(service: str, number: int, values: dict[str, Any]) -> dict[str, Any]:
    response = {"op": "service_response", "service": service, "id": f"call:{number}"}
    return {**response, "values": values, "result": True}


def services(plan: Plan, report: Report) -> None:
    """Measure each kind of round trip with each window, in turn."""
    topics, service, own = trips = (TopicRoundTrip(), ServiceRoundTrip(), HubServiceRoundTrip())
    costs: dict[tuple[str, int, str], list[float]] = {}
    with ExitStack() as stack:
        stack.enter_context(on_load_cpu())
        servers = stack.enter_context(all_running(plan.hubs))
        pairs = [stack.enter_context(connect_all(server.port, 2, "peer")) for server in servers]
        for pair in pairs:
            _prepare(trips, pair)
        for _ in range(plan.reps):
            for window in WINDOWS:
                for server, pair in zip(servers, pairs, strict=True):
                    for trip in trips:
                        cost = _cost(trip, pair, window, server, plan, report)
                        costs.setdefault((server.name, window, trip.name), []).append(cost)
    rows = []
    for hub in plan.hubs:
        for window in WINDOWS:
            found = [Repeated.of(costs[hub, window, trip.name]) for trip in (topics, service, own)]
            ratio = found[1] / found[0]
            what = f"service against topics, window {window}"
            verdict = report.check(hub, what, ratio.median, LIMIT_AGAINST_TOPICS)
            rows.append(
                (hub, f"{window}", *map(str, found[:2]), f"{ratio}", verdict, f"{found[2]}")
            )
    report.table(
        f"Request and response: CPU of the hub, µs, minimum (median) of {plan.reps}",
        ("server", "window", topics.name, service.name, "service : topics", "limit", own.name),
        rows,
    )


def _prepare(trips: Sequence[RoundTrip], pair: Sequence[Client]) -> None:
    client, server = pair
    for trip in trips:
        trip.prepare(client, server)
    client.settle()
    server.settle()


def _cost(
    trip: RoundTrip, pair: Sequence[Client], window: int, server: Server, plan: Plan, report: Report
) -> float:
    """Return the hub's CPU time per request and response, in µs."""
    client, responder = pair
    _exchange(trip, client, responder, window, plan.warm_seconds * SHARE)
    cpu, start = server.cpu_seconds, time.perf_counter()
    responses = _exchange(trip, client, responder, window, plan.seconds * SHARE)
    cpu, seconds = server.cpu_seconds - cpu, time.perf_counter() - start
    cost = cpu / len(responses) * 1e6
    what = f"{trip.name}, window {window}"
    report.fault(
        server.name, what, _fault(trip, responses, surplus=client.settle() + responder.settle())
    )
    report.record(
        "services",
        server=server.name,
        round_trip=trip.name,
        window=window,
        cpu_us=cost,
        per_second=len(responses) / seconds,
        server_cpu_percent=100 * cpu / seconds,
    )
    return cost


def _exchange(
    trip: RoundTrip, client: Client, responder: Client, window: int, seconds: float
) -> list[bytes]:
    """Send requests, `window` of them pending at a time; return all responses in order."""
    sent, forwarded = 0, 0
    responses: list[bytes] = []
    due = window
    end = time.perf_counter() + seconds
    while len(responses) < sent or due:
        client.send(b"".join(trip.requests[n % NUMBERS] for n in range(sent, sent + due)))
        sent += due
        if forwarded < sent and not trip.served_by_hub:
            requests = responder.receive()
            numbered = enumerate(requests, forwarded)
            responder.send(b"".join(trip.response(n % NUMBERS, request) for n, request in numbered))
            forwarded += len(requests)
        received = client.receive()
        responses += received
        due = len(received) if time.perf_counter() < end else 0
    return responses


def _fault(trip: RoundTrip, responses: Sequence[bytes], surplus: Sequence[bytes]) -> str:
    for number, response in enumerate(responses):
        if not trip.is_response(number % NUMBERS, json.loads(response)):
            return f"response {number} is {response.decode()}"
    return (
        f"{len(surplus)} unexpected messages, the first: {surplus[0].decode()}" if surplus else ""
    )
