"""Parameters: a tree of values with the rules of ROS 1's parameter server."""

from __future__ import annotations

import math
import sys
from datetime import datetime
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.errors import InvalidName, ParameterError, ParameterNotSet
from fibws.hub.errors import ParametersFull
from fibws.hub.graph import parameters as module
from fibws.hub.graph.parameters import (
    DEEPEST,
    ENTRY_OVERHEAD,
    Parameters,
    names_in,
    native,
)
from fibws.names import MAX_LENGTH

UNLIMITED = 2**20


def parameters(values: dict[str, Any] | None = None, max_bytes: int = UNLIMITED) -> Parameters:
    made = Parameters(max_bytes)
    made.set("/", values or {})
    return made


def nested(depth: int, value: Any = 1) -> Any:
    for _ in range(depth):
        value = {"a": value}
    return value


# Reading.


def test_value_can_be_read() -> None:
    tree = parameters()
    tree.set("/robot/name", "kitt")
    assert tree.get("/robot/name") == "kitt"
    assert tree.text("/robot/name") == b'"kitt"'


def test_namespace_is_read_as_an_object() -> None:
    tree = parameters({"robot": {"name": "kitt", "wheels": 4, "arms": {}}})
    assert tree.get("/robot") == {"name": "kitt", "wheels": 4, "arms": {}}
    assert tree.text("/robot") == b'{"name":"kitt","wheels":4,"arms":{}}'
    assert tree.get("/") == {"robot": {"name": "kitt", "wheels": 4, "arms": {}}}


@pytest.mark.parametrize("name", ["/nothing", "/robot/nothing", "/robot/name/first", "/list/0"])
def test_unknown_parameter_is_not_set(name: str) -> None:
    tree = parameters({"robot": {"name": "kitt"}, "list": [{"0": 1}]})
    assert not tree.has(name)
    with pytest.raises(ParameterNotSet) as error:
        tree.get(name)
    assert str(error.value) == f"Parameter [{name}] is not set"


def test_has_finds_parameters_and_namespaces() -> None:
    tree = parameters({"robot": {"name": "", "arms": {}}})
    assert all(tree.has(name) for name in ("/", "/robot", "/robot/name", "/robot/arms"))


def test_empty_parts_of_a_name_are_ignored() -> None:
    tree = parameters()
    tree.set("//robot//name/", 1)
    assert tree.names() == ["/robot/name"]
    assert tree.get("/robot/name//") == 1


@pytest.mark.parametrize("name", ["", "robot", "~name", "/" + "a" * MAX_LENGTH])
def test_name_must_be_global_and_not_too_long(name: str) -> None:
    tree = parameters()
    for act in (tree.get, tree.text, tree.has, tree.delete, lambda name: tree.set(name, 1)):
        with pytest.raises(InvalidName):
            act(name)


def test_values_are_copied_when_set_and_when_read() -> None:
    tree = parameters()
    value = {"list": [1, 2], "space": {"x": 1}}
    tree.set("/robot", value)
    value["list"] = []
    tree.get("/robot")["space"]["x"] = 5
    assert tree.get("/robot") == {"list": [1, 2], "space": {"x": 1}}


# Setting.


def test_object_replaces_a_whole_namespace() -> None:
    tree = parameters({"robot": {"name": "kitt", "arms": {"left": 1}}, "other": 1})
    tree.set("/robot", {"arms": {"right": 2}})
    assert tree.get("/") == {"robot": {"arms": {"right": 2}}, "other": 1}


def test_value_replaces_a_namespace() -> None:
    tree = parameters({"robot": {"name": "kitt"}})
    tree.set("/robot", 5)
    assert tree.names() == ["/robot"]


def test_longer_name_replaces_a_value_by_a_namespace() -> None:
    tree = parameters({"robot": {"arm": 5}})
    tree.set("/robot/arm/joints/first", 1)
    assert tree.get("/") == {"robot": {"arm": {"joints": {"first": 1}}}}


def test_root_can_only_be_set_to_an_object() -> None:
    tree = parameters({"robot": 1})
    tree.set("/", {"other": 2})
    assert tree.names() == ["/other"]
    with pytest.raises(ParameterError, match="object"):
        tree.set("/", 5)
    assert tree.names() == ["/other"]


@pytest.mark.parametrize(
    "value",
    [
        True,
        0,
        -(2**63) - 1,
        10**300,
        0.1,
        1e300,
        5e-324,
        -0.0,
        sys.float_info.max,
        "",
        "ein Weg: \N{SNOWMAN} \"'\\\n\x00",
        [],
        [1, 2.0, "3", [True], {"any/key": {"": 1}}],
        {},
        {"1 key, not a legal name": {"~": False}},
    ],
    ids=repr,
)
def test_every_value_is_kept_exactly(value: Any) -> None:
    tree = parameters()
    tree.set("/x", value)
    assert repr(tree.get("/x")) == repr(value)


@pytest.mark.parametrize(
    ("value", "fault"),
    [
        (None, r"\[/x\].*null"),
        ([1, [None]], "null"),
        ({"y": {"z": None}}, r"\[/x/y/z\].*null"),
        ([{"y": None}], "null"),
        (2**1024, "1024 bits"),
        ([{"y": -(2**1024)}], "1024 bits"),
        ({"$binary": "?"}, r"\[/x\].*base64"),
        ([{"$date": "tomorrow"}], r"\[/x\].*date"),
        ({5: 1}, "^'/x/5'"),
        ({"y" * MAX_LENGTH: 1}, "1024 characters"),
        (nested(DEEPEST + 1), "100"),
        ([[nested(DEEPEST - 1)]], "100"),
        (nested(DEEPEST - 1, [[]]), "100"),
    ],
)
def test_invalid_value_is_refused_and_changes_nothing(value: Any, fault: str) -> None:
    tree = parameters({"x": 1})
    with pytest.raises((ParameterError, InvalidName), match=fault):
        tree.set("/x", value)
    assert tree.get("/") == {"x": 1}


def test_namespaces_of_a_name_count_as_depth() -> None:
    tree = parameters()
    tree.set("/a" * DEEPEST, {"a": 1})
    with pytest.raises(ParameterError, match="100"):
        tree.set("/a" * (DEEPEST + 2), 1)
    with pytest.raises(ParameterError, match="100"):
        tree.set("/a" * (DEEPEST + 1), [])
    assert tree.names() == ["/a" * (DEEPEST + 1)]
    assert tree.get("/") == nested(DEEPEST + 1)


# Deleting.


def test_delete_keeps_the_namespace() -> None:
    tree = parameters({"robot": {"arm": {"left": 1, "right": 2}}})
    tree.delete("/robot/arm/left")
    assert tree.get("/") == {"robot": {"arm": {"right": 2}}}
    tree.delete("/robot/arm/right")
    assert tree.get("/") == {"robot": {"arm": {}}}
    tree.delete("/robot")
    assert tree.get("/") == {}


@pytest.mark.parametrize("name", ["/nothing", "/robot/nothing", "/robot/name/first", "/a/b/c"])
def test_unknown_parameter_cannot_be_deleted(name: str) -> None:
    tree = parameters({"robot": {"name": "kitt"}})
    with pytest.raises(ParameterNotSet):
        tree.delete(name)
    assert tree.names() == ["/robot/name"]


def test_root_cannot_be_deleted() -> None:
    tree = parameters({"robot": 1})
    with pytest.raises(ParameterError, match="/"):
        tree.delete("/")
    assert tree.names() == ["/robot"]


# Searching; the example is from rosmaster's documentation.


@pytest.fixture
def robots() -> Parameters:
    return parameters(
        {
            "robot_description": {"arm": 1, "base": 1},
            "pr2": {"robot_description": {"base": 1}, "leaf": 1},
        }
    )


@pytest.mark.parametrize(
    ("key", "namespace", "found"),
    [
        ("robot_description", "/pr2/foo", "/pr2/robot_description"),
        ("robot_description/arm", "/pr2/foo", "/pr2/robot_description/arm"),
        ("robot_description", "/pr2", "/pr2/robot_description"),
        ("robot_description/arm", "/other/node", "/robot_description/arm"),
        ("robot_description", "/", "/robot_description"),
        ("base", "/pr2/robot_description", "/pr2/robot_description/base"),
        ("leaf", "/pr2/leaf/deeper", "/pr2/leaf"),
        ("leaf/", "/pr2", "/pr2/leaf"),
        ("nothing", "/pr2/foo", None),
        ("arm", "/pr2/foo", None),
        ("/pr2/leaf", "/", "/pr2/leaf"),
        ("/leaf", "/pr2", None),
    ],
)
def test_search_goes_upwards_from_the_namespace(
    robots: Parameters, key: str, namespace: str, found: str | None
) -> None:
    assert robots.search(key, namespace) == found


@pytest.mark.parametrize(
    ("key", "namespace"),
    [("", "/"), ("~x", "/"), ("x", "pr2"), ("x", ""), ("x" * MAX_LENGTH, "/")],
)
def test_search_needs_a_relative_name_and_a_global_namespace(
    robots: Parameters, key: str, namespace: str
) -> None:
    with pytest.raises(InvalidName):
        robots.search(key, namespace)


# Names.


def test_names_lists_values_in_order() -> None:
    tree = parameters({"b": {"y": 1, "x": {}}, "a": [{"no": "name"}], "c": {}})
    assert tree.names() == ["/a", "/b/y"]


def test_new_tree_is_empty() -> None:
    assert Parameters(UNLIMITED).names() == []
    assert Parameters(UNLIMITED).get("/") == {}


# Limits.


def test_value_beyond_the_limit_changes_nothing_and_names_the_setting() -> None:
    tree = parameters(max_bytes=1000)
    with pytest.raises(ParametersFull) as error:
        tree.set("/x", "a" * 1000)
    assert (error.value.needed, error.value.limit) == (1208, 1000)
    assert "1000" in str(error.value)
    assert "--max-parameter-bytes" in str(error.value)
    assert tree.names() == []
    tree.set("/x", "a" * 600)


def test_deleted_and_replaced_values_free_their_bytes() -> None:
    tree = parameters(max_bytes=1000)
    for name in ("/x", "/x/y", "/z"):
        for _ in range(10):
            tree.set(name, "a" * 500)
        tree.delete(name)
        tree.set("/", {})


def test_replacement_needs_only_the_difference() -> None:
    tree = parameters({"x": {"y": "a" * 500}}, max_bytes=1000)
    tree.set("/x", "b" * 600)
    with pytest.raises(ParametersFull):
        tree.set("/y", "c" * 600)


def test_names_and_namespaces_count_towards_the_limit() -> None:
    tree = parameters(max_bytes=100 * ENTRY_OVERHEAD)
    with pytest.raises(ParametersFull):
        tree.set("/a" * DEEPEST, 1)


KEYS = st.sampled_from(["a", "b", "c"])
VALUES: st.SearchStrategy[Any] = st.recursive(
    st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda values: st.lists(values, max_size=3) | st.dictionaries(KEYS, values, max_size=3),
    max_leaves=5,
)
PATHS = st.lists(KEYS, max_size=4)


def set_in_model(tree: dict[str, Any], path: list[str], value: Any) -> None:
    """Set a value as rosmaster's documentation describes it."""
    for key in path[:-1]:
        if not isinstance(tree.get(key), dict):
            tree[key] = {}
        tree = tree[key]
    tree[path[-1]] = value


@given(st.lists(st.tuples(PATHS, VALUES), max_size=8), st.lists(PATHS, max_size=3))
def test_any_changes_give_the_same_tree_as_a_simple_model(
    changes: list[tuple[list[str], Any]], deleted: list[list[str]]
) -> None:
    model: dict[str, Any] = {}
    tree = Parameters(UNLIMITED)
    for path, value in changes:
        if path:
            set_in_model(model, path, value)
            tree.set("/" + "/".join(path), value)
    for path in deleted:
        name = "/" + "/".join(path)
        if path and tree.has(name):
            tree.delete(name)
            space = model
            for key in path[:-1]:
                space = space[key]
            del space[path[-1]]
    assert tree.get("/") == model
    fresh = Parameters(UNLIMITED)
    fresh.set("/", model)
    assert tree.bytes == fresh.bytes


def test_change_costs_the_same_however_large_the_tree_is(monkeypatch: pytest.MonkeyPatch) -> None:
    steps: list[str] = []
    tree = parameters({f"p{number}": {"x": number} for number in range(1000)}, max_bytes=2**30)
    for name in ("_to_tree", "_size", "_check"):
        monkeypatch.setattr(module, name, counted(name, getattr(module, name), steps))
    tree.set("/p5/x", 1)
    tree.set("/p6/y/z", 1)
    tree.delete("/p7")
    assert 0 < len(steps) < 20


def counted(name: str, function: Any, steps: list[str]) -> Any:
    def call(*args: Any) -> Any:
        steps.append(name)
        return function(*args)

    return call


def test_values_that_json_lacks_are_kept() -> None:
    tree = parameters()
    value = {
        "bytes": b"\x00\xff",
        "date": datetime(2026, 1, 31, 12, 0, 5),
        "list": [math.inf, -math.inf, {"bytes": b"x"}],
    }
    tree.set("/x", value)
    assert tree.get("/x/bytes") == {"$binary": "AP8="}
    assert tree.get("/x/date") == {"$date": "2026-01-31T12:00:05"}
    assert native(tree.get("/x")) == value
    assert sorted(tree.names()) == ["/x/bytes", "/x/date", "/x/list"]


def test_dict_with_keys_that_are_not_names_is_one_value() -> None:
    tree = parameters()
    value = {"slash": {"a/b": 1, "c": {"d": 2}}, "empty": {"": "x"}, "plain": {"a b": 3}}
    tree.set("/x", value)
    assert tree.get("/x") == value
    assert tree.names() == ["/x/empty", "/x/plain/a b", "/x/slash"]
    assert list(names_in("/x", value)) == ["/x/slash", "/x/empty", "/x/plain/a b"]
    assert not tree.has("/x/slash/a/b")
    tree.set("/x/empty/new", 1)
    assert tree.get("/x/empty") == {"new": 1}
    tree.delete("/x")
    assert tree.bytes == parameters().bytes


@pytest.mark.parametrize("value", [{"a/b": 1}, {"": 1}, {"$binary": "AP8="}, 5, [1]])
def test_root_is_a_namespace(value: object) -> None:
    tree = parameters({"a": 1})
    with pytest.raises(ParameterError, match="set it to an object of names"):
        tree.set("/", value)
    assert tree.get("/") == {"a": 1}


def test_nan_is_null() -> None:
    tree = parameters({"x": math.nan})
    assert tree.text("/x") == b"null"
    assert math.isnan(native(tree.get("/x")))


def test_changes_are_reported_with_the_node() -> None:
    tree, changes = parameters(), list[tuple[str, str]]()
    tree.watch(lambda name, node: changes.append((name, node)))
    tree.set("/a//b/", 1, "/node")
    tree.delete("/a", "/other")
    with pytest.raises(ParameterError):
        tree.set("/x", None)
    assert changes == [("/a/b", "/node"), ("/a", "/other")]


def test_leaves_are_values_and_empty_namespaces() -> None:
    parameters = Parameters(10_000)
    parameters.set("/a", {"b": {}, "c": {"d": 1}, "e": []})
    assert parameters.leaves("/a") == ["/a/b", "/a/c/d", "/a/e"]
    assert parameters.leaves("/a/b") == ["/a/b"]
    assert parameters.leaves("/x") == []
    names = ["/a", "/a/b", "/a/c", "/a/c/d", "/a/e", "/x"]
    assert [name for name in names if parameters.is_leaf(name)] == ["/a/b", "/a/c/d", "/a/e"]
