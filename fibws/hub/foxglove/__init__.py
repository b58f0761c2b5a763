"""Foxglove's WebSocket protocol: the operations of one client, by its own endpoint and sinks."""

from typing import Final

SUBPROTOCOLS: Final = ("foxglove.websocket.v1", "foxglove.sdk.v1")
"""Both are the same on the wire: older programs ask for the first one, the SDK's for the second.

They are here since the hub must know them before the first client loads the rest.
"""
