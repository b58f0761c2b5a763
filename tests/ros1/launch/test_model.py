"""Listings of a launch."""

from __future__ import annotations

from fibws.hub.rosapi.parameters import ROSDISTRO, ROSVERSION
from fibws.ros1.launch.model import CORE_PARAMETERS, Argument, argument_lines, summary

from .conftest import Read


def test_summary_lists_parameters_and_nodes_by_namespace(read: Read) -> None:
    launch = read(
        '<param name="b" value="a long text of many words"/><param name="a" value="1"/>'
        '<param name="lines" value="a\tb"/>'
        '<group ns="g" clear_params="true"><node pkg="p" type="t" name="n"/></group>'
        '<node pkg="p" type="t" name="z"/><node pkg="p" type="u" name="m"/>'
        '<test pkg="p" type="t" test-name="x"/>'
    )
    assert (
        "\n".join(summary(launch))
        == """
SUMMARY
========

CLEAR PARAMETERS
 * /g/

PARAMETERS
 * /a: 1
 * /b: a long text of ma...
 * /lines: a b

NODES
  /
    m (p/u)
    z (p/t)
  /g/
    n (p/t)
"""
    )


def test_unprintable_value_is_hidden(read: Read) -> None:
    launch = read('<rosparam>a: "x\\e[31m"\nb: "x\\n"</rosparam>')
    assert {" * /a: <...>", " * /b: x"} <= set(summary(launch))


def test_core_parameters_are_those_of_the_hub() -> None:
    assert CORE_PARAMETERS == {"/rosdistro": ROSDISTRO, "/rosversion": ROSVERSION}


def test_argument_lines_list_arguments_that_may_be_set() -> None:
    known = [
        Argument("b"),
        Argument("a", doc="what"),
        Argument("fixed", has_value=True),
        Argument("d", default="1", doc="how"),
        Argument("c", default="x y"),
    ]
    assert list(argument_lines(known)) == [
        "Required Arguments:",
        "  a: what",
        "  b: undocumented",
        "Optional Arguments:",
        '  c (default "x y"): undocumented',
        '  d (default "1"): how',
    ]
    assert list(argument_lines(known[:1])) == ["Required Arguments:", "  b: undocumented"]
    assert next(iter(argument_lines(known[-1:]))) == "Optional Arguments:"
    assert list(argument_lines([known[2]])) == ["No arguments."]
