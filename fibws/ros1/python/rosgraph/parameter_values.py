"""Values of parameters that JSON lacks: NaN, bytes and dates, as the hub keeps them.

The hub has NaN as null, and objects with one key for the others: ``{"$binary": "<base64>"}`` and
``{"$date": "2026-01-31T12:00:00"}``. Programs get `xmlrpc.client.Binary` and `DateTime`, as from
ROS's master, and may set those, bytes and datetimes. xmlrpc.client is loaded when it is needed.
"""

from __future__ import annotations

import math
from typing import Any

BINARY, DATE = "$binary", "$date"
PLAIN = (bool, int, float, str)


def marked(value: Any) -> Any:
    """Return a value as `json` can write it.

    Raises:
        TypeError: a parameter cannot have this value.
    """
    if isinstance(value, PLAIN):
        return value
    if value is None:
        raise TypeError("a parameter cannot be None; delete_param() makes it unset")
    if isinstance(value, dict):
        for key in value:
            if not isinstance(key, str):
                raise TypeError(f"keys of a parameter's dict must be strings, got {key!r}")
        return {key: marked(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [marked(each) for each in value]
    return _special(value)


def _special(value: Any) -> dict[str, str]:
    import base64
    from datetime import datetime
    from xmlrpc.client import Binary, DateTime

    if isinstance(value, Binary):
        value = value.data
    if isinstance(value, bytes | bytearray):
        return {BINARY: base64.b64encode(value).decode()}
    if isinstance(value, DateTime):
        value = datetime.strptime(value.value, "%Y%m%dT%H:%M:%S")
    if isinstance(value, datetime):
        return {DATE: value.replace(microsecond=0, tzinfo=None).isoformat()}
    raise TypeError(f"a parameter cannot be a {type(value).__name__}")


def native(value: Any) -> Any:
    """Return a value that was read from JSON as ROS's master returns it."""
    if value is None:
        return math.nan
    if isinstance(value, list):
        return [native(each) for each in value]
    if not isinstance(value, dict):
        return value
    if len(value) == 1:
        ((key, text),) = value.items()
        if key == BINARY and isinstance(text, str):
            import base64
            from xmlrpc.client import Binary

            return Binary(base64.b64decode(text))
        if key == DATE and isinstance(text, str):
            from datetime import datetime
            from xmlrpc.client import DateTime

            return DateTime(datetime.fromisoformat(text))
    return {key: native(each) for key, each in value.items()}
