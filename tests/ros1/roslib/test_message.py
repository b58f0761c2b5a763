"""Former names in roslib still exist."""

from __future__ import annotations

import sys

import genpy.message
import pytest
import roslib


def test_messages_are_found_by_name() -> None:
    assert roslib.message.get_message_class("std_msgs/Int32")(5).data == 5
    assert roslib.message.get_service_class("std_srvs/Empty")._type == "std_srvs/Empty"
    assert roslib.message.Message is genpy.message.Message
    assert issubclass(roslib.message.SerializationError, roslib.message.ROSMessageException)
    assert roslib.rostime.Time(1).to_sec() == 1.0


def test_load_manifest_changes_nothing() -> None:
    before = list(sys.path)
    roslib.load_manifest("unknown_package")
    assert sys.path == before


def test_script_can_be_interactive() -> None:
    assert not roslib.is_interactive()
    roslib.set_interactive(True)
    assert roslib.is_interactive()
    roslib.set_interactive(False)


def test_unknown_name_is_an_error() -> None:
    with pytest.raises(AttributeError, match="module 'roslib' has no attribute 'rosenv'"):
        _ = roslib.rosenv
