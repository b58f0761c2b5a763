"""Messages of any type are taken as they are."""

from __future__ import annotations

from io import BytesIO

import pytest
from genpy.classes import message_class
from rospy.exceptions import ROSException
from rospy.msg import AnyMsg, args_kwds_to_message


def test_a_message_of_any_type_holds_the_bytes() -> None:
    message = AnyMsg().deserialize(b"abc")
    assert message._buff == b"abc"
    buffer = BytesIO()
    message.serialize(buffer)
    assert buffer.getvalue() == b"abc"
    assert (AnyMsg._type, AnyMsg._md5sum, AnyMsg.__slots__) == ("*", "*", ["_buff"])


def test_it_takes_no_fields() -> None:
    with pytest.raises(ROSException, match="AnyMsg does not accept arguments"):
        AnyMsg(b"abc")


def test_it_cannot_be_sent_before_it_has_bytes() -> None:
    with pytest.raises(ROSException, match="AnyMsg is not initialized"):
        AnyMsg().serialize(BytesIO())


def test_it_may_be_published_where_another_type_belongs() -> None:
    message = AnyMsg()
    assert args_kwds_to_message(message_class("std_msgs/Int32"), (message,), {}) is message
