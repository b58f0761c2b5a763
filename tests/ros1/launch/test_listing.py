"""What is told of a launch before it runs."""

from __future__ import annotations

from fibws.ros1.launch.listing import arguments, summary
from fibws.ros1.launch.model import Argument

from .conftest import Read


def test_the_summary_has_parameters_and_nodes_by_their_namespaces(read: Read) -> None:
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


def test_a_value_that_cannot_be_shown_is_not(read: Read) -> None:
    launch = read('<rosparam>a: "x\\e[31m"\nb: "x\\n"</rosparam>')
    assert {" * /a: <...>", " * /b: x"} <= set(summary(launch))


def test_arguments_are_those_that_may_be_given() -> None:
    known = [
        Argument("b"),
        Argument("a", doc="what"),
        Argument("fixed", has_value=True),
        Argument("d", default="1", doc="how"),
        Argument("c", default="x y"),
    ]
    assert list(arguments(known)) == [
        "Required Arguments:",
        "  a: what",
        "  b: undocumented",
        "Optional Arguments:",
        '  c (default "x y"): undocumented',
        '  d (default "1"): how',
    ]
    assert list(arguments(known[:1])) == ["Required Arguments:", "  b: undocumented"]
    assert next(iter(arguments(known[-1:]))) == "Optional Arguments:"
    assert list(arguments([known[2]])) == ["No arguments."]
