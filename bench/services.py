"""CPU of the hub for a question and its answer: by two topics, by a service, by one of its own."""

from __future__ import annotations

import json
import re
import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import ExitStack
from typing import Any

from bench.client import Client, crowd, frame, operation
from bench.machine import on_load_cpu
from bench.measure import BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, all_running

WINDOWS = (1, 64)
LIMIT_AGAINST_TOPICS = 3.0
SHARE = 0.5
"""Of the planned seconds, for each of many measurements."""
NUMBERS = 1000
"""How many different questions there are; then they begin anew."""
SERVICE, PING, PONG = "/bench/add", "/bench/ping", "/bench/pong"
# Types with the fields of rospy_tutorials/AddTwoInts: both trips carry the same values.
PING_TYPE, PING_FIELDS = "bench_msgs/TwoInts", "int64 a\nint64 b\n"
PONG_TYPE, PONG_FIELDS = "bench_msgs/Sum", "int64 sum\n"


class RoundTrip(ABC):
    """How a question goes through the hub, and how its answer comes back."""

    name: str
    """What the table calls it."""
    answered_by_hub = False

    def __init__(self) -> None:
        """Prepare the frames of the questions."""
        self.questions = [self.question(number) for number in range(NUMBERS)]

    @abstractmethod
    def question(self, number: int) -> bytes:
        """Return the asker's frame."""

    @abstractmethod
    def prepare(self, asker: Client, other: Client) -> None:
        """Have both registered."""

    @abstractmethod
    def answer(self, number: int, question: bytes) -> bytes:
        """Return the other's frame that answers a question, given what it heard."""

    @abstractmethod
    def is_answer(self, number: int, fields: dict[str, Any]) -> bool:
        """Whether this operation is the answer to that question."""


class TopicRoundTrip(RoundTrip):
    """One publishes the question, the other publishes the answer."""

    name = "topics"

    def __init__(self) -> None:
        """Prepare the frames."""
        super().__init__()
        self._answers = [
            operation("publish", topic=PONG, msg={"sum": 3 * number}) for number in range(NUMBERS)
        ]

    def question(self, number: int) -> bytes:
        """Publish two numbers."""
        return operation("publish", topic=PING, msg={"a": number, "b": 2 * number})

    def prepare(self, asker: Client, other: Client) -> None:
        """Advertise and subscribe."""
        for client, topic, type_, fields in (
            (asker, PING, PING_TYPE, PING_FIELDS),
            (other, PONG, PONG_TYPE, PONG_FIELDS),
        ):
            client.send(operation("advertise", topic=topic, type=type_, definition=fields))
        asker.send(operation("subscribe", topic=PONG))
        other.send(operation("subscribe", topic=PING))

    def answer(self, number: int, question: bytes) -> bytes:
        """Publish the sum."""
        return self._answers[number]

    def is_answer(self, number: int, fields: dict[str, Any]) -> bool:
        """Whether it is the sum."""
        return fields == {"op": "publish", "topic": PONG, "msg": {"sum": 3 * number}}


class ServiceRoundTrip(RoundTrip):
    """One calls a service of the other's."""

    name = "service"
    _ID = re.compile(rb'"id":("[^"]*")')

    def __init__(self) -> None:
        """Prepare the frames, but for the ids, which come from the hub."""
        super().__init__()
        self._answers = [
            json.dumps({"service": SERVICE, "values": {"sum": 3 * number}, "result": True})
            .removeprefix("{")
            .encode()
            for number in range(NUMBERS)
        ]

    def question(self, number: int) -> bytes:
        """Call the service with two numbers."""
        args = {"a": number, "b": 2 * number}
        return operation("call_service", service=SERVICE, args=args, id=f"call:{number}")

    def prepare(self, asker: Client, other: Client) -> None:
        """Provide the service."""
        type_ = "rospy_tutorials/AddTwoInts"
        other.send(operation("advertise_service", service=SERVICE, type=type_))

    def answer(self, number: int, question: bytes) -> bytes:
        """Respond with the sum."""
        id_ = self._ID.search(question)
        if id_ is None:
            raise BenchError(f"a call without an id: {question.decode()}")
        return frame(b'{"op":"service_response","id":%b,%b' % (id_[1], self._answers[number]))

    def is_answer(self, number: int, fields: dict[str, Any]) -> bool:
        """Whether it is the response to this very call."""
        return fields == _response(SERVICE, number, {"sum": 3 * number})


class HubServiceRoundTrip(RoundTrip):
    """One asks the hub for the type of a topic."""

    name = "/rosapi/topic_type"
    answered_by_hub = True

    def question(self, number: int) -> bytes:
        """Call the hub's own service."""
        args = {"topic": PING}
        return operation("call_service", service=self.name, args=args, id=f"call:{number}")

    def prepare(self, asker: Client, other: Client) -> None:
        """Rely on the topic that is there already."""

    def answer(self, number: int, question: bytes) -> bytes:
        """Nobody else is asked."""
        raise BenchError(f"{self.name} was asked of a client: {question.decode()}")

    def is_answer(self, number: int, fields: dict[str, Any]) -> bool:
        """Whether it is the topic's type."""
        return fields == _response(self.name, number, {"type": PING_TYPE})


def _response(service: str, number: int, values: dict[str, Any]) -> dict[str, Any]:
    answer = {"op": "service_response", "service": service, "id": f"call:{number}"}
    return {**answer, "values": values, "result": True}


def services(plan: Plan, report: Report) -> None:
    """Measure each trip at each window, in turn."""
    topics, service, own = trips = (TopicRoundTrip(), ServiceRoundTrip(), HubServiceRoundTrip())
    costs: dict[tuple[str, int, str], list[float]] = {}
    with ExitStack() as stack:
        stack.enter_context(on_load_cpu())
        servers = stack.enter_context(all_running(plan.hubs))
        pairs = [stack.enter_context(crowd(server.port, 2, "peer")) for server in servers]
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
        f"Question and answer: CPU of the hub, µs, minimum (median) of {plan.reps}",
        ("server", "window", topics.name, service.name, "service : topics", "limit", own.name),
        rows,
    )


def _prepare(trips: Sequence[RoundTrip], pair: Sequence[Client]) -> None:
    asker, other = pair
    for trip in trips:
        trip.prepare(asker, other)
    asker.settle()
    other.settle()


def _cost(
    trip: RoundTrip, pair: Sequence[Client], window: int, server: Server, plan: Plan, report: Report
) -> float:
    """Return the hub's CPU time for one question and its answer, in µs."""
    asker, other = pair
    _converse(trip, asker, other, window, plan.warm_seconds * SHARE)
    cpu, start = server.cpu_seconds, time.perf_counter()
    answers = _converse(trip, asker, other, window, plan.seconds * SHARE)
    cpu, seconds = server.cpu_seconds - cpu, time.perf_counter() - start
    cost = cpu / len(answers) * 1e6
    what = f"{trip.name}, window {window}"
    report.fault(server.name, what, _fault(trip, answers, surplus=asker.settle() + other.settle()))
    report.record(
        "services",
        server=server.name,
        trip=trip.name,
        window=window,
        cpu_us=cost,
        per_second=len(answers) / seconds,
        server_cpu_percent=100 * cpu / seconds,
    )
    return cost


def _converse(
    trip: RoundTrip, asker: Client, other: Client, window: int, seconds: float
) -> list[bytes]:
    """Ask for so long, with so many questions under trip; return all answers in order."""
    asked, passed_on = 0, 0
    answers: list[bytes] = []
    due = window
    end = time.perf_counter() + seconds
    while len(answers) < asked or due:
        asker.send(b"".join(trip.questions[n % NUMBERS] for n in range(asked, asked + due)))
        asked += due
        if passed_on < asked and not trip.answered_by_hub:
            questions = other.receive()
            numbered = enumerate(questions, passed_on)
            other.send(b"".join(trip.answer(n % NUMBERS, question) for n, question in numbered))
            passed_on += len(questions)
        news = asker.receive()
        answers += news
        due = len(news) if time.perf_counter() < end else 0
    return answers


def _fault(trip: RoundTrip, answers: Sequence[bytes], surplus: Sequence[bytes]) -> str:
    for number, answer in enumerate(answers):
        if not trip.is_answer(number % NUMBERS, json.loads(answer)):
            return f"answer {number} is {answer.decode()}"
    return f"{len(surplus)} messages too many: {surplus[0].decode()}" if surplus else ""
