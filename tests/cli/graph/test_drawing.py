"""The graph drawn with characters."""

from __future__ import annotations

import pytest

from fibws.cli.graph.drawing import ASCII, LINES, Pen, drawing, topics
from fibws.cli.graph.view import Action, Service, Topic, View

TEXT = "std_msgs/String"


def text(*found: Topic, pen: Pen = LINES, width: int = 100) -> str:
    return "\n".join(topics(found, pen, width))


def topic(publishers: str, name: str, subscribers: str, type_: str = TEXT) -> Topic:
    return Topic(name, type_, True, publishers.split(), subscribers.split())


CHATTER = topic("/talker", "/chatter", "/listener")
MANY = topic("/a /bb /ccc", "/chatter", "/x /y")


def test_one_leads_to_one() -> None:
    assert text(CHATTER) == "/talker ───> [/chatter std_msgs/String] ───> /listener"


def test_several_are_joined() -> None:
    assert text(MANY) == (
        "/a ───┬─> [/chatter std_msgs/String] ─┬─> /x\n"
        "/bb ──┤                               └─> /y\n"
        "/ccc ─┘"
    )


def test_more_subscribers_than_publishers() -> None:
    assert text(topic("/a", "/t", "/x /y /z", "a/B")) == (
        "/a ───> [/t a/B] ─┬─> /x\n                  ├─> /y\n                  └─> /z"
    )


def test_ascii_will_do() -> None:
    assert text(MANY, pen=ASCII) == (
        "/a ---+-> [/chatter std_msgs/String] -+-> /x\n"
        "/bb --+                               +-> /y\n"
        "/ccc -+"
    )


def test_topics_stand_in_columns() -> None:
    lines = text(CHATTER, topic("/n", "/numbers", "/s", "std_msgs/Int32")).split("\n")
    assert lines == [
        "/talker ───> [/chatter std_msgs/String] ───> /listener",
        "/n ────────> [/numbers std_msgs/Int32] ────> /s",
    ]


@pytest.mark.parametrize(
    ("publishers", "subscribers", "expected"),
    [
        ("", "/s", "(no publisher) ───> [/t std_msgs/String] ───> /s"),
        ("/p", "", "/p ───> [/t std_msgs/String] ───> (no subscriber)"),
    ],
)
def test_who_is_missing_is_named(publishers: str, subscribers: str, expected: str) -> None:
    assert text(topic(publishers, "/t", subscribers)) == expected


def test_types_that_nobody_knows_are_marked() -> None:
    assert "[/t type unknown]" in text(Topic("/t", "", False, ["/p"], []))
    assert "[/t my/Type, unchecked]" in text(Topic("/t", "my/Type", False, ["/p"], []))


def test_where_columns_do_not_fit_each_topic_is_as_wide_as_it_has_to_be() -> None:
    long = topic("/a_publisher_of_a_long_name", "/t", "/s", "a/B")
    lines = text(CHATTER, long, width=58).split("\n")
    assert lines == [
        "/talker ───> [/chatter std_msgs/String] ───> /listener",
        "/a_publisher_of_a_long_name ───> [/t a/B] ───> /s",
    ]


def test_a_narrow_terminal_has_one_name_a_line() -> None:
    assert text(MANY, width=40) == (
        "[/chatter std_msgs/String]\n  <── /a\n  <── /bb\n  <── /ccc\n  ──> /x\n  ──> /y"
    )


def test_services_actions_and_idle_nodes_stand_below() -> None:
    view = View(
        nodes=["/adder", "/client", "/idle"],
        topics=[],
        services=[Service("/add", "a/Add", "/adder"), Service("/subtract", "a/S", "/adder")],
        actions=[Action("/do", "", "/adder", ["/client"])],
        hidden_topics=1,
        hidden_services=2,
    )
    assert list(drawing(view, LINES, 80)) == [
        ("Services", True),
        ("  /add       [a/Add]  by /adder", False),
        ("  /subtract  [a/S]    by /adder", False),
        ("", False),
        ("Actions", True),
        ("  /do  [type unknown]  by /adder, goals from /client", False),
        ("", False),
        ("Nodes with none of these", True),
        ("  /idle", False),
        ("", False),
        ("3 nodes, 0 topics, 2 services, 1 action.", False),
        ("Left out: 1 topic and 2 services of ROS itself; --all shows them.", False),
    ]


def test_no_name_makes_lines_of_its_own() -> None:
    view = View(["/a\n/forged"], [], [], [])
    assert list(drawing(view, LINES, 80))[1] == ("  /a\\n/forged", False)
