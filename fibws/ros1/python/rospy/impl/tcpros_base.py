"""What is left of rospy's sockets: a number that scripts give to subscribers of big messages."""

DEFAULT_BUFF_SIZE = 65536
"""Bytes that rospy reads at once from a socket; here they mean nothing."""
