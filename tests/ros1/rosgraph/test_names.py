"""Names as rosgraph reads them; the expected values are rosgraph's own."""

from __future__ import annotations

import random
import re

import pytest
from rosgraph import myargv, names


@pytest.mark.parametrize(
    ("name", "resolved"),
    [
        ("x", "/robot/x"),
        ("~x", "/robot/node/x"),
        ("/x", "/x"),
        ("a/b/", "/robot/a/b"),
        ("//a//b", "/a/b"),
        ("", "/robot/"),
        ("/", "/"),
    ],
)
def test_name_is_resolved_for_a_node(name: str, resolved: str) -> None:
    assert names.resolve_name(name, "/robot/node") == resolved


def test_resolved_name_is_remapped() -> None:
    assert names.resolve_name("a", "/n", {"/a": "/b"}) == "/b"


@pytest.mark.parametrize(
    ("name", "namespace"),
    [("/robot/arm", "/robot/"), ("/robot/arm/", "/robot/"), ("/x", "/"), ("/", "/"), ("", "/")],
)
def test_name_has_a_namespace(name: str, namespace: str) -> None:
    assert names.namespace(name) == namespace


def test_namespace_of_a_value_that_is_not_a_name_is_an_error() -> None:
    with pytest.raises(TypeError):
        names.namespace(5)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("namespace", "name", "joined"),
    [
        ("/", "x", "/x"),
        ("/a", "x", "/a/x"),
        ("/a/", "x", "/a/x"),
        ("~", "x", "~x"),
        ("", "x", "x"),
        ("/a", "/x", "/x"),
        ("/a", "~x", "~x"),
    ],
)
def test_name_is_joined_with_a_namespace(namespace: str, name: str, joined: str) -> None:
    assert names.ns_join(namespace, name) == joined


def test_command_line_overrides_namespace_of_environment() -> None:
    environment = {"ROS_NAMESPACE": "robot"}
    assert names.get_ros_namespace(environment, ["x", "__ns:=a/b"]) == "/a/b/"
    assert names.get_ros_namespace(environment, ["x"]) == "/robot/"
    assert names.get_ros_namespace({}, ["x"]) == "/"


def test_private_namespace_is_an_error() -> None:
    with pytest.raises(ValueError, match=re.escape("cannot turn [~x] into a global name")):
        names.make_global_ns("~x")


@pytest.mark.parametrize(
    ("name", "is_legal"),
    [
        *[("", True), ("a/b", True), ("~x", True), ("/x", True)],
        *[("1a", False), ("a//b", False), ("a-b", False), (None, False)],
    ],
)
def test_illegal_names_are_recognized(name: str | None, is_legal: bool) -> None:
    assert names.is_legal_name(name) is is_legal


def test_base_name_has_no_namespace() -> None:
    assert names.is_legal_base_name("talker")
    assert not names.is_legal_base_name("/talker")
    assert not names.is_legal_base_name(None)


def test_remappings_are_read_from_the_command_line() -> None:
    arguments = ["talker.py", "a:=b", "~c:=/d", "_x:=1", "__name:=n", "1:=2", "--x:=3", "word"]
    assert names.load_mappings(arguments) == {"a": "b", "~c": "/d", "__name": "n"}
    assert myargv(arguments) == ["talker.py", "word"]


def test_remapping_of_three_names_is_reported_and_ignored(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert names.load_mappings(["a:=b:=c", "d:=e"]) == {"d": "e"}
    assert capsys.readouterr().err == "ERROR: Invalid remapping argument 'a:=b:=c'\n"


def test_script_that_is_not_a_node_resolves_names() -> None:
    assert names.script_resolve_name("tool", "x") == "/x"
    assert names.script_resolve_name("tool", "/x") == "/x"
    assert names.script_resolve_name("tool", "~x") == "/tool/x"
    assert names.script_resolve_name("tool", "") == "/"


def test_anonymous_name_is_legal_and_unique_for_equal_pids_and_random_states(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("os.getpid", lambda: 7)
    state = random.getstate()
    one = names.anonymous_name("talker")
    random.setstate(state)
    other = names.anonymous_name("talker")
    assert one != other
    assert names.is_legal_base_name(one)
