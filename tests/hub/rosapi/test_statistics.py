"""What went over each topic, and how each client keeps up."""

from __future__ import annotations

import json
from typing import Any

import cbor2
import pytest

from ..fakes import INT32, NANOSECONDS, Client, fragment
from .asking import Asking

TEXT = '{"op":"publish","topic":"/fib","msg":{"data":8}}'
IMPOSSIBLE = '{"op":"publish","topic":"/fib","msg":{"data":"x"}}'


@pytest.fixture
def asking() -> Asking:
    return Asking()


def talker(asking: Asking, node: str = "/talker", **advertise: Any) -> Client:
    client = asking.joins(node)
    client.says("advertise", "/fib", type=INT32, **advertise)
    return client


def listener(asking: Asking, node: str = "/listener", **subscribe: Any) -> Client:
    client = asking.joins(node)
    client.says("subscribe", "/fib", **subscribe)
    return client


def topic(asking: Asking, name: str = "/fib") -> dict[str, Any]:
    told = asking.gets("/rosapi/statistics")
    (found,) = [each for each in told["topics"] if each["topic"] == name]
    assert isinstance(found, dict)
    return found


def published(asking: Asking, name: str = "/fib") -> dict[str, tuple[int, int]]:
    """The messages and bytes of each publisher."""
    found = topic(asking, name)["publishers"]
    return {each["node"]: (each["messages"], each["bytes"]) for each in found}


def heard(asking: Asking) -> dict[str, int]:
    """The messages of each subscription, of which none was dropped."""
    found = topic(asking)["subscriptions"]
    assert not any(each["dropped"] for each in found)
    return {each["node"]: each["messages"] for each in found}


def test_it_says_when_and_of_which_graph(asking: Asking) -> None:
    told = asking.gets("/rosapi/statistics")
    secs, nsecs = divmod(NANOSECONDS, 10**9)
    assert told["stamp"] == {"secs": secs, "nsecs": nsecs}
    assert told["revision"] == asking.gets("/rosapi/graph")["revision"]


def test_topics_nodes_and_clients_are_in_order(asking: Asking) -> None:
    for node in ("/b", "/a"):
        talker(asking, node).says("subscribe", "/fib")
        asking.connects(f"{node}/connected")
    told = asking.gets("/rosapi/statistics")
    names = [each["topic"] for each in told["topics"]]
    assert names == sorted(asking.graph.topics)
    assert [each["node"] for each in topic(asking)["publishers"]] == ["/a", "/b"]
    assert [each["node"] for each in topic(asking)["subscriptions"]] == ["/a", "/b"]
    assert [each["node"] for each in told["clients"]] == ["/a/connected", "/b/connected"]


# Publishers.


def test_a_publishers_messages_and_the_bytes_of_their_operations_are_counted(
    asking: Asking,
) -> None:
    client = talker(asking)
    assert published(asking) == {"/talker": (0, 0)}
    for count in (1, 2, 3):
        client.says_text(TEXT)
        assert published(asking) == {"/talker": (count, count * len(TEXT))}


def test_each_publisher_counts_its_own(asking: Asking) -> None:
    one, two = talker(asking, "/one"), talker(asking, "/two")
    one.says_text(TEXT)
    two.says_text(f" {TEXT}")
    two.says_text(TEXT)
    assert published(asking) == {"/one": (1, len(TEXT)), "/two": (2, 2 * len(TEXT) + 1)}


def test_what_does_not_fit_the_type_is_not_published(asking: Asking) -> None:
    talker(asking).says_text(IMPOSSIBLE)
    assert published(asking) == {"/talker": (0, 0)}


def test_the_bytes_of_several_operations_in_one_text_count_once(asking: Asking) -> None:
    talker(asking).says_text(TEXT * 3)
    assert published(asking) == {"/talker": (3, 3 * len(TEXT))}


def test_cbor_counts_by_its_own_bytes(asking: Asking) -> None:
    data = cbor2.dumps(json.loads(TEXT))
    talker(asking).says_binary(data)
    assert published(asking) == {"/talker": (1, len(data))}


def test_text_in_a_binary_frame_counts_by_the_texts_bytes(asking: Asking) -> None:
    talker(asking).says_binary(TEXT.encode())
    assert published(asking) == {"/talker": (1, len(TEXT))}


def test_fragments_count_by_the_text_that_they_make(asking: Asking) -> None:
    client = talker(asking)
    fragment(client, TEXT[:10], 0, 2)
    assert published(asking) == {"/talker": (0, 0)}
    fragment(client, TEXT[10:], 1, 2)
    assert published(asking) == {"/talker": (1, len(TEXT))}


def test_a_message_that_nothing_announced_counts_by_its_own_json(asking: Asking) -> None:
    listener(asking, type=INT32)
    client = asking.joins("/talker")
    client.says_text(TEXT)
    own = len(b'{"data":8}')
    assert published(asking) == {"/talker": (1, own)}
    client.says_text(TEXT)
    assert published(asking) == {"/talker": (2, own + len(TEXT))}


def test_a_message_that_came_too_early_counts_once_it_is_published(asking: Asking) -> None:
    client = asking.joins("/talker")
    client.says_text(TEXT)
    client.says("advertise", "/fib", type=INT32)
    assert published(asking)["/talker"][0] == 1


def test_who_advertises_anew_begins_anew(asking: Asking) -> None:
    client = talker(asking)
    listener(asking)
    client.says_text(TEXT)
    client.says("unadvertise", "/fib")
    assert not published(asking)
    client.says("advertise", "/fib", type=INT32)
    assert published(asking) == {"/talker": (0, 0)}


def test_a_second_advertisement_changes_nothing(asking: Asking) -> None:
    client = talker(asking, id="1")
    client.says_text(TEXT)
    client.says("advertise", "/fib", type=INT32, id="2")
    client.says("unadvertise", "/fib", id="1")
    assert published(asking) == {"/talker": (1, len(TEXT))}


def test_the_hubs_own_messages_count_by_their_json(asking: Asking) -> None:
    asking.joins("/listener").says("subscribe", "/client_count")
    assert published(asking, "/client_count") == {"/rosbridge_websocket": (0, 0)}
    asking.connects()
    size = len(b'{"data":1}')
    assert published(asking, "/client_count") == {"/rosbridge_websocket": (1, size)}


# Subscriptions.


@pytest.mark.parametrize("compression", ["none", "png", "cbor", "cbor-raw"])
def test_each_message_counts_for_every_subscription_since_that_came(
    asking: Asking, compression: str
) -> None:
    client = talker(asking)
    listener(asking, "/first", compression=compression)
    client.says_text(TEXT)
    listener(asking, "/second", compression=compression)
    assert heard(asking) == {"/first": 1, "/second": 0}
    client.says_text(TEXT * 2)
    assert heard(asking) == {"/first": 3, "/second": 2}


def test_all_publishers_of_a_topic_count_for_its_subscriptions(asking: Asking) -> None:
    listener(asking)
    for node in ("/one", "/two"):
        talker(asking, node).says_text(TEXT)
    assert heard(asking) == {"/listener": 2}


def test_subscriptions_of_several_encodings_and_spellings_count_alike(asking: Asking) -> None:
    client = talker(asking)
    listener(asking, "/text")
    listener(asking, "/cbor", compression="cbor")
    listener(asking, "/pieces", fragment_size=10)
    asking.joins("/relative").says("subscribe", "fib")
    client.says_text(TEXT)
    assert heard(asking) == {"/text": 1, "/cbor": 1, "/pieces": 1, "/relative": 1}


def test_what_is_latched_counts_for_who_comes_late(asking: Asking) -> None:
    talker(asking, latch=True).says_text(TEXT)
    listener(asking)
    assert heard(asking) == {"/listener": 1}
    assert published(asking)["/talker"][0] == 1


def test_a_throttled_subscription_counts_what_passes(asking: Asking) -> None:
    client = talker(asking)
    listener(asking, throttle_rate=100)
    client.says_text(TEXT * 3)
    assert heard(asking) == {"/listener": 1}
    asking.hub.clock.advance(0.1)
    client.says_text(TEXT * 3)
    assert heard(asking) == {"/listener": 2}


def test_what_waits_for_the_throttle_counts_when_its_turn_has_come(asking: Asking) -> None:
    client = talker(asking)
    listener(asking, throttle_rate=100, queue_length=2)
    client.says_text(TEXT * 5)
    assert heard(asking) == {"/listener": 1}
    asking.hub.clock.advance(1)
    assert heard(asking) == {"/listener": 3}


def test_a_subscription_that_changes_goes_on_counting(asking: Asking) -> None:
    client = talker(asking)
    other = listener(asking, "/other", compression="cbor")
    changing = listener(asking, id="only")
    client.says_text(TEXT)
    for wish in (
        {"compression": "cbor"},
        {"throttle_rate": 100},
        {"throttle_rate": 0},
        {"compression": "png"},
        {},
    ):
        before = heard(asking)["/listener"]
        changing.says("subscribe", "/fib", id="only", **wish)
        assert heard(asking)["/listener"] == before
        client.says_text(TEXT)
        assert heard(asking)["/listener"] == before + 1
        asking.hub.clock.advance(1)
    assert heard(asking)["/other"] == published(asking)["/talker"][0]
    assert other.hears_cbor()


def test_who_subscribes_anew_begins_anew(asking: Asking) -> None:
    client = talker(asking)
    quitter = listener(asking)
    client.says_text(TEXT)
    quitter.says("unsubscribe", "/fib")
    client.says_text(TEXT)
    assert not heard(asking)
    quitter.says("subscribe", "/fib")
    assert heard(asking) == {"/listener": 0}
    client.says_text(TEXT)
    assert heard(asking) == {"/listener": 1}


def test_a_message_that_cannot_be_encoded_counts_for_nobody(asking: Asking) -> None:
    listener(asking, compression="cbor-raw")
    client = asking.joins("/talker")
    client.says("advertise", "/fib", type="my_msgs/Number")
    client.says_text(TEXT)
    assert heard(asking) == {"/listener": 0}
    assert published(asking)["/talker"][0] == 1


def test_what_a_slow_client_loses_is_told(asking: Asking) -> None:
    client = talker(asking)
    slow = listener(asking, queue_length=2)
    quick = listener(asking, "/quick")
    slow.outbox.pause()
    client.says_text(TEXT * 5)
    assert topic(asking)["subscriptions"] == [
        {"node": "/listener", "messages": 5, "dropped": 3},
        {"node": "/quick", "messages": 5, "dropped": 0},
    ]
    assert len(quick.hears()) == 5
    slow.outbox.resume()
    assert len(slow.hears()) == 2


# Clients.


def test_a_client_has_an_address_and_what_is_kept_for_it(asking: Asking) -> None:
    connection = asking.connects("/slow")
    connection.client.says("subscribe", "/fib", queue_length=1)
    client = talker(asking)

    def told() -> list[dict[str, Any]]:
        clients = asking.gets("/rosapi/statistics")["clients"]
        assert isinstance(clients, list)
        return clients

    quick = {
        "node": "/slow",
        "address": "10.0.0.1:50001",
        "kept_bytes": 0,
        "dropped": 0,
        "slow": False,
    }
    assert told() == [quick]
    connection.outbox.pause()
    client.says_text(TEXT * 3)
    frame = 2 + len(TEXT)
    assert told() == [{**quick, "kept_bytes": frame, "dropped": 2, "slow": True}]
    connection.outbox.resume()
    assert told() == [{**quick, "dropped": 2}]


def test_clients_that_have_left_the_graph_are_not_told(asking: Asking) -> None:
    asking.connects("/talker")
    asking.connects("/talker")
    leaving = asking.connects("/leaving")
    leaving.client.leaves()
    clients = asking.gets("/rosapi/statistics")["clients"]
    assert [(each["node"], each["address"]) for each in clients] == [("/talker", "10.0.0.1:50002")]


def test_large_totals_are_not_counted_again_for_each_of_many_that_ask(asking: Asking) -> None:
    client = asking.joins("/many")
    for number in range(3000):
        client.says("advertise", f"/topic_{number}", type=INT32)
    told = asking.gets("/rosapi/statistics")
    client.says("publish", "/topic_0", msg={"data": 8})
    assert asking.gets("/rosapi/statistics") == told
