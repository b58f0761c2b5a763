"""The error about a package.xml."""

from __future__ import annotations


class InvalidManifest(Exception):
    """A package.xml is invalid; the text names the file, the line and the reason."""
