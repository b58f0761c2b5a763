"""Names that scripts import from rospy.impl."""

from __future__ import annotations

import rospy
from rospy.impl import tcpros, tcpros_base, tcpros_service


def test_services_are_those_of_rospy() -> None:
    for name in tcpros_service.__all__:
        assert getattr(tcpros_service, name) is getattr(rospy, name)


def test_buffer_size_is_that_of_rospy() -> None:
    assert tcpros.DEFAULT_BUFF_SIZE == tcpros_base.DEFAULT_BUFF_SIZE == 65536
