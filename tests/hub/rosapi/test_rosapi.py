"""rosapi offers what the ROS 1 package does, by the same names and types."""

from __future__ import annotations

import pytest

from ..fakes import NANOSECONDS
from .asking import Asking

SERVICES = {
    "action_servers": "GetActionServers",
    "delete_param": "DeleteParam",
    "get_param": "GetParam",
    "get_param_names": "GetParamNames",
    "get_time": "GetTime",
    "has_param": "HasParam",
    "message_details": "MessageDetails",
    "node_details": "NodeDetails",
    "nodes": "Nodes",
    "publishers": "Publishers",
    "search_param": "SearchParam",
    "service_host": "ServiceHost",
    "service_node": "ServiceNode",
    "service_providers": "ServiceProviders",
    "service_request_details": "ServiceRequestDetails",
    "service_response_details": "ServiceResponseDetails",
    "service_type": "ServiceType",
    "services": "Services",
    "services_for_type": "ServicesForType",
    "set_param": "SetParam",
    "subscribers": "Subscribers",
    "topic_type": "TopicType",
    "topics": "Topics",
    "topics_and_raw_types": "TopicsAndRawTypes",
    "topics_for_type": "TopicsForType",
}


@pytest.fixture
def asking() -> Asking:
    return Asking()


def test_its_services_are_those_of_ros_1(asking: Asking) -> None:
    own = {
        name.removeprefix("/rosapi/"): service.type.name.removeprefix("rosapi/")
        for name, service in asking.graph.services.items()
        if service.type.name.startswith("rosapi/")
    }
    assert own == SERVICES


def test_it_is_not_taken_for_ros_2(asking: Asking) -> None:
    refused = asking.is_refused("/rosapi/get_ros_version")
    assert refused == "Service /rosapi/get_ros_version does not exist"


def test_its_services_may_be_called_without_a_slash(asking: Asking) -> None:
    assert "/rosapi" in asking.gets("rosapi/nodes")["nodes"]


def test_the_time_is_that_of_the_hub(asking: Asking) -> None:
    secs, nsecs = divmod(NANOSECONDS, 10**9)
    assert asking.gets("/rosapi/get_time") == {"time": {"secs": secs, "nsecs": nsecs}}


@pytest.mark.parametrize(
    ("service", "type_", "told"),
    [
        ("message_details", "std_msgs/Header", ["std_msgs/Header", "time"]),
        ("service_request_details", "std_srvs/SetBool", ["std_srvs/SetBoolRequest"]),
        ("service_response_details", "std_srvs/SetBool", ["std_srvs/SetBoolResponse"]),
    ],
)
def test_types_are_told_in_detail(
    asking: Asking, service: str, type_: str, told: list[str]
) -> None:
    typedefs = asking.gets(f"/rosapi/{service}", type=type_)["typedefs"]
    assert [typedef["type"] for typedef in typedefs] == told


@pytest.mark.parametrize(
    "service", ["message_details", "service_request_details", "service_response_details"]
)
@pytest.mark.parametrize(
    ("type_", "fault"),
    [
        ("", " is not a valid type string"),
        ("Thing", "Thing is not a valid type string"),
        ("nowhere_msgs/Thing", "Unable to load the manifest for package nowhere_msgs. Caused by"),
        ("std_msgs/Thing", " class Thing from package std_msgs. Caused by"),
    ],
)
def test_a_type_that_nobody_defined_is_refused(
    asking: Asking, service: str, type_: str, fault: str
) -> None:
    assert fault in asking.is_refused(f"/rosapi/{service}", type=type_)


def test_an_unknown_field_is_refused(asking: Asking) -> None:
    refused = asking.is_refused("/rosapi/topic_type", topic="/x", bogus=1)
    assert refused == "Message type rosapi/TopicTypeRequest does not have a field bogus"
