"""The messages of rosbridge_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros

__all__ = [
    "ConnectedClient",
    "ConnectedClients",
]


@dataclass(slots=True, eq=False, repr=False)
class ConnectedClient(ros.Message):
    """rosbridge_msgs/ConnectedClient"""

    _type: ClassVar[str] = "rosbridge_msgs/ConnectedClient"

    ip_address: str = ""
    connection_time: ros.Time = field(default_factory=ros.Time)


@dataclass(slots=True, eq=False, repr=False)
class ConnectedClients(ros.Message):
    """rosbridge_msgs/ConnectedClients"""

    _type: ClassVar[str] = "rosbridge_msgs/ConnectedClients"

    clients: list[ConnectedClient] = field(default_factory=list)
