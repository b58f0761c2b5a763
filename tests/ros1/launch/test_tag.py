"""The tags of launch files."""

from __future__ import annotations

import pytest

from fibws.errors import LaunchError
from fibws.ros1.launch.tag import read


def test_a_tag_tells_where_it_stands() -> None:
    [node] = read(b"<launch>\n  <node/>\n</launch>", "a.launch").children
    assert str(node.fault("it has no name")) == "a.launch:2: it has no name"


def test_what_is_no_xml_is_an_error_of_the_launch_file() -> None:
    with pytest.raises(LaunchError, match=r"a\.launch:1: this is no XML"):
        read(b"<launch>", "a.launch")
