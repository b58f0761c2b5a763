"""A constant that scripts pass to subscribers of big messages."""

DEFAULT_BUFF_SIZE = 65536
"""Size of rospy's receive buffer; it has no effect here."""
