"""Completion of names from a real hub, and of types from files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import click
import pytest
from click.shell_completion import CompletionItem
from hub_in_thread import HubThread, Publish

from fibws.cli import completers
from fibws.client.hub_client import HubClient

Items: TypeAlias = list[tuple[str, str | None]]


def completed(
    of: Callable[..., list[CompletionItem]], incomplete: str, hub: str = "", topic: str = ""
) -> Items:
    context = click.Context(click.Command("echo"))
    context.params |= {"hub": hub or None, "topic": topic or None}
    items = of(context, click.Argument(["name"]), incomplete)
    return [(item.value, item.help) for item in items]


@pytest.fixture(autouse=True)
def at_hub(hub: HubThread, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", hub.url)
    monkeypatch.delenv("ROS_NAMESPACE", raising=False)
    monkeypatch.setattr(completers, "PATIENCE", 20.0)  # For slow machines.


def test_topics_come_with_their_types(publish: Publish) -> None:
    publish("/fibonacci", "std_msgs/Int32", {"data": 8})
    assert completed(completers.topics, "/fib") == [("/fibonacci", "std_msgs/Int32")]
    assert ("/rosout", "rosgraph_msgs/Log") in completed(completers.topics, "")


def test_names_may_be_relative(publish: Publish, monkeypatch: pytest.MonkeyPatch) -> None:
    publish("/robot/scan", "std_msgs/Int32", {"data": 8})
    assert completed(completers.topics, "robot/s") == [("robot/scan", "std_msgs/Int32")]
    monkeypatch.setenv("ROS_NAMESPACE", "/robot")
    assert completed(completers.topics, "s") == [("scan", "std_msgs/Int32")]
    monkeypatch.setenv("ROS_NAMESPACE", "3x")
    assert completed(completers.topics, "robot/s") == []


def test_nodes_exclude_the_shell_itself(client: HubClient) -> None:
    assert completed(completers.nodes, "/fibws") == [(client.node, None)]


def test_services_come_with_their_types(client: HubClient) -> None:
    client.send({"op": "advertise_service", "service": "/add", "type": "std_srvs/Trigger"})
    client.call("/rosapi/get_time")
    assert completed(completers.services, "/a") == [("/add", "std_srvs/Trigger")]
    assert ("/rosapi/graph", "fibws_msgs/GetGraph") in completed(completers.services, "/rosapi/")


def test_actions_come_with_their_types(client: HubClient) -> None:
    type_ = "example_interfaces/Fibonacci"
    client.send({"op": "advertise_action", "action": "/do", "type": type_})
    client.call("/rosapi/get_time")
    assert completed(completers.actions, "/") == [("/do", type_)]


def test_parameters_are_completed() -> None:
    assert completed(completers.params, "/rosdis") == [("/rosdistro", None)]


def test_types_are_completed_without_a_hub(hub: HubThread) -> None:
    hub.stop()
    assert ("std_msgs/Int32", None) in completed(completers.types, "std_msgs/In")
    assert completed(completers.service_types, "std_srvs/T") == [("std_srvs/Trigger", None)]
    assert completed(completers.defined("action"), "nav_msgs/") == [("nav_msgs/GetMap", None)]


def test_types_may_be_named_without_their_package() -> None:
    types = completers.defined("msg", short=True)
    assert completed(types, "Twi") == [
        ("Twist", None),
        ("TwistStamped", None),
        ("TwistWithCovariance", None),
        ("TwistWithCovarianceStamped", None),
    ]
    assert completed(types, "std_msgs/In") == completed(completers.types, "std_msgs/In")
    assert completed(types, "") == completed(completers.types, "")
    assert completed(completers.types, "Twi") == []


def test_packages_have_types_of_the_kind() -> None:
    assert completed(completers.packages("msg"), "std_") == [("std_msgs", None)]
    assert completed(completers.packages("srv"), "std_") == [("std_srvs", None)]


def test_type_of_the_topic_is_completed(publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    assert completed(completers.type_of_topic, "", topic="number") == [("std_msgs/Int32", None)]
    assert completed(completers.type_of_topic, "geo", topic="/number") == []
    new = completed(completers.type_of_topic, "std_msgs/Int6", topic="/new")
    assert ("std_msgs/Int64", None) in new
    assert ("std_msgs/Int64", None) in completed(completers.type_of_topic, "std_", topic="no name")


def test_types_of_own_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("side_by_side/my_msgs/msg/Mine.msg", "alone_msgs/msg/Mine.msg"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).touch()
    (tmp_path / "alone_msgs/msg/not a type.msg").touch()
    folders = [tmp_path / "side_by_side", tmp_path / "alone_msgs", tmp_path / "missing"]
    monkeypatch.setenv("FIBWS_INTERFACES", ":".join(map(str, folders)))
    assert completed(completers.types, "my") == [("my_msgs/Mine", None)]
    assert completed(completers.types, "alone") == [("alone_msgs/Mine", None)]


def test_hub_option_names_the_hub(hub: HubThread, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "ws://127.0.0.1:1")
    assert completed(completers.params, "/rosdis") == []
    assert completed(completers.params, "/rosdis", hub.url) == [("/rosdistro", None)]


@pytest.mark.parametrize("address", ["ws://127.0.0.1:1", "http://no hub", "ws://127.0.0.1:99999"])
def test_nothing_is_completed_without_a_hub(
    address: str, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("FIBWS_HUB", address)
    assert completed(completers.topics, "") == []
    assert capfd.readouterr() == ("", "")


def test_silent_hub_does_not_delay_the_shell(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def ask(client: HubClient) -> completers.Found:
        asked.append(client)
        client.receive()  # Until the hub of this test ends.
        return {"/late": ""}

    monkeypatch.setattr(completers, "PATIENCE", 0.3)
    assert completed(completers.completion(ask), "") == []


@pytest.mark.parametrize(
    "name", ["/a$(reboot)", "/a;b", "/a b", "/a\nplain,b", "/a*", "/a\x1b[2J", "relative"]
)
def test_illegal_names_do_not_reach_the_shell(name: str) -> None:
    found = {name: "std_msgs/Int32", "/ok": "$(reboot)"}
    assert completed(completers.completion(lambda client: found), "") == [("/ok", None)]


def test_values_are_completed_by_a_message_of_defaults(client: HubClient) -> None:
    service, action = "/set_bool", "/do"
    type_ = "example_interfaces/Fibonacci"
    client.send({"op": "advertise_service", "service": service, "type": "std_srvs/SetBool"})
    client.send({"op": "advertise_action", "action": action, "type": type_})
    client.call("/rosapi/get_time")
    context = click.Context(click.Command("pub"))
    context.params |= {"service": service, "action": action, "type_": "sensor_msgs/Joy"}
    argument = click.Argument(["words"])

    def values(complete: completers.Completion, incomplete: str = "") -> list[tuple[str, str]]:
        return [(each.value, each.type) for each in complete(context, argument, incomplete)]

    header = "{seq: 0, stamp: {secs: 0, nsecs: 0}, frame_id: ''}"
    joy = f"{{header: {header}, axes: [], buttons: []}}"
    assert values(completers.message) == [(joy, completers.QUOTED)]
    assert values(completers.request) == [("{data: false}", completers.QUOTED)]
    assert values(completers.goal) == [("{order: 0}", completers.QUOTED)]
    assert values(completers.message, "{") == []
    context.params["words"] = ("{axes: [1]}",)
    assert values(completers.message) == []


def test_goal_is_completed_after_its_type() -> None:
    context = click.Context(click.Command("send"))
    context.params |= {"action": "/unknown", "goal": ("example_interfaces/action/Fibonacci",)}
    goal = click.Argument(["goal"])
    assert [each.value for each in completers.goal(context, goal, "")] == ["{order: 0}"]
    context.params["goal"] = ("example_interfaces/Fibonacci", "{order: 1}")
    assert completers.goal(context, goal, "") == []


@pytest.mark.parametrize("type_", ["nobody/Knows", "String", "$(reboot)/X"])
def test_unknown_type_has_no_message_of_defaults(type_: str) -> None:
    context = click.Context(click.Command("pub"))
    context.params["type_"] = type_
    assert completers.message(context, click.Argument(["words"]), "") == []
