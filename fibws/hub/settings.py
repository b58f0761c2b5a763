"""What an operator can set: the default, the unit, what it is for."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from fibws.errors import HubError

KIB = 1024
MIB = 1024 * KIB


def _setting(default: Any, help_: str) -> Any:
    return field(default=default, metadata={"help": help_})


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """The hub's settings; each is a flag of ``python -m fibws.hub`` as well.

    Raises:
        HubError: a number is below 0, a port is none, an origin has no scheme.
    """

    host: str = _setting("127.0.0.1", "Address to listen on; 0.0.0.0 lets other machines in.")
    port: int = _setting(9090, "Port to listen on; 0 takes a free one.")
    allow_origin: tuple[str, ...] = _setting(
        (),
        "Web page origin that may connect besides this machine's own, such as "
        "https://lab.example, null (pages opened as files) or * (any); may be repeated.",
    )
    interfaces: tuple[Path, ...] = _setting(
        (), "Folder of message definitions (PACKAGE/msg/*.msg); may be repeated."
    )
    strict_types: bool = _setting(
        False, "Refuse topics whose type's package is unknown, rather than relay them unchecked."
    )
    queue_length: int = _setting(
        1000, "Messages kept for a subscription that names no queue_length and falls behind."
    )
    service_timeout: float = _setting(
        60.0, "Seconds in which a service must answer if the call names no time; 0 for no limit."
    )
    strict_responses: bool = _setting(
        False,
        "Take a service_response whose result is false for a failure, even if it has values.",
    )
    max_advertisements: int = _setting(
        5000, "Topics that one client may advertise; so many services and so many actions, too."
    )
    max_subscriptions: int = _setting(5000, "Topics that one client may subscribe to.")
    max_calls: int = _setting(1000, "Service calls that one client may wait for at once.")
    max_goals: int = _setting(1000, "Goals that one client may wait for at once.")
    max_queued_bytes: int = _setting(16 * MIB, "Bytes kept for one client that falls behind.")
    max_latched_bytes: int = _setting(
        64 * MIB, "Bytes of JSON that the latched messages of one client may have together."
    )
    max_fragment_bytes: int = _setting(
        64 * MIB, "Bytes kept of messages of one client whose fragments have not all come."
    )
    max_parameter_bytes: int = _setting(
        4 * MIB, "Bytes of JSON that all parameters may have together."
    )
    stall_timeout: float = _setting(
        30.0, "Seconds for which a client may stop reading before it is closed."
    )
    max_message_size: int = _setting(64 * MIB, "Bytes that one incoming message may have.")
    ping_interval: float = _setting(20.0, "Seconds between two pings; 0 sends none.")
    ping_timeout: float = _setting(20.0, "Seconds in which a client must answer a ping.")
    open_timeout: float = _setting(10.0, "Seconds in which a client must finish its handshake.")
    close_timeout: float = _setting(5.0, "Seconds in which a client must answer a close.")
    fast_framing: bool = _setting(
        True, "Take whole text messages from the bytes at once, not by way of the library's parser."
    )

    def __post_init__(self) -> None:
        for setting in fields(self):
            value = getattr(self, setting.name)
            if isinstance(value, int | float) and not 0 <= value < math.inf:
                flag = setting.name.replace("_", "-")
                raise HubError(f"--{flag} is a number from 0 on, not {value}")
        if self.port > 65535:
            raise HubError(f"--port is a number from 0 to 65535, not {self.port}")
        for origin in self.allow_origin:
            if "://" not in origin and origin not in ("*", "null"):
                raise HubError(f"--allow-origin is such as https://lab.example, not {origin}")
