"""Values of a call or a goal that are serialized already."""

from __future__ import annotations

from typing import NamedTuple


class SerializedValues(NamedTuple):
    """A request, a response, a goal, feedback or a result in ROS 1's serialization.

    ``md5sum`` is that of the service or the action as the sender knows it; None if the receiver
    knows that it is the same.
    """

    data: bytes
    md5sum: str | None = None
