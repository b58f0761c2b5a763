"""Environment variables of ROS."""

from __future__ import annotations

import pytest
from rosgraph.rosenv import DEFAULT_MASTER_URI, get_master_uri


def test_command_line_overrides_the_environment() -> None:
    environment = {"ROS_MASTER_URI": "http://robot:11311"}
    assert get_master_uri(environment, ["x", "__master:=http://here:1"]) == "http://here:1"
    assert get_master_uri(environment, ["x", "a:=b"]) == "http://robot:11311"
    assert get_master_uri({}, []) == DEFAULT_MASTER_URI


def test_master_argument_without_value_is_an_error() -> None:
    with pytest.raises(ValueError, match="'__master:=' improperly specified"):
        get_master_uri({}, ["__master:="])
