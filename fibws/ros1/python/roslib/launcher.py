"""The start of scripts from before catkin."""

from __future__ import annotations


def load_manifest(package_name: str, bootstrap_version: str = "0.7") -> None:
    """Do nothing: the packages are on the path already."""
