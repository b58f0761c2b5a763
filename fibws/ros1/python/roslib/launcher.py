"""What scripts began with before there was catkin."""

from __future__ import annotations


def load_manifest(package_name: str, bootstrap_version: str = "0.7") -> None:
    """Do nothing: what a package needs is on the path already."""
