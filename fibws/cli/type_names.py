"""Names of types as people shorten them: ``String`` for ``std_msgs/String``."""

from __future__ import annotations

import click


def full_name(type_: str) -> str:
    """Return the name of a message type; one without a package raises `UsageError`."""
    if "/" in type_:
        return type_
    from fibws.values.installed_types import Installed  # which only this error has a use for

    installed = Installed("msg")
    nearest = installed.nearest(type_)
    found = installed.find(type_) or ([nearest] if nearest else [])
    meant = f"; did you mean {' or '.join(found)}?" if found else ", as in std_msgs/String."
    raise click.UsageError(f"{type_!r} lacks its package{meant}")
