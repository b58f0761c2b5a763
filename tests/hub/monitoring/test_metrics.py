"""/metrics, read by Prometheus's own parsers."""

from __future__ import annotations

import asyncio
import gzip
import re
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from certificates import Authority
from certificates import authority as authority
from conftest import StartHub
from prometheus_client.metrics_core import Metric
from prometheus_client.openmetrics.parser import (
    text_string_to_metric_families as strict_families_of,
)
from prometheus_client.parser import text_string_to_metric_families
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from fibws.hub.graph.totals import OTHER, CallTotals, TopicTotals
from fibws.hub.server import HubServer
from fibws.protocol.websocket import BINARY, client_header

from ..raw_client import Client, connected, dialled, handshake, publish, until
from ..token_clients import entry

pytestmark = pytest.mark.both_loops

OPERATIONS = (Path(__file__).parents[3] / "docs" / "operations.md").read_text("utf-8")
OPENMETRICS = "application/openmetrics-text;version=1.0.0,text/plain;version=0.0.4;q=0.5"
FILE = entry("operator", "admin = true", "one")
FILE += entry("guest", 'allow = {subscribe = ["/**"]}', "two")


def scrape(hub: HubServer, address: str = "127.0.0.1", **headers: str) -> Response:
    fields = Headers({name.replace("_", "-"): value for name, value in headers.items()})
    response = hub._requests.respond(Request("/metrics", fields), address)
    assert response is not None
    return response


def strict_families(text: str) -> Iterator[Metric]:
    """Yield the metrics of an OpenMetrics text, whose parser is strict."""
    parse: Callable[[str], Iterator[Metric]] = strict_families_of
    yield from parse(text)


def families(hub: HubServer, **headers: str) -> dict[str, Metric]:
    """Return all metrics by name."""
    body = bytes(scrape(hub, **headers).body).decode()
    return {family.name: family for family in text_string_to_metric_families(body)}


def value(hub: HubServer, name: str, /, **labels: str) -> float:
    """Return one number; 0 if there is none with these labels."""
    for family in families(hub).values():
        for sample in family.samples:
            if sample.name == name and sample.labels == labels:
                return sample.value
    return 0.0


@asynccontextmanager
async def publisher(hub: HubServer, topic: str, count: int) -> AsyncIterator[Client]:
    """A client that has published some messages."""
    async with connected(hub.port) as client:
        await client.advertises(topic)
        await client.send(*(publish(topic, number) for number in range(count)))
        await client.is_processed()
        yield client


async def left(hub: HubServer, client: Client) -> None:
    """End a client, and wait until the hub knows."""
    count = hub._limits.clients
    client.leave()
    await until(lambda: hub._limits.clients < count)


class TestFormat:
    @pytest.mark.parametrize(
        ("accept", "content_type"),
        [
            ("", "text/plain; version=0.0.4; charset=utf-8"),
            ("text/plain", "text/plain; version=0.0.4; charset=utf-8"),
            (OPENMETRICS, "application/openmetrics-text; version=1.0.0; charset=utf-8"),
        ],
    )
    async def test_scraper_gets_the_format_that_it_accepts(
        self, hub: HubServer, accept: str, content_type: str
    ) -> None:
        response = scrape(hub, Accept=accept)
        assert response.status_code == 200
        assert response.headers["Content-Type"] == content_type

    async def test_both_formats_hold_the_same(self, hub: HubServer) -> None:
        async with publisher(hub, "/t", 3):
            plain = families(hub)
            body = bytes(scrape(hub, Accept=OPENMETRICS).body).decode()
        found = {family.name: family.type for family in strict_families(body)}
        assert found == {name: family.type for name, family in plain.items()}

    async def test_all_names_follow_the_conventions(self, hub: HubServer) -> None:
        for family in families(hub).values():
            assert family.name.startswith(("fibws_", "process_"))
            assert family.documentation.endswith(".")
            assert family.type in ("counter", "gauge", "histogram")

    @pytest.mark.parametrize("accept", ["", OPENMETRICS])
    async def test_body_is_compressed_for_those_who_accept_it(
        self, hub: HubServer, accept: str
    ) -> None:
        response = scrape(hub, Accept=accept, Accept_Encoding="gzip")
        assert response.headers["Content-Encoding"] == "gzip"
        assert b"fibws_clients" in gzip.decompress(bytes(response.body))
        assert "Content-Encoding" not in scrape(hub, Accept=accept).headers

    @pytest.mark.parametrize("topic", ['/a"b', "/a\\b", "/ä中", "/a{b}", "/a\\nb"])
    async def test_name_of_a_topic_may_hold_anything(self, hub: HubServer, topic: str) -> None:
        async with publisher(hub, topic, 2):
            assert value(hub, "fibws_topic_messages_total", topic=topic) == 2
            assert list(strict_families(bytes(scrape(hub, Accept=OPENMETRICS).body).decode()))

    async def test_documentation_names_all_metrics(
        self, start_hub: StartHub, authority: Authority, tmp_path: Path
    ) -> None:
        other = await start_hub()
        certificate, key = authority.issue()
        hub = await start_hub(
            record=tmp_path,
            params=tmp_path / "params.yaml",
            keep_params=True,
            cert=certificate,
            key=key,
            join=(other.url,),
        )
        await until(lambda: bool(hub.federation.peers))
        section = OPERATIONS.partition("### Metrics")[2].partition("\n## ")[0]
        rows = re.findall(r"^\| (`(?:fibws|process)_.*?) \| (\w+) \|", section, re.MULTILINE)
        documented = {
            name: type_ for names, type_ in rows for name in re.findall(r"`(\w+)`", names)
        }
        assert documented == {name: family.type for name, family in families(hub).items()}


class TestCounters:
    async def test_messages_are_counted_by_topic(self, hub: HubServer) -> None:
        async with connected(hub.port) as listener:
            await listener.subscribes("/t")
            async with publisher(hub, "/t", 5):
                assert await listener.receive_data(5) == [0, 1, 2, 3, 4]
                assert value(hub, "fibws_topic_messages_total", topic="/t") == 5
                assert value(hub, "fibws_topic_sent_messages_total", topic="/t") == 5
                assert value(hub, "fibws_topic_bytes_total", topic="/t") > 100
                assert value(hub, "fibws_messages_total") >= 5

    async def test_counters_do_not_go_back_when_clients_leave(self, hub: HubServer) -> None:
        async with connected(hub.port) as listener:
            await listener.subscribes("/t", throttle_rate=3_600_000)
            async with publisher(hub, "/t", 5) as talker:
                await listener.receive_data(1)
                before = counters(hub)
                await left(hub, talker)
            await left(hub, listener)
        assert "/t" not in hub.graph.topics
        after = counters(hub)
        assert not {key for key in before if after.get(key, 0) < before[key]}
        assert after["fibws_topic_throttled_messages_total", "/t"] == 4
        async with publisher(hub, "/t", 2):
            assert value(hub, "fibws_topic_messages_total", topic="/t") == 7

    async def test_subscription_that_is_changed_is_counted_once(self, hub: HubServer) -> None:
        changes: list[dict[str, Any]] = [{}, {"compression": "cbor"}, {"throttle_rate": 1}]
        async with connected(hub.port) as listener, publisher(hub, "/t", 0) as talker:
            for fields in changes:
                await listener.send_operation("subscribe", topic="/t", **fields)
                await listener.is_processed()
            await listener.send_operation("unsubscribe", topic="/t")
            await listener.subscribes("/t")
            await talker.send(publish("/t", 1))
            await listener.receive_data(1)
            assert value(hub, "fibws_topic_sent_messages_total", topic="/t") == 1

    async def test_bytes_on_sockets_are_counted(self, hub: HubServer) -> None:
        before = value(hub, "fibws_received_bytes_total")
        async with publisher(hub, "/t", 100) as client:
            received = value(hub, "fibws_received_bytes_total")
            assert received - before > 100 * len(publish("/t", 1))
            await left(hub, client)
        assert value(hub, "fibws_received_bytes_total") >= received
        assert value(hub, "fibws_sent_bytes_total") > 0

    async def test_refusals_are_counted_by_reason(
        self, start_hub: StartHub, tmp_path: Path
    ) -> None:
        path = tmp_path / "tokens.toml"
        path.write_text(FILE, "utf-8")
        hub = await start_hub(tokens=path)
        async with connected(hub.port, Authorization="Bearer wrong") as client:
            assert (await client.is_closed())[0] == 4401
        async with connected(hub.port, Authorization="Bearer two") as client:
            await client.send_operation("advertise", topic="/t", type="std_msgs/Int32")
            assert (await client.receive())["level"] == "error"
            await client.send_operation("subscribe", topic="/t")
            await client.is_processed()
        response = scrape(hub, Authorization="Bearer one")
        samples = {
            sample.labels["reason"]: sample.value
            for family in text_string_to_metric_families(bytes(response.body).decode())
            if family.name == "fibws_refusals"
            for sample in family.samples
        }
        assert samples["authentication"] == 1
        assert samples["right"] == 1

    async def test_refused_connection_is_counted_once(self, start_hub: StartHub) -> None:
        hub = await start_hub(max_connections=0, max_address_handshakes_per_second=1)
        for refusals in range(1, 110):
            async with dialled(hub.port) as client:
                await client.send(handshake())
                status, _, _ = await client.response()
            assert value(hub, "fibws_refusals_total", reason="limit") == refusals
            if status == 429:
                break
        assert status == 429

    async def test_calls_are_counted_by_service_and_outcome(self, hub: HubServer) -> None:
        async with connected(hub.port) as client:
            for service in ("/rosapi/get_time", "/rosapi/get_time", "/nothing"):
                await client.send_operation("call_service", service=service, id="1", args={})
                while (await client.receive())["op"] != "service_response":
                    pass
            name = "fibws_service_responses_total"
            assert value(hub, name, service="/rosapi/get_time") == 2
            labels = {"service": OTHER, "code": "unknown_service"}
            assert value(hub, "fibws_service_failures_total", **labels) == 1
            assert value(hub, "fibws_service_call_seconds_count") == 2
            assert 0 < value(hub, "fibws_service_call_seconds_sum") < 60


def counters(hub: HubServer) -> dict[tuple[str, str], float]:
    """Return all counters by name and topic."""
    return {
        (sample.name, sample.labels.get("topic", "")): sample.value
        for family in families(hub).values()
        if family.type == "counter"
        for sample in family.samples
    }


class TestReaders:
    @pytest.mark.parametrize(
        ("headers", "status"),
        [
            ({}, 401),
            ({"Authorization": "Bearer wrong"}, 401),
            ({"Authorization": "Bearer two"}, 403),
            ({"Authorization": "Bearer one"}, 200),
            ({"Authorization": "Bearer one", "Host": "hub.internal:9090"}, 200),
        ],
    )
    async def test_hub_with_tokens_shows_them_to_admins(
        self, start_hub: StartHub, tmp_path: Path, headers: dict[str, str], status: int
    ) -> None:
        path = tmp_path / "tokens.toml"
        path.write_text(FILE, "utf-8")
        hub = await start_hub(tokens=path)
        response = scrape(hub, **headers)
        assert response.status_code == status
        if status == 401:
            assert response.headers["WWW-Authenticate"] == "Bearer"
        if status == 403:
            assert b'missing right "admin"' in bytes(response.body)
        assert sum(hub.audit.refusals.values()) == (status != 200)

    @pytest.mark.parametrize(
        ("address", "headers"),
        [("192.0.2.7", {}), ("127.0.0.1", {"X_Forwarded_For": "192.0.2.7"})],
    )
    async def test_open_hub_shows_them_to_its_own_machine(
        self, hub: HubServer, address: str, headers: dict[str, str]
    ) -> None:
        response = scrape(hub, address, **headers)
        assert response.status_code == 403
        assert b"--public-metrics" in bytes(response.body)

    async def test_page_of_another_name_may_not_read_them(self, hub: HubServer) -> None:
        assert scrape(hub, Host="rebound.example").status_code == 403
        assert hub.audit.refusals["origin"] == 1

    async def test_they_may_be_public(self, start_hub: StartHub) -> None:
        hub = await start_hub(public_metrics=True)
        assert scrape(hub, "192.0.2.7", Host="any.example").status_code == 200


class Source:
    """A publisher with its counts."""

    def __init__(self, topic: Topic, messages: int) -> None:
        self.topic = topic
        self.messages = messages
        self.bytes = 0


class Topic:
    """A topic of the graph, as far as its totals are read."""

    def __init__(self, name: str, messages: int = 0) -> None:
        self.name = name
        self.publishers = {"/node": Source(self, messages)}

    def all_sinks(self) -> list[Any]:
        return []


class TestNamesWithoutEnd:
    """Clients may make up topics without end."""

    def topics(self, *names: str, messages: int = 1) -> dict[str, Any]:
        return {name: Topic(name, messages) for name in names}

    def leave(self, totals: TopicTotals, topics: dict[str, Any], name: str) -> None:
        totals.source_left(topics.pop(name).publishers["/node"])

    def test_topics_beyond_the_limit_count_as_others(self) -> None:
        topics = self.topics(*(f"/{number}" for number in range(10)))
        found, everything = TopicTotals(topics, most=4).by_topic()
        assert len(found) == 5
        assert (found[OTHER].messages, everything.messages) == (6, 10)

    def test_new_topic_gets_the_place_of_one_that_is_gone(self) -> None:
        topics = self.topics("/a", "/b")
        totals = TopicTotals(topics, most=2)
        totals.by_topic()
        self.leave(totals, topics, "/a")
        assert totals.by_topic()[0]["/a"].messages == 1
        topics |= self.topics("/c", messages=5)
        found, everything = totals.by_topic()
        assert found.keys() == {"/b", "/c", OTHER}
        assert found["/c"].messages == 5
        assert everything.messages == 7

    def test_topic_that_counted_as_another_gets_a_free_place_when_it_comes_back(self) -> None:
        """The names of those that are gone would be kept without end, besides."""
        topics = self.topics("/a", "/b")
        totals = TopicTotals(topics, most=1)
        assert totals.by_topic()[0].keys() == {"/a", OTHER}
        self.leave(totals, topics, "/b")
        totals.by_topic()
        self.leave(totals, topics, "/a")
        topics |= self.topics("/b", messages=5)
        found, everything = totals.by_topic()
        assert found["/b"].messages == 5
        assert everything.messages == 7

    def test_services_beyond_the_limit_count_as_others(self) -> None:
        totals = CallTotals(lambda: 0, most=2)
        for name in ("/a", "/b", "/c", "/a", "/d"):
            totals.responded(name, 0)
            totals.failed(name, "timeout")
            totals.refused(name, "unknown_service")
        assert totals.responses == {"/a": 2, "/b": 1, OTHER: 2}
        assert {name for name, _ in totals.failures} == {"/a", "/b", OTHER}

    def test_nothing_goes_back_however_topics_come_and_go(self) -> None:
        topics: dict[str, Any] = {}
        totals = TopicTotals(topics, most=3)
        last: dict[str, int] = {}
        everything = 0
        for number in range(200):
            name = f"/{number * 7 % 11}"
            if name in topics and number % 3:
                self.leave(totals, topics, name)
            elif name not in topics:
                topics |= self.topics(name)
            else:
                topics[name].publishers["/node"].messages += 1
            if number % 2:
                found, total = totals.by_topic()
                assert len(found) <= 4
                for key, each in found.items():
                    assert each.messages >= last.get(key, 0) or key not in last
                last = {key: each.messages for key, each in found.items()}
                assert total.messages >= everything
                everything = total.messages


async def test_hub_whose_links_are_all_down_has_metrics(start_hub: StartHub) -> None:
    robot = await start_hub(hub_name="robot", join=("ws://127.0.0.1:1",))
    assert value(robot, "fibws_links") == 0
    assert value(robot, "fibws_links_down") == 1


async def test_links_to_other_hubs_have_metrics(start_hub: StartHub) -> None:
    cloud = await start_hub(hub_name="cloud")
    robot = await start_hub(hub_name="robot", join=(cloud.url, "ws://127.0.0.1:1"))
    await until(lambda: bool(robot.federation.peers))
    hub = f"cloud ({cloud.federation.hub.id[:6]})"
    assert value(robot, "fibws_links") == 1
    assert value(robot, "fibws_links_down") == 1
    assert value(robot, "fibws_link_round_trip_seconds", hub=hub) > 0
    assert value(robot, "fibws_link_sent_bytes_total", hub=hub) > 0
    assert value(robot, "fibws_link_lost_messages_total", hub=hub) == 0


async def test_bytes_that_are_held_have_metrics(start_hub: StartHub) -> None:
    hub = await start_hub()
    async with connected(hub.port) as client:
        await client.send_operation("advertise", topic="/a", type="std_msgs/String", latch=True)
        await client.send(publish("/a", "x" * 996))
        await client.is_processed()
        await client.send(client_header(BINARY, 1000), bytes(500))
        await until(lambda: value(hub, "fibws_held_bytes", part="incoming") >= 500)
        assert value(hub, "fibws_held_bytes", part="latched") == 1000
        assert value(hub, "fibws_latched_bytes") == 1000
        assert value(hub, "fibws_latched_dropped_total") == 0
        assert value(hub, "fibws_held_bytes", part="parameters") > 0
        for part in ("queues", "files", "recording"):
            assert value(hub, "fibws_held_bytes", part=part) == 0


async def test_recording_has_metrics(start_hub: StartHub, tmp_path: Path) -> None:
    assert "fibws_recording" not in families(await start_hub())
    hub = await start_hub(record=tmp_path, record_min_space=0)
    assert value(hub, "fibws_recording") == 1
    assert value(hub, "fibws_recording_failed") == 0
    source = hub.graph.advertise(hub.graph.topic("/n"), "/talker", "std_msgs/Int32")
    source.publish({"data": 1})
    await until(lambda: value(hub, "fibws_recorded_messages_total") == 1)
    assert value(hub, "fibws_recorded_bytes_total") > 4096
    assert value(hub, "fibws_recording_dropped_messages_total") == 0
    complete = asyncio.Event()
    assert hub.recording is not None
    hub.recording.stop(complete.set)
    await complete.wait()
    hub.graph.remove_source(source)
    assert value(hub, "fibws_recording") == 0
    assert value(hub, "fibws_recording_failed") == 0
    assert value(hub, "fibws_recorded_messages_total") == 1
