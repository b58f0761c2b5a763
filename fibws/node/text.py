"""Texts of the program's own that go to the hub."""

from __future__ import annotations


def sendable(text: str) -> str:
    """``text`` without halves of surrogate pairs, which file names may have, and JSON may not."""
    return text.encode("utf-8", "replace").decode()
