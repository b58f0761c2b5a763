"""The same as `rospy.impl.tcpros_base`."""

from rospy.impl.tcpros_base import DEFAULT_BUFF_SIZE

__all__ = ["DEFAULT_BUFF_SIZE"]
