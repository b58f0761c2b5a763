"""What editors import from rospy's inside is rospy's own."""

from __future__ import annotations

import rospy
from rospy.impl import tcpros, tcpros_base, tcpros_service


def test_services_are_rospys() -> None:
    for name in tcpros_service.__all__:
        assert getattr(tcpros_service, name) is getattr(rospy, name)


def test_the_size_of_a_buffer_is_rospys() -> None:
    assert tcpros.DEFAULT_BUFF_SIZE == tcpros_base.DEFAULT_BUFF_SIZE == 65536
