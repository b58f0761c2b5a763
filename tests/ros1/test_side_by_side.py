"""The tutorials' programs say under fibws what they say under a real ROS, line by line."""

from __future__ import annotations

from pathlib import Path

import pytest
from recorded_answers import Answers

from ros1.side_by_side import Part, RealRos, compare
from ros1.side_by_side import ros as ros

SCENARIOS: dict[str, tuple[Part, ...]] = {
    "talker and listener": (
        Part("listener.py", hears=("I heard", 2), lines=2),
        Part("talker.py", until="hello", count=3, lines=3),
    ),
    "the Fibonacci numbers": (
        Part("fibonacci_listener_node.py", lines=0),
        Part("fibonacci_broadcaster_node.py", until="] ", count=15, lines=12),
    ),
    "messages with headers": (
        Part("listener_header.py", until="ready", lines=1),
        Part("talker_header.py", until="published", count=10, lines=5),
    ),
    "a listener with user data": (
        Part("listener_with_userdata.py", until="ready", hears=("I heard", 4), lines=5),
        Part("talker.py", until="hello", count=3, lines=3),
    ),
    "a publisher that is told of subscribers": (
        Part("notify_publisher.py", until="ready", last="no friends"),
        Part("notified_listener.py", interrupted=False),
    ),
    "add two ints": (
        Part("add_two_ints_server.py", until="Ready"),
        Part("add_two_ints_client.py", ("1", "2"), interrupted=False),
    ),
    "add two ints, asked in vain": (
        Part("add_two_ints_client.py", ("1", "two", "_x:=3"), interrupted=False),
    ),
    "services that fail, and answer in all forms": (
        Part("faulty_service.py", until="ready", errors=False),
        Part("faulty_client.py", interrupted=False),
    ),
    "parameters": (Part("param_talker.py", interrupted=False),),
    "parameters of all kinds": (Part("param_kinds.py", interrupted=False),),
    "remapping": (
        Part(
            "remapped.py",
            (
                *("word", "chatter:=heard", "__name:=renamed", "__ns:=/robot", "_number:=3"),
                *("_text:=some text", "_list:=[1, a]", "other:=~mine"),
            ),
            interrupted=False,
        ),
    ),
    "connection headers": (
        Part("connection_header_server.py", until="ready", hears=("topic:", 1)),
        Part("connection_header_client.py", interrupted=False),
    ),
    "hooks at the end": (
        Part("plain_listener.py", until="ready", last="heard"),
        Part("on_shutdown.py", until="ready"),
    ),
    "ways to publish": (
        Part("color_listener.py", until="ready", hears=("heard", 4)),
        Part("advanced_publish.py", interrupted=False),
    ),
    "point clouds": (
        Part("cloud_talker.py", until="ready"),
        Part("cloud_listener.py", interrupted=False),
    ),
    "times": (Part("times.py", interrupted=False),),
    "logs": (
        Part("rosout_listener.py", until="ready", hears=("exception", 1)),
        Part("logs.py", after="ready", interrupted=False),
    ),
    "logs in a format": (
        Part(
            "logs.py",
            after="ready",
            interrupted=False,
            environment={"ROSCONSOLE_FORMAT": "${severity} ${node} ${function} ${message}"},
        ),
    ),
    "callbacks": (Part("bad_callback.py", interrupted=False),),
    "arrays": (
        Part("floats_talker.py", until="ready"),
        Part("floats_listener.py", interrupted=False),
    ),
    "two nodes of one name": (
        Part("same_name.py", until="ready", interrupted=False),
        Part("same_name.py", until="ready"),
    ),
    "the graph": (Part("graph.py", interrupted=False),),
    "a turtle that goes to its goal": (
        Part("turtle_sim.py", until="ready"),
        Part("go_to_goal.py", interrupted=False),
    ),
    "images made of arrays": (
        Part("viewer.py", until="ready"),
        Part("camera.py", interrupted=False),
    ),
    "an arm's joints": (Part("arm.py", interrupted=False),),
    "services that call services": (Part("nested_services.py", interrupted=False),),
    "what follows a loop": (Part("counter.py", until="ready"),),
    "what follows a sleep": (Part("stop_the_robot.py", until="ready"),),
    "a robot that ends itself": (Part("quitting_robot.py", interrupted=False),),
    "names that are not legal": (Part("odd_names.py", interrupted=False),),
    "values that JSON lacks": (Part("exact_services.py", interrupted=False),),
    "loggers of Python": (Part("python_loggers.py", interrupted=False),),
    "forms of names": (Part("name_forms.py", interrupted=False),),
    "the insides of a bag": (Part("bag_insides.py", interrupted=False),),
    "many topics, and any type": (Part("many_topics.py", interrupted=False),),
}


@pytest.mark.timeout(600)
@pytest.mark.parametrize("name", SCENARIOS)
async def test_scenario_goes_as_in_ros(answers: Answers, ros: RealRos, name: str) -> None:
    await compare(answers, ros, *SCENARIOS[name])


def test_all_scripts_are_played() -> None:
    played = {part.script for parts in SCENARIOS.values() for part in parts}
    scripts = Path(__file__).parent / "scripts"
    assert played == {path.name for path in scripts.glob("*.py")}
