"""rosapi has the services of the ROS 1 package, with the same names and types."""

from __future__ import annotations

import pytest

from ..fakes import NANOSECONDS
from .rosapi_client import RosapiClient

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
OF_ROS_2 = {
    "action_feedback_details": "ActionFeedbackDetails",
    "action_goal_details": "ActionGoalDetails",
    "action_result_details": "ActionResultDetails",
    "action_type": "ActionType",
    "interfaces": "Interfaces",
}


@pytest.fixture
def rosapi() -> RosapiClient:
    return RosapiClient()


def test_services_are_those_of_ros_1_and_those_of_ros_2_for_actions(rosapi: RosapiClient) -> None:
    own = {
        name.removeprefix("/rosapi/"): service.type.name.removeprefix("rosapi/")
        for name, service in rosapi.graph.services.items()
        if service.type.name.startswith("rosapi/")
    }
    assert own == SERVICES | OF_ROS_2


def test_get_ros_version_is_missing_so_that_clients_do_not_assume_ros_2(
    rosapi: RosapiClient,
) -> None:
    assert "/rosapi/get_ros_version" in rosapi.refusal("/rosapi/get_ros_version")


def test_services_may_be_called_without_a_leading_slash(rosapi: RosapiClient) -> None:
    assert "/rosapi" in rosapi.call("rosapi/nodes")["nodes"]


def test_get_time_returns_the_hubs_time(rosapi: RosapiClient) -> None:
    secs, nsecs = divmod(NANOSECONDS, 10**9)
    assert rosapi.call("/rosapi/get_time") == {"time": {"secs": secs, "nsecs": nsecs}}


@pytest.mark.parametrize(
    ("service", "type_", "expected"),
    [
        ("message_details", "std_msgs/Header", ["std_msgs/Header", "time"]),
        ("service_request_details", "std_srvs/SetBool", ["std_srvs/SetBoolRequest"]),
        ("service_response_details", "std_srvs/SetBool", ["std_srvs/SetBoolResponse"]),
    ],
)
def test_details_of_types_are_returned(
    rosapi: RosapiClient, service: str, type_: str, expected: list[str]
) -> None:
    typedefs = rosapi.call(f"/rosapi/{service}", type=type_)["typedefs"]
    assert [typedef["type"] for typedef in typedefs] == expected


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
def test_unknown_type_is_refused(
    rosapi: RosapiClient, service: str, type_: str, fault: str
) -> None:
    assert fault in rosapi.refusal(f"/rosapi/{service}", type=type_)


def test_unknown_field_is_refused(rosapi: RosapiClient) -> None:
    refused = rosapi.refusal("/rosapi/topic_type", topic="/x", bogus=1)
    assert refused == "Message type rosapi/TopicTypeRequest does not have a field bogus"
