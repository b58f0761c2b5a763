"""/rosapi/statistics: totals of publishers, subscriptions and clients."""

from __future__ import annotations

import json
from typing import Any

import cbor2
import pytest

from ..fakes import INT32, NANOSECONDS, Client, fragment
from .rosapi_client import RosapiClient

TEXT = '{"op":"publish","topic":"/fib","msg":{"data":8}}'
INVALID = '{"op":"publish","topic":"/fib","msg":{"data":"x"}}'


@pytest.fixture
def rosapi() -> RosapiClient:
    return RosapiClient()


def talker(rosapi: RosapiClient, node: str = "/talker", **advertise: Any) -> Client:
    client = rosapi.add_client(node)
    client.send("advertise", "/fib", type=INT32, **advertise)
    return client


def listener(rosapi: RosapiClient, node: str = "/listener", **subscribe: Any) -> Client:
    client = rosapi.add_client(node)
    client.send("subscribe", "/fib", **subscribe)
    return client


def topic(rosapi: RosapiClient, name: str = "/fib") -> dict[str, Any]:
    topics = rosapi.call("/rosapi/statistics")["topics"]
    (found,) = [each for each in topics if each["topic"] == name]
    assert isinstance(found, dict)
    return found


def published(rosapi: RosapiClient, name: str = "/fib") -> dict[str, tuple[int, int]]:
    """The messages and bytes of each publisher."""
    found = topic(rosapi, name)["publishers"]
    return {each["node"]: (each["messages"], each["bytes"]) for each in found}


def received(rosapi: RosapiClient) -> dict[str, int]:
    """The messages of each subscription; none may have been dropped."""
    found = topic(rosapi)["subscriptions"]
    assert not any(each["dropped"] for each in found)
    return {each["node"]: each["messages"] for each in found}


def test_response_has_the_time_and_the_revision(rosapi: RosapiClient) -> None:
    found = rosapi.call("/rosapi/statistics")
    secs, nsecs = divmod(NANOSECONDS, 10**9)
    assert found["stamp"] == {"secs": secs, "nsecs": nsecs}
    assert found["revision"] == rosapi.call("/rosapi/graph")["revision"]


def test_topics_nodes_and_clients_are_sorted(rosapi: RosapiClient) -> None:
    for node in ("/b", "/a"):
        talker(rosapi, node).send("subscribe", "/fib")
        rosapi.connect(f"{node}/connected")
    found = rosapi.call("/rosapi/statistics")
    names = [each["topic"] for each in found["topics"]]
    assert names == sorted(rosapi.graph.topics)
    assert [each["node"] for each in topic(rosapi)["publishers"]] == ["/a", "/b"]
    assert [each["node"] for each in topic(rosapi)["subscriptions"]] == ["/a", "/b"]
    assert [each["node"] for each in found["clients"]] == ["/a/connected", "/b/connected"]


# Publishers.


def test_messages_and_bytes_of_a_publisher_are_counted(
    rosapi: RosapiClient,
) -> None:
    client = talker(rosapi)
    assert published(rosapi) == {"/talker": (0, 0)}
    for count in (1, 2, 3):
        client.send_text(TEXT)
        assert published(rosapi) == {"/talker": (count, count * len(TEXT))}


def test_each_publisher_is_counted_by_itself(rosapi: RosapiClient) -> None:
    one, two = talker(rosapi, "/one"), talker(rosapi, "/two")
    one.send_text(TEXT)
    two.send_text(f" {TEXT}")
    two.send_text(TEXT)
    assert published(rosapi) == {"/one": (1, len(TEXT)), "/two": (2, 2 * len(TEXT) + 1)}


def test_invalid_message_is_not_counted(rosapi: RosapiClient) -> None:
    talker(rosapi).send_text(INVALID)
    assert published(rosapi) == {"/talker": (0, 0)}


def test_bytes_of_several_operations_in_one_text_count_once(rosapi: RosapiClient) -> None:
    talker(rosapi).send_text(TEXT * 3)
    assert published(rosapi) == {"/talker": (3, 3 * len(TEXT))}


def test_cbor_message_counts_with_its_own_bytes(rosapi: RosapiClient) -> None:
    data = cbor2.dumps(json.loads(TEXT))
    talker(rosapi).send_binary(data)
    assert published(rosapi) == {"/talker": (1, len(data))}


def test_text_in_a_binary_frame_counts_with_the_bytes_of_the_text(rosapi: RosapiClient) -> None:
    talker(rosapi).send_binary(TEXT.encode())
    assert published(rosapi) == {"/talker": (1, len(TEXT))}


def test_fragments_count_with_the_bytes_of_the_whole_text(rosapi: RosapiClient) -> None:
    client = talker(rosapi)
    fragment(client, TEXT[:10], 0, 2)
    assert published(rosapi) == {"/talker": (0, 0)}
    fragment(client, TEXT[10:], 1, 2)
    assert published(rosapi) == {"/talker": (1, len(TEXT))}


def test_message_that_was_not_advertised_counts_with_the_bytes_of_its_json(
    rosapi: RosapiClient,
) -> None:
    listener(rosapi, type=INT32)
    client = rosapi.add_client("/talker")
    client.send_text(TEXT)
    own = len(b'{"data":8}')
    assert published(rosapi) == {"/talker": (1, own)}
    client.send_text(TEXT)
    assert published(rosapi) == {"/talker": (2, own + len(TEXT))}


def test_pending_message_counts_when_it_is_published(rosapi: RosapiClient) -> None:
    client = rosapi.add_client("/talker")
    client.send_text(TEXT)
    client.send("advertise", "/fib", type=INT32)
    assert published(rosapi)["/talker"][0] == 1


def test_renewed_advertisement_starts_from_zero(rosapi: RosapiClient) -> None:
    client = talker(rosapi)
    listener(rosapi)
    client.send_text(TEXT)
    client.send("unadvertise", "/fib")
    assert not published(rosapi)
    client.send("advertise", "/fib", type=INT32)
    assert published(rosapi) == {"/talker": (0, 0)}


def test_second_advertisement_does_not_change_the_totals(rosapi: RosapiClient) -> None:
    client = talker(rosapi, id="1")
    client.send_text(TEXT)
    client.send("advertise", "/fib", type=INT32, id="2")
    client.send("unadvertise", "/fib", id="1")
    assert published(rosapi) == {"/talker": (1, len(TEXT))}


def test_messages_of_the_hub_count_with_the_bytes_of_their_json(rosapi: RosapiClient) -> None:
    rosapi.add_client("/listener").send("subscribe", "/client_count")
    assert published(rosapi, "/client_count") == {"/rosbridge_websocket": (0, 0)}
    rosapi.connect()
    size = len(b'{"data":1}')
    assert published(rosapi, "/client_count") == {"/rosbridge_websocket": (1, size)}


# Subscriptions.


@pytest.mark.parametrize("compression", ["none", "png", "cbor", "cbor-raw"])
def test_each_message_counts_for_every_present_subscription(
    rosapi: RosapiClient, compression: str
) -> None:
    client = talker(rosapi)
    listener(rosapi, "/first", compression=compression)
    client.send_text(TEXT)
    listener(rosapi, "/second", compression=compression)
    assert received(rosapi) == {"/first": 1, "/second": 0}
    client.send_text(TEXT * 2)
    assert received(rosapi) == {"/first": 3, "/second": 2}


def test_subscription_counts_the_messages_of_all_publishers(rosapi: RosapiClient) -> None:
    listener(rosapi)
    for node in ("/one", "/two"):
        talker(rosapi, node).send_text(TEXT)
    assert received(rosapi) == {"/listener": 2}


def test_subscriptions_of_all_encodings_and_spellings_are_counted(rosapi: RosapiClient) -> None:
    client = talker(rosapi)
    listener(rosapi, "/text")
    listener(rosapi, "/cbor", compression="cbor")
    listener(rosapi, "/pieces", fragment_size=10)
    rosapi.add_client("/relative").send("subscribe", "fib")
    client.send_text(TEXT)
    assert received(rosapi) == {"/text": 1, "/cbor": 1, "/pieces": 1, "/relative": 1}


def test_latched_message_counts_for_a_late_subscriber(rosapi: RosapiClient) -> None:
    talker(rosapi, latch=True).send_text(TEXT)
    listener(rosapi)
    assert received(rosapi) == {"/listener": 1}
    assert published(rosapi)["/talker"][0] == 1


def test_throttled_subscription_counts_the_messages_it_gets(rosapi: RosapiClient) -> None:
    client = talker(rosapi)
    listener(rosapi, throttle_rate=100)
    client.send_text(TEXT * 3)
    assert received(rosapi) == {"/listener": 1}
    rosapi.hub.clock.advance(0.1)
    client.send_text(TEXT * 3)
    assert received(rosapi) == {"/listener": 2}


def test_message_that_waits_for_a_throttle_counts_when_it_is_sent(rosapi: RosapiClient) -> None:
    client = talker(rosapi)
    listener(rosapi, throttle_rate=100, queue_length=2)
    client.send_text(TEXT * 5)
    assert received(rosapi) == {"/listener": 1}
    rosapi.hub.clock.advance(1)
    assert received(rosapi) == {"/listener": 3}


def test_subscription_that_changes_keeps_its_total(rosapi: RosapiClient) -> None:
    client = talker(rosapi)
    other = listener(rosapi, "/other", compression="cbor")
    changing = listener(rosapi, id="only")
    client.send_text(TEXT)
    for options in (
        {"compression": "cbor"},
        {"throttle_rate": 100},
        {"throttle_rate": 0},
        {"compression": "png"},
        {},
    ):
        before = received(rosapi)["/listener"]
        changing.send("subscribe", "/fib", id="only", **options)
        assert received(rosapi)["/listener"] == before
        client.send_text(TEXT)
        assert received(rosapi)["/listener"] == before + 1
        rosapi.hub.clock.advance(1)
    assert received(rosapi)["/other"] == published(rosapi)["/talker"][0]
    assert other.receive_cbor()


def test_renewed_subscription_starts_from_zero(rosapi: RosapiClient) -> None:
    client = talker(rosapi)
    client_2 = listener(rosapi)
    client.send_text(TEXT)
    client_2.send("unsubscribe", "/fib")
    client.send_text(TEXT)
    assert not received(rosapi)
    client_2.send("subscribe", "/fib")
    assert received(rosapi) == {"/listener": 0}
    client.send_text(TEXT)
    assert received(rosapi) == {"/listener": 1}


def test_message_that_cannot_be_encoded_is_not_counted_as_sent(rosapi: RosapiClient) -> None:
    listener(rosapi, compression="cbor-raw")
    client = rosapi.add_client("/talker")
    client.send("advertise", "/fib", type="my_msgs/Number")
    client.send_text(TEXT)
    assert received(rosapi) == {"/listener": 0}
    assert published(rosapi)["/talker"][0] == 1


def test_messages_dropped_for_a_slow_client_are_counted(rosapi: RosapiClient) -> None:
    client = talker(rosapi)
    slow = listener(rosapi, queue_length=2)
    quick = listener(rosapi, "/quick")
    slow.queue.pause()
    client.send_text(TEXT * 5)
    assert topic(rosapi)["subscriptions"] == [
        {"node": "/listener", "messages": 5, "dropped": 3, "throttled": 0},
        {"node": "/quick", "messages": 5, "dropped": 0, "throttled": 0},
    ]
    assert len(quick.receive()) == 5
    slow.queue.resume()
    assert len(slow.receive()) == 2


def test_messages_left_out_by_a_throttle_are_counted_and_not_as_dropped(
    rosapi: RosapiClient,
) -> None:
    client = talker(rosapi)
    listener(rosapi, throttle_rate=1000)
    client.send_text(TEXT * 5)
    assert topic(rosapi)["subscriptions"] == [
        {"node": "/listener", "messages": 1, "dropped": 0, "throttled": 4}
    ]


# Clients.


def test_clients_have_their_address_and_the_state_of_their_queue(rosapi: RosapiClient) -> None:
    connection = rosapi.connect("/slow")
    connection.client.send("subscribe", "/fib", queue_length=1)
    client = talker(rosapi)

    def listed() -> list[dict[str, Any]]:
        clients = rosapi.call("/rosapi/statistics")["clients"]
        assert isinstance(clients, list)
        return clients

    quick = {
        "node": "/slow",
        "address": "10.0.0.1:50001",
        "principal": "",
        "protocol": "rosbridge",
        "since": {"secs": NANOSECONDS // 10**9, "nsecs": NANOSECONDS % 10**9},
        "messages_received": 3,
        "bytes_received": 300,
        "messages_sent": 0,
        "bytes_sent": 0,
        "kept_bytes": 0,
        "dropped": 0,
        "limited": 2,
        "subscriptions": 1,
        "advertisements": 0,
        "slow": False,
    }
    assert listed() == [quick]
    connection.queue.pause()
    client.send_text(TEXT * 3)
    frame = 2 + len(TEXT)
    assert listed() == [{**quick, "kept_bytes": frame, "dropped": 2, "slow": True}]
    connection.queue.resume()
    sent = {"messages_sent": 1, "bytes_sent": frame}
    assert listed() == [{**quick, "dropped": 2, **sent}]


def test_clients_that_have_left_the_graph_are_not_listed(rosapi: RosapiClient) -> None:
    rosapi.connect("/talker")
    rosapi.connect("/talker")
    leaving = rosapi.connect("/leaving")
    leaving.client.disconnect()
    clients = rosapi.call("/rosapi/statistics")["clients"]
    assert [(each["node"], each["address"]) for each in clients] == [("/talker", "10.0.0.1:50002")]


def test_large_response_is_reused_for_a_moment(rosapi: RosapiClient) -> None:
    client = rosapi.add_client("/many")
    for number in range(3000):
        client.send("advertise", f"/topic_{number}", type=INT32)
    found = rosapi.call("/rosapi/statistics")
    client.send("publish", "/topic_0", msg={"data": 8})
    assert rosapi.call("/rosapi/statistics") == found
