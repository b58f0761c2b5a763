"""The errors of rospy.

ROSException
├── ROSSerializationException          a message does not fit its type
├── ROSInitException                   init_node was not called, or failed
└── ROSInterruptException              the node ends; also a KeyboardInterrupt
    └── ROSTimeMovedBackwardsException
ROSInternalException
└── TransportException
    ├── TransportTerminated
    └── TransportInitError
"""

from __future__ import annotations


class ROSException(Exception):
    """The base of errors of a ROS client."""


class ROSSerializationException(ROSException):
    """A message does not fit its type."""


class ROSInitException(ROSException):
    """`init_node` was not called, or failed."""


class ROSInterruptException(ROSException, KeyboardInterrupt):
    """A call that waits was interrupted by the node's end."""


class ROSTimeMovedBackwardsException(ROSInterruptException):
    """Simulated time went back during a sleep.

    Args:
        time: the difference in seconds.
    """

    def __init__(self, time: float) -> None:
        self.time = time
        super().__init__("ROS time moved backwards")


class ROSInternalException(Exception):
    """The base of internal errors."""


class TransportException(ROSInternalException):
    """The connection to another node failed."""


class TransportTerminated(TransportException):
    """The connection to another node was closed."""


class TransportInitError(TransportException):
    """The connection to another node could not be made."""
