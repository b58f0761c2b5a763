"""``fibws topic bw``; `test_side_by_side` compares its output with rostopic's."""

from __future__ import annotations

import json
import threading

import pytest
from client.servers import websocket_server
from hub_in_thread import Publish, Run
from websockets.sync.server import ServerConnection

from fibws.cli.topic import bw
from fibws.cli.topic.bw import Bandwidth
from fibws.client.hub_client import RawMessage
from fibws.values.rates import Summary


def test_bandwidth_is_bytes_divided_by_the_time_since_the_oldest() -> None:
    bandwidth = Bandwidth()
    for moment in (10.0, 11.0):
        bandwidth.add(100, moment)
    measured = bandwidth.at(12.0)
    assert measured is not None
    rate, sizes, number = measured
    assert (rate, sizes.mean, number) == (100.0, 100.0, 2)


def test_one_message_has_no_bandwidth() -> None:
    bandwidth = Bandwidth()
    bandwidth.receive(RawMessage(b"{}", None))
    assert bandwidth.at(1e9) is None


def test_only_the_latest_messages_are_measured() -> None:
    bandwidth = Bandwidth(2)
    for size, moment in ((1000, 0.0), (10, 1.0), (20, 2.0)):
        bandwidth.add(size, moment)
    measured = bandwidth.at(2.0)
    assert measured is not None
    assert (measured[0], measured[2]) == (30.0, 2)


@pytest.mark.parametrize(
    ("rate", "printed"),
    [
        (12.0, "average: 12.00B/s\n\tmean: 1500.00B min: 1000.00B max: 2000.00B window: 2"),
        (5340.0, "average: 5.34KB/s\n\tmean: 1.50KB min: 1.00KB max: 2.00KB window: 2"),
        (2.5e6, "average: 2.50MB/s\n\tmean: 0.00MB min: 0.00MB max: 0.00MB window: 2"),
    ],
)
def test_all_numbers_have_the_same_unit(rate: float, printed: str) -> None:
    assert bw.text(rate, Summary(1500, 1000, 2000, 500), 2) == printed


def test_bytes_of_serialized_messages_are_counted(run: Run, publish: Publish) -> None:
    client = publish("/number", "std_msgs/Int32", {"data": 8})

    def publish_more() -> None:
        while not client.call("/rosapi/subscribers", {"topic": "/number"})["subscribers"]:
            pass
        for _ in range(3):
            client.send({"op": "publish", "topic": "/number", "msg": {"data": 8}})

    thread = threading.Thread(target=publish_more)
    thread.start()
    result = run("topic", "bw", "-n", "1", "--json", "/number")
    thread.join(60)
    found = json.loads(result.output)
    assert found["mean"] == found["min"] == found["max"] == 4
    assert 2 <= found["window"] <= 4
    assert found["rate"] > 0


def test_bytes_of_json_are_counted_with_a_plain_rosbridge_server(run: Run) -> None:
    def reply(connection: ServerConnection) -> None:
        for text in connection:
            request = json.loads(text)
            if request["op"] == "subscribe":
                assert "compression" not in request
                for _ in range(2):
                    connection.send('{"op":"publish","topic":"/number","msg":{"data":8}}')
            elif request["op"] == "call_service":
                is_known = request["service"] == "/rosapi/topic_type"
                response = {"op": "service_response", "id": request["id"], "result": is_known}
                response["values"] = {"type": "std_msgs/Int32"} if is_known else "unknown"
                connection.send(json.dumps(response))

    with websocket_server(reply) as url:
        result = run("topic", "bw", "-n", "1", "--json", "--hub", url, "/number")
    found = json.loads(result.output)
    assert found["mean"] == found["min"] == found["max"] == len('{"data":8}')
    assert found["window"] == 2
