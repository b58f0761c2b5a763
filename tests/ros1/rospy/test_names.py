"""Resolving names in a process."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from rospy import names
from rospy.exceptions import ROSException, ROSInitException


@pytest.fixture
def robot() -> Iterator[None]:
    """This process is the node /robot/talker, and three names are remapped."""
    names.reload_mappings(["chatter:=/word", "~mine:=yours", "__name:=x", "hidden:=~mine"])
    names._set_caller_id("/robot/talker")
    names.initialize_mappings("/robot/talker")
    yield
    names.reload_mappings([])
    names.initialize_mappings("/unnamed")
    names._set_caller_id("/unnamed")


def test_name_is_unnamed_before_init_node() -> None:
    assert names.get_name() == names.get_caller_id() == "/unnamed"
    assert names.get_namespace() == "/"
    assert names.resolve_name("~x") == "/unnamed/x"


@pytest.mark.usefixtures("robot")
def test_node_has_a_name_in_a_namespace() -> None:
    assert names.get_name() == "/robot/talker"
    assert names.get_namespace() == "/robot/"


@pytest.mark.usefixtures("robot")
def test_name_is_resolved_and_then_remapped() -> None:
    assert names.resolve_name("chatter") == "/word"
    assert names.resolve_name("/robot/chatter") == "/word"
    assert names.resolve_name("/chatter") == "/chatter"
    assert names.resolve_name("~mine") == "/robot/yours"
    assert names.resolve_name("chatter", "/other/node") == "/other/chatter"
    assert names.resolve_name(None) == "/robot/"


@pytest.mark.usefixtures("robot")
def test_remap_name_compares_spellings() -> None:
    assert names.remap_name("chatter") == "/word"
    assert names.remap_name("~mine") == "/robot/yours"
    assert names.remap_name("other") == "other"


@pytest.mark.usefixtures("robot")
def test_mappings_can_be_read() -> None:
    assert names.get_mappings()["chatter"] == "/word"
    assert names.get_resolved_mappings()["/robot/chatter"] == "/word"
    assert names.get_resolved_mappings()["__name"] == "x"


def test_name_is_remapped_before_init_node() -> None:
    names.reload_mappings(["chatter:=word", "hidden:=~mine"])
    try:
        assert names.resolve_name_without_node_name("chatter") == "/word"
        assert names.resolve_name_without_node_name("other") == "/other"
        with pytest.raises(ROSInitException, match="hidden cannot be remapped to a ~name"):
            names.resolve_name_without_node_name("hidden")
        with pytest.raises(ValueError, match="before init_node"):
            names.resolve_name_without_node_name("~mine")
    finally:
        names.reload_mappings([])


def test_scoped_name_has_no_namespace() -> None:
    assert names.scoped_name("/foo/node", "/foo/bar/name") == "bar/name"
    with pytest.raises(ROSException, match="must be global"):
        names.scoped_name("node", "/foo/bar")
