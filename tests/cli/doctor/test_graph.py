"""What looks odd in what a hub tells."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.cli.doctor.finding import Finding
from fibws.cli.doctor.graph import checks

from ..graph.test_view import ME, graph, topic


def client(node: str, **others: Any) -> dict[str, Any]:
    told = {"node": node, "address": "127.0.0.1:5", "kept_bytes": 0, "dropped": 0, "slow": False}
    return {**told, **others}


def found(told: dict[str, Any], before: dict[str, Any] | None = None) -> dict[str, list[Finding]]:
    """The findings by their checks."""
    nobody: dict[str, Any] = {"clients": []}
    by_check: dict[str, list[Finding]] = {}
    for finding in checks((before or told, nobody), (told, nobody), but=ME):
        by_check.setdefault(finding.check, []).append(finding)
    return by_check


def of_clients(before: list[dict[str, Any]], now: list[dict[str, Any]]) -> list[Finding]:
    looks = [(graph(), {"clients": clients}) for clients in (before, now)]
    return [each for each in checks(looks[0], looks[1], but=ME) if each.check == "clients"]


def texts(findings: list[Finding]) -> list[tuple[str, str]]:
    return [(finding.verdict, finding.text) for finding in findings]


def test_a_graph_in_which_all_is_well() -> None:
    told = found(graph(topic("/chatter", "/a", "/b"), nodes="/a /b"))
    assert {check: texts(findings) for check, findings in told.items()} == {
        "graph": [("ok", "2 nodes, 1 topic of theirs")],
        "types": [("ok", "Every topic's type is defined")],
        "ends": [("ok", "Every topic has publishers and subscribers")],
        "names": [("ok", "No two things have one name")],
        "clients": [("ok", "All keep up")],
    }


def test_types_with_no_definition_are_named() -> None:
    told = found(graph(topic("/a", "/n", "/n", type="my/Type", checked=False)))
    ((verdict, text),) = texts(told["types"])
    assert verdict == "warning"
    assert "/a (my/Type)" in text
    assert "--interfaces DIR" in told["types"][0].advice


def test_a_misspelled_topic_is_found_and_not_told_of_twice() -> None:
    told = found(graph(topic("/fibonacci", "/b"), topic("/fibonaci", "", "/l")))
    assert told["ends"] == [
        Finding(
            "ends",
            "warning",
            "/fibonaci has a subscriber (/l) and no publisher, while /fibonacci is published",
            "If they are to be one, mend the name, or remap it: /fibonaci:=/fibonacci",
        )
    ]


def test_topics_of_two_types_are_two() -> None:
    told = found(graph(topic("/scans", "/b", type="a/B"), topic("/scan", "", "/l", type="c/D")))
    assert not any("remap" in finding.advice for finding in told["ends"])
    told = found(graph(topic("/scans", "/b", type="a/B"), topic("/scan", "", "/l", type="")))
    assert any("remap" in finding.advice for finding in told["ends"])


def test_loose_ends_are_named() -> None:
    told = found(graph(topic("/heard", "", "/l"), topic("/spoken", "/n"), topic("/rosout", "/n")))
    assert texts(told["ends"]) == [
        ("warning", "Nobody publishes /heard, which somebody waits for"),
        ("warning", "Nobody hears /spoken"),
    ]


def test_a_great_many_loose_ends_are_counted() -> None:
    told = found(graph(*(topic(f"/t{number}", "/n") for number in range(9))))
    assert told["ends"][0].text.endswith("/t4 and 4 more")


def test_things_of_two_kinds_with_one_name_are_named() -> None:
    told = found(
        graph(
            topic("/x", "/n", "/m"),
            services=(("/x", "/n"), ("/y", "/n")),
            actions=(("/y", "/n", False),),
        )
    )
    assert texts(told["names"]) == [("warning", "/x is a topic and a service")]


def test_an_action_may_have_the_name_of_a_topic() -> None:
    ways = (("/count", "/n", False), ("/count", "/n", True))
    assert found(graph(topic("/count", "/n", "/m"), actions=ways))["names"][0].verdict == "ok"


def test_a_program_that_runs_twice_is_seen_by_what_it_publishes() -> None:
    names = "/talker_12_1700000000001 /talker_13_1700000000002 /other"
    told = found(graph(topic("/chatter", names, "/l"), topic("/heard", "/o", "/l_1 /l_2")))
    ((verdict, text),) = texts(told["names"])
    assert verdict == "warning"
    assert "one program, 2 times: /talker_12_1700000000001, /talker_13" in text
    assert told["names"][0].advice.endswith("fibws node kill /talker_13_1700000000002")


def test_nodes_that_fight_over_a_name_are_seen() -> None:
    before, now = graph(nodes="/a /b"), graph(nodes="/a /b /c")
    assert found(now, before)["names"][0].verdict == "ok"
    now["nodes"][1]["address"] = "127.0.0.1:6"
    (finding,) = found(now, before)["names"]
    assert finding.text.startswith("/a came anew within a second, from 127.0.0.1:6")


def test_clients_that_do_not_keep_up_are_named() -> None:
    now = [
        client("/slow", slow=True, kept_bytes=99),
        client("/loses", dropped=7),
        client("/lost", dropped=7),
        client("/new", dropped=1),
        client(ME, slow=True),
    ]
    before = [client("/slow"), client("/loses", dropped=5), client("/lost", dropped=7)]
    assert texts(of_clients(before, now)) == [
        (
            "warning",
            "/slow (127.0.0.1:5) is too slow: 99 bytes wait for it, 0 messages dropped in all, "
            "0 just now",
        ),
        (
            "warning",
            "/loses (127.0.0.1:5) is too slow: 0 bytes wait for it, 7 messages dropped in all, "
            "2 just now",
        ),
        ("ok", "/lost keeps up now; it once lost 7 messages"),
        ("ok", "/new keeps up now; it once lost 1 message"),
    ]


@pytest.mark.parametrize("name", ["/client_7 /client_8", "/a /b"])
def test_nodes_that_publish_different_things_are_no_twins(name: str) -> None:
    first, second = name.split()
    told = found(graph(topic("/one", first, "/l"), topic("/two", second, "/l")))
    assert told["names"][0].verdict == "ok"
