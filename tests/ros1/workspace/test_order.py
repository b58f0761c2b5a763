"""The order of packages."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.errors import WorkspaceError
from fibws.ros1.workspace.order import in_order, with_needed


def test_each_stands_behind_what_it_depends_on_and_else_by_the_alphabet() -> None:
    depends = {"c": {"rospy"}, "a": {"d", "rospy"}, "b": set[str](), "d": {"c"}}
    assert in_order(depends) == ["b", "c", "d", "a"]


def test_a_circle_is_drawn() -> None:
    depends = {"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": set[str]()}
    with pytest.raises(WorkspaceError, match="in a circle: b -> c -> b"):
        in_order(depends)


def test_what_is_needed_is_added() -> None:
    depends = {"a": {"b", "rospy"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}
    assert with_needed({"a"}, depends) == {"a", "b", "c"}
    assert with_needed({"d"}, depends) == {"a", "b", "c", "d"}


@given(st.lists(st.lists(st.integers(0, 20), max_size=4), max_size=15))
def test_no_package_stands_before_one_that_it_depends_on(lower: list[list[int]]) -> None:
    depends = {
        str(number): {str(each) for each in others if each < number}
        for number, others in enumerate(lower)
    }
    order = in_order(depends)
    assert sorted(order) == sorted(depends)
    for name, others in depends.items():
        assert all(order.index(each) < order.index(name) for each in others & depends.keys())
