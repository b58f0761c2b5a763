"""Names of types, and their short forms: ``String`` for ``std_msgs/String``."""

from __future__ import annotations

import click


def is_type(name: str) -> bool:
    """Return whether a name has the form ``package/Type``."""
    package, _, type_ = name.partition("/")
    return package.isidentifier() and type_.isidentifier()


def check_short_name(type_: str) -> None:
    """Raise `UsageError` if no package has a message type of this name."""
    from fibws.values.type_definitions import InstalledTypes  # As below.

    installed = InstalledTypes("msg")
    if not installed.find(type_):
        nearest = installed.nearest(type_)
        meant = f"; did you mean {nearest}?" if nearest else ""
        raise click.UsageError(f"unknown type {type_!r}{meant}")


def full_name(type_: str) -> str:
    """Return the name of a message type; raise `UsageError` if it has no package."""
    if "/" in type_:
        return type_
    from fibws.values.type_definitions import InstalledTypes  # Only this error needs it.

    installed = InstalledTypes("msg")
    nearest = installed.nearest(type_)
    found = installed.find(type_) or ([nearest] if nearest else [])
    meant = f"did you mean {' or '.join(found)}?" if found else "example: std_msgs/String"
    raise click.UsageError(f"type {type_!r} has no package; {meant}")
