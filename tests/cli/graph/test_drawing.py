"""The drawing of the graph in characters."""

from __future__ import annotations

import pytest

from fibws.cli.graph.drawing import ASCII, LINES, Pen, drawing, topics
from fibws.client.graph_view import DrawnAction, DrawnConflict, DrawnService, DrawnTopic, View

TEXT = "std_msgs/String"


def text(*found: DrawnTopic, pen: Pen = LINES, width: int = 100) -> str:
    return "\n".join(topics(found, pen, width))


def topic(publishers: str, name: str, subscribers: str, type_: str = TEXT) -> DrawnTopic:
    return DrawnTopic(name, type_, True, publishers.split(), subscribers.split())


CHATTER = topic("/talker", "/chatter", "/listener")
MANY = topic("/a /bb /ccc", "/chatter", "/x /y")


def test_publisher_and_a_subscriber() -> None:
    assert text(CHATTER) == "/talker ───> [/chatter std_msgs/String] ───> /listener"


def test_lines_of_several_nodes_are_joined() -> None:
    assert text(MANY) == (
        "/a ───┬─> [/chatter std_msgs/String] ─┬─> /x\n"
        "/bb ──┤                               └─> /y\n"
        "/ccc ─┘"
    )


def test_more_subscribers_than_publishers() -> None:
    assert text(topic("/a", "/t", "/x /y /z", "a/B")) == (
        "/a ───> [/t a/B] ─┬─> /x\n                  ├─> /y\n                  └─> /z"
    )


def test_lines_in_ascii() -> None:
    assert text(MANY, pen=ASCII) == (
        "/a ---+-> [/chatter std_msgs/String] -+-> /x\n"
        "/bb --+                               +-> /y\n"
        "/ccc -+"
    )


def test_topics_are_in_columns() -> None:
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
def test_missing_ends_are_shown(publishers: str, subscribers: str, expected: str) -> None:
    assert text(topic(publishers, "/t", subscribers)) == expected


def test_unknown_types_are_marked() -> None:
    assert "[/t type unknown]" in text(DrawnTopic("/t", "", False, ["/p"], []))
    assert "[/t my/Type, unchecked]" in text(DrawnTopic("/t", "my/Type", False, ["/p"], []))


def test_topics_have_their_own_widths_if_columns_do_not_fit() -> None:
    long = topic("/a_publisher_of_a_long_name", "/t", "/s", "a/B")
    lines = text(CHATTER, long, width=58).split("\n")
    assert lines == [
        "/talker ───> [/chatter std_msgs/String] ───> /listener",
        "/a_publisher_of_a_long_name ───> [/t a/B] ───> /s",
    ]


def test_narrow_terminal_has_a_name_per_line() -> None:
    assert text(MANY, width=40) == (
        "[/chatter std_msgs/String]\n  <── /a\n  <── /bb\n  <── /ccc\n  ──> /x\n  ──> /y"
    )


def test_services_actions_and_other_nodes_follow() -> None:
    view = View(
        nodes=["/adder", "/client", "/idle"],
        topics=[],
        services=[
            DrawnService("/add", "a/Add", "/adder"),
            DrawnService("/subtract", "a/S", "/adder"),
        ],
        actions=[DrawnAction("/do", "", "/adder", ["/client"])],
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
        ("Other nodes", True),
        ("  /idle", False),
        ("", False),
        ("3 nodes, 0 topics, 2 services, 1 action.", False),
        ("Hidden: 1 topic, 2 services of the hub and its tools; --all shows them.", False),
    ]


def test_line_breaks_in_names_are_escaped() -> None:
    view = View(["/a\n/forged"], [], [], [])
    assert list(drawing(view, LINES, 80))[1] == ("  /a\\n/forged", False)


def test_conflicts_and_unreachable_nodes_are_listed_last() -> None:
    view = View(
        ["/camera"],
        [],
        [],
        [],
        conflicts=[DrawnConflict("/camera", "/chatter", True, "publishes a/B, the topic is c/D")],
        unreachable={"/camera": "Timed out"},
    )
    assert [line for line, _ in drawing(view, LINES, 80)][:5] == [
        "Conflicts",
        "  /camera on /chatter: publishes a/B, the topic is c/D",
        "",
        "Unreachable nodes",
        "  /camera: Timed out",
    ]
