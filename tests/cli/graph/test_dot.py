"""The graph for Graphviz; read by ``dot`` if it is installed."""

from __future__ import annotations

import json
import shutil
import subprocess

import pytest

from fibws.cli.graph.dot import dot
from fibws.client.graph_view import DrawnAction, DrawnConflict, DrawnService, DrawnTopic, View

ODD = 'a "quoted" \\N \\ <b>\n\x1b'
VIEW = View(
    nodes=["/talker", "/listener"],
    topics=[DrawnTopic("/talker", "std_msgs/String", True, ["/talker"], ["/listener"])],
    services=[DrawnService("/add", "a/Add", "/adder")],
    actions=[DrawnAction("/do", "a/Do", "/adder", ["/client"])],
)


def test_node_and_a_topic_may_have_the_same_name() -> None:
    lines = list(dot(VIEW))
    assert '  "node /talker" -> "topic /talker";' in lines
    assert '  "topic /talker" -> "node /listener";' in lines
    assert '  "topic /talker" [label="/talker\\nstd_msgs/String", shape=box];' in lines
    assert lines[0] == "digraph graph_of_nodes {"
    assert lines[-1] == "}"


def test_services_and_actions_lead_to_their_servers() -> None:
    lines = list(dot(VIEW))
    assert '  "service /add" -> "node /adder" [style=dashed];' in lines
    assert '  "node /client" -> "action /do" [style=dashed];' in lines


def test_quotes_in_names_are_escaped() -> None:
    view = View([ODD], [DrawnTopic(ODD, ODD, False, [ODD], [])], [], [])
    text = "\n".join(dot(view))
    assert '"node a \\"quoted\\" \\\\N \\\\ <b>\\n' in text
    assert "\x1b" not in text


@pytest.mark.skipif(shutil.which("dot") is None, reason="Graphviz is not installed")
@pytest.mark.parametrize(
    "view", [VIEW, View([ODD], [DrawnTopic(ODD, ODD, False, [ODD], [])], [], [])]
)
def test_graphviz_reads_it(view: View) -> None:
    text = "\n".join(dot(view))
    read = subprocess.run(
        ["dot", "-Tjson"], input=text, capture_output=True, text=True, check=True, timeout=60
    )
    assert not read.stderr
    found = json.loads(read.stdout)
    kinds = {each["name"].split(" ")[0] for each in found["objects"]}
    assert {"node", "topic"} <= kinds
    assert len(found["edges"]) == sum(" -> " in line for line in text.split("\n"))


def test_conflicts_are_dotted_and_unreachable_nodes_dashed() -> None:
    view = View(
        ["/camera", "/viewer"],
        [DrawnTopic("/chatter", "c/D", True, [], [])],
        [],
        [],
        conflicts=[
            DrawnConflict("/camera", "/chatter", True, "why"),
            DrawnConflict("/viewer", "/chatter", False, "why"),
        ],
        unreachable={"/camera": "Timed out"},
    )
    lines = list(dot(view))
    assert '  "node /camera" [label="/camera\\nunreachable", shape=ellipse, style=dashed];' in lines
    assert '  "node /camera" -> "topic /chatter" [style=dotted, label="why"];' in lines
    assert '  "topic /chatter" -> "node /viewer" [style=dotted, label="why"];' in lines
