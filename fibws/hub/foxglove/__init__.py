"""Foxglove's WebSocket protocol: the operations of one client, by its own endpoint and sinks."""
