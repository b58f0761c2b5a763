"""What is left of rospy's sockets: a number that scripts give to subscribers of big messages."""

from rospy.topics import DEFAULT_BUFF_SIZE

__all__ = ["DEFAULT_BUFF_SIZE"]
