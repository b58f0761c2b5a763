"""The programs of topic_tools, and the base of nodes that subscribe only when they are needed."""

from __future__ import annotations

from topic_tools.lazy_transport import LazyTransport

__all__ = ["LazyTransport"]
