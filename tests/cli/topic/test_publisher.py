"""A topic that a tool publishes, at a real hub."""

from __future__ import annotations

import time
from itertools import repeat
from typing import Any

import pytest
from hub_in_thread import HubThread

from fibws.cli.topic.publisher import Publisher
from fibws.client.hub_client import HubClient
from fibws.errors import OperationRejected


@pytest.fixture
def ear(hub: HubThread, client: HubClient) -> HubClient:
    """Hears /number."""
    client.subscribe("/number")
    client.call("/rosapi/get_time")
    return client


def test_a_published_message_is_sent_on_by_then(hub: HubThread, ear: HubClient) -> None:
    with HubClient("pub", hub.url) as client:
        publisher = Publisher(client, "/number", "std_msgs/Int32", latch=False)
        publisher.publish({"data": 8})
        ear.call("/rosapi/get_time")
        assert next(ear.messages("/number", 0)) == {"data": 8}


def test_messages_come_at_a_rate(hub: HubThread, ear: HubClient) -> None:
    with HubClient("pub", hub.url) as client:
        publisher = Publisher(client, "/number", "std_msgs/Int32", latch=False)
        began = time.monotonic()
        publisher.publish_all(repeat({"data": 8}, 5), 50)
        assert time.monotonic() - began >= 0.1
        ear.call("/rosapi/get_time")
        assert len(list(ear.messages("/number", 0))) == 5


def test_what_the_hub_refuses_raises(hub: HubThread) -> None:
    messages: list[dict[str, Any]] = [{"data": 1}, {"data": "x"}]
    with HubClient("pub", hub.url) as client:
        with pytest.raises(OperationRejected, match="did you mean std_msgs/String"):
            Publisher(client, "/x", "std_msgs/Strin", latch=False)
        publisher = Publisher(client, "/number", "std_msgs/Int32", latch=False)
        with pytest.raises(OperationRejected, match="field data"):
            publisher.publish({"data": "x"})
        with pytest.raises(OperationRejected, match="field data"):
            publisher.publish_all(iter(messages), 1000)


def test_a_type_that_nobody_defined_is_warned_of(
    hub: HubThread, capsys: pytest.CaptureFixture[str]
) -> None:
    with HubClient("pub", hub.url) as client:
        Publisher(client, "/odd", "nobodys_msgs/Type", latch=False).publish({"a": 1})
    warning = "WARNING: nobody has defined nobodys_msgs/Type: messages are not checked\n"
    assert capsys.readouterr().err == warning
