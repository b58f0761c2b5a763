"""What can be wrong with a package.xml."""

from __future__ import annotations


class InvalidManifest(Exception):
    """A package.xml cannot be read; the text names the file, the line and what is wrong."""
