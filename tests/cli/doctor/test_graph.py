"""Checks of the graph."""

from __future__ import annotations

from typing import Any

import pytest
from client.test_graph_view import ME, graph, topic

from fibws.cli.doctor.finding import Finding
from fibws.cli.doctor.graph import checks


def client(node: str, **others: Any) -> dict[str, Any]:
    fields = {"node": node, "address": "127.0.0.1:5", "kept_bytes": 0, "dropped": 0, "slow": False}
    return {**fields, **others}


def found(now: dict[str, Any], before: dict[str, Any] | None = None) -> dict[str, list[Finding]]:
    """Return the findings by their checks."""
    nobody: dict[str, Any] = {"clients": []}
    by_check: dict[str, list[Finding]] = {}
    for finding in checks((before or now, nobody), (now, nobody), but=ME):
        by_check.setdefault(finding.check, []).append(finding)
    return by_check


def of_clients(before: list[dict[str, Any]], now: list[dict[str, Any]]) -> list[Finding]:
    snapshots = [(graph(), {"clients": clients}) for clients in (before, now)]
    return [each for each in checks(snapshots[0], snapshots[1], but=ME) if each.check == "clients"]


def texts(findings: list[Finding]) -> list[tuple[str, str]]:
    return [(finding.verdict, finding.text) for finding in findings]


def test_graph_without_problems() -> None:
    told = found(graph(topic("/chatter", "/a", "/b"), nodes="/a /b"))
    assert told.keys() == {"graph", "types", "conflicts", "ends", "names", "clients"}
    assert {finding.verdict for findings in told.values() for finding in findings} == {"ok"}
    assert told["graph"][0].text == "2 nodes, 1 topic"


def test_undefined_types_are_named() -> None:
    told = found(graph(topic("/a", "/n", "/n", type="my/Type", checked=False)))
    ((verdict, text),) = texts(told["types"])
    assert verdict == "warning"
    assert "/a (my/Type)" in text
    assert "--interfaces DIR" in told["types"][0].advice


def test_misspelled_type_gets_a_suggestion() -> None:
    misspelled = topic("/b", "/n", "/n", type="std_msg/Strin", checked=False)
    told = found(graph(topic("/a", "/n", "/n", type="my/Type", checked=False), misspelled))
    first, second = told["types"]
    assert first.verdict == second.verdict == "warning"
    assert "/b" in first.text and "std_msg/Strin" in first.text
    assert "std_msgs/String" in first.advice
    assert "/a (my/Type)" in second.text and "/b" not in second.text


def test_misspelled_topic_is_reported_once() -> None:
    told = found(graph(topic("/fibonacci", "/b"), topic("/fibonaci", "", "/l")))
    (finding,) = told["ends"]
    assert finding.verdict == "warning"
    assert all(name in finding.text for name in ("/fibonaci ", "(/l)", "/fibonacci "))
    assert "/fibonaci:=/fibonacci" in finding.advice


def test_topics_of_different_types_are_not_misspelled() -> None:
    told = found(graph(topic("/scans", "/b", type="a/B"), topic("/scan", "", "/l", type="c/D")))
    assert not any("remap" in finding.advice for finding in told["ends"])
    told = found(graph(topic("/scans", "/b", type="a/B"), topic("/scan", "", "/l", type="")))
    assert any("remap" in finding.advice for finding in told["ends"])


def test_topics_without_publisher_or_subscribers_are_named() -> None:
    told = found(graph(topic("/heard", "", "/l"), topic("/spoken", "/n"), topic("/rosout", "/n")))
    unpublished, unread = texts(told["ends"])
    assert unpublished[0] == unread[0] == "warning"
    assert "/heard" in unpublished[1] and "publisher" in unpublished[1]
    assert "/spoken" in unread[1] and "subscriber" in unread[1]


def test_further_topics_are_counted() -> None:
    told = found(graph(*(topic(f"/t{number}", "/n") for number in range(9))))
    assert told["ends"][0].text.endswith("/t4 and 4 more")


def test_topic_and_service_of_the_same_name_are_reported() -> None:
    told = found(
        graph(
            topic("/x", "/n", "/m"),
            services=(("/x", "/n"), ("/y", "/n")),
            actions=(("/y", "/n", False),),
        )
    )
    assert texts(told["names"]) == [("warning", "/x is a topic and a service")]


def test_action_may_have_the_name_of_a_topic() -> None:
    actions = (("/count", "/n", False), ("/count", "/n", True))
    assert found(graph(topic("/count", "/n", "/m"), actions=actions))["names"][0].verdict == "ok"


def test_copies_of_a_program_are_found_by_their_names() -> None:
    names = "/talker_12_1700000000001 /talker_13_1700000000002 /other"
    told = found(graph(topic("/chatter", names, "/l"), topic("/heard", "/o", "/l_1 /l_2")))
    ((verdict, text),) = texts(told["names"])
    assert verdict == "warning"
    assert "/chatter" in text and "2 copies" in text
    assert "/talker_12_1700000000001, /talker_13" in text
    assert told["names"][0].advice.endswith("fibws node kill /talker_13_1700000000002")


def test_replaced_node_is_reported() -> None:
    before, now = graph(nodes="/a /b"), graph(nodes="/a /b /c")
    assert found(now, before)["names"][0].verdict == "ok"
    now["nodes"][1]["address"] = "127.0.0.1:6"
    (finding,) = found(now, before)["names"]
    assert finding.text.startswith("/a ") and "127.0.0.1:6" in finding.text


def test_slow_clients_are_reported() -> None:
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
            "/slow (127.0.0.1:5) is too slow: 99 bytes queued, 0 messages dropped, "
            "0 in the last second",
        ),
        (
            "warning",
            "/loses (127.0.0.1:5) is too slow: 0 bytes queued, 7 messages dropped, "
            "2 in the last second",
        ),
        ("ok", "/lost is fast enough now; 7 messages dropped before"),
        ("ok", "/new is fast enough now; 1 message dropped before"),
    ]


@pytest.mark.parametrize("name", ["/client_7 /client_8", "/a /b"])
def test_publishers_of_different_topics_are_not_copies(name: str) -> None:
    first, second = name.split()
    told = found(graph(topic("/one", first, "/l"), topic("/two", second, "/l")))
    assert told["names"][0].verdict == "ok"
