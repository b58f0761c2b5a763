"""The packages in src/, and their order."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from fibws.ros1.workspace.source_tree import (
    read_source_tree,
    topological_order,
    with_dependencies,
)

from .conftest import Layout


def test_packages_follow_their_dependencies_else_alphabetically() -> None:
    depends = {"c": {"rospy"}, "a": {"d", "rospy"}, "b": set[str](), "d": {"c"}}
    assert topological_order(depends) == (["b", "c", "d", "a"], [])


def test_circles_are_found_and_the_others_are_sorted() -> None:
    depends = {"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": set[str](), "e": {"f"}, "f": {"e"}}
    order, circles = topological_order(depends)
    assert sorted(order) == sorted(depends)
    assert order.index("b") < order.index("a")
    assert circles == [["b", "c", "b"], ["e", "f", "e"]]


def test_dependencies_are_added() -> None:
    depends = {"a": {"b", "rospy"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}
    assert with_dependencies({"a"}, depends) == {"a", "b", "c"}
    assert with_dependencies({"d"}, depends) == {"a", "b", "c", "d"}


@given(st.lists(st.lists(st.integers(0, 20), max_size=4), max_size=15))
def test_no_package_stands_before_its_dependencies(lower: list[list[int]]) -> None:
    depends = {
        str(number): {str(each) for each in others if each < number}
        for number, others in enumerate(lower)
    }
    order, circles = topological_order(depends)
    assert sorted(order) == sorted(depends) and not circles
    for name, others in depends.items():
        assert all(order.index(each) < order.index(name) for each in others)


def test_members_of_a_group_come_before_packages_that_depend_on_it(layout: Layout) -> None:
    def manifest(name: str, text: str) -> str:
        folder = layout.package(name, manifest=text)
        path = folder / "package.xml"
        path.write_text(path.read_text().replace('format="2"', 'format="3"'))
        return name

    manifest("a", "<group_depend>plugins</group_depend>")
    manifest("b", "<member_of_group>plugins</member_of_group>")
    manifest("c", "")
    packages, _ = read_source_tree(layout.source)
    assert [package.name for package in packages] == ["b", "a", "c"]
    assert packages[1].depends == {"b"}


def test_first_of_two_packages_of_one_name_wins_with_a_warning(layout: Layout) -> None:
    first = layout.package("a", folder="one")
    second = layout.package("a", folder="two")
    packages, warnings = read_source_tree(layout.source)
    assert [package.folder for package in packages] == [first]
    (warning,) = warnings
    assert str(first) in warning and warning.startswith(str(second))
    assert str(second / "CATKIN_IGNORE") in warning


def test_what_cannot_be_read_is_an_error_of_the_package(layout: Layout) -> None:
    layout.package("a", manifest="<?xml version='1.0'?><package><name>real</name></package>")
    layout.package("b", cmake="project(b")
    (layout.package("c") / "CMakeLists.txt").unlink()
    (layout.package("d", manifest="<export><metapackage/></export>") / "CMakeLists.txt").unlink()
    layout.package("e")
    packages, _ = read_source_tree(layout.source)
    errors = {
        each.name: [layout.relative(str(error)) for error in each.errors] for each in packages
    }
    assert errors.keys() == {"real", "b", "c", "d", "e"}
    assert not errors["d"] and not errors["e"]
    assert "a/package.xml, line 1: <version> is missing" in errors["real"]
    assert "b/CMakeLists.txt, line 1: " in errors["b"][0]
    assert "CMakeLists.txt not found" in errors["c"][0]
