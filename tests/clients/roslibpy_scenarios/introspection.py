"""Requests of roslibpy about the graph."""

from __future__ import annotations

from typing import Any

from patience import PATIENCE
from roslibpy import Service, ServiceRequest, Topic

from .world import World

ADD = "rospy_tutorials/AddTwoInts"


def topics_and_their_types_are_listed(world: World) -> Any:
    ros = _graph(world, "/listed")
    topics = {"number": "/listed/number", "text": "/listed/text", "log": "/rosout"}
    assert set(topics.values()) <= set(ros.get_topics())
    return {key: ros.get_topic_type(topic) for key, topic in topics.items()}


def topics_can_be_found_by_type_and_types_by_topic(world: World) -> Any:
    ros = _graph(world, "/found")
    topics = ros.get_topics_for_type("std_msgs/Int16")
    return {
        "topics": [topic for topic in topics if topic.startswith("/found")],
        "type": ros.get_topic_type("/found/number"),
        "none": ros.get_topic_type("/found/nowhere"),
    }


def services_can_be_listed_and_found_by_type_and_types_by_service(world: World) -> Any:
    ros = _graph(world, "/served")
    services, found = ros.get_services(), ros.get_services_for_type("std_srvs/SetBool")
    return {
        "listed": [service for service in services if service.startswith("/served")],
        "ours": "/rosapi/topics" in services,
        "found": [service for service in found if service.startswith("/served")],
        "type": ros.get_service_type("/served/switch"),
        "none": ros.get_service_type("/served/nowhere"),
    }


def nodes_are_listed_with_their_details(world: World) -> Any:
    ros = _graph(world, "/looked_into")
    nodes = ros.get_nodes()
    return {
        "nodes": [node in nodes for node in ("/looked_into", "/rosapi", "/rosout")],
        **ros.get_node_details("/looked_into"),
    }


def message_type_is_described_field_by_field(world: World) -> Any:
    ros = world.connect()
    pose = ros.get_message_details("geometry_msgs/PoseStamped")["typedefs"]
    return {
        "fix": ros.get_message_details("sensor_msgs/NavSatFix")["typedefs"][0],
        "pose": [typedef["type"] for typedef in pose],
    }


def service_type_is_described_field_by_field(world: World) -> Any:
    ros = world.connect()
    return {
        "request": ros.get_service_request_details(ADD)["typedefs"],
        "response": ros.get_service_response_details(ADD)["typedefs"],
    }


def all_definitions_are_returned_at_once(world: World) -> Any:
    ros = _graph(world, "/defined")
    service = Service(ros, "/rosapi/topics_and_raw_types", "rosapi/TopicsAndRawTypes")
    answer = service.call(ServiceRequest(), timeout=PATIENCE)
    types = dict(zip(answer["topics"], answer["types"], strict=True))
    texts = dict(zip(answer["topics"], answer["typedefs_full_text"], strict=True))
    return {
        "type": types["/defined/number"],
        "number": texts["/defined/number"].strip(),
        "log": f"{'=' * 80}\nMSG: std_msgs/Header\n" in texts["/rosout"],
    }


def _graph(world: World, name: str) -> Any:
    """A client by that name which publishes, subscribes and serves below it."""
    ros = world.connect(node=name)
    Topic(ros, f"{name}/number", "std_msgs/Int16").advertise()
    Topic(ros, f"{name}/text", "std_msgs/String").subscribe(lambda _: None)
    Service(ros, f"{name}/switch", "std_srvs/SetBool").advertise(lambda *_: True)
    world.settled(ros)
    return ros
