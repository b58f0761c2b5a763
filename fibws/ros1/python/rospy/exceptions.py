"""What rospy raises.

ROSException
├── ROSSerializationException          a message does not fit its type
├── ROSInitException                   the node has not been initialised, or cannot be
└── ROSInterruptException              the node ends; it is a KeyboardInterrupt, too
    └── ROSTimeMovedBackwardsException
ROSInternalException
└── TransportException
    ├── TransportTerminated
    └── TransportInitError
"""

from __future__ import annotations


class ROSException(Exception):
    """The base of what goes wrong in a client of ROS."""


class ROSSerializationException(ROSException):
    """A message does not fit its type."""


class ROSInitException(ROSException):
    """The node has not been initialised, or cannot be."""


class ROSInterruptException(ROSException, KeyboardInterrupt):
    """What waited does so no more, since the node ends."""


class ROSTimeMovedBackwardsException(ROSInterruptException):
    """Simulated time went back while something slept.

    Args:
        time: by how many seconds.
    """

    def __init__(self, time: float) -> None:
        self.time = time
        super().__init__("ROS time moved backwards")


class ROSInternalException(Exception):
    """The base of what goes wrong inside."""


class TransportException(ROSInternalException):
    """The connection to another node failed."""


class TransportTerminated(TransportException):
    """The connection to another node was closed."""


class TransportInitError(TransportException):
    """The connection to another node could not be made."""
