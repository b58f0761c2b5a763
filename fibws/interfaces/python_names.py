"""The Python attributes of fields whose names Python or the generated classes need themselves."""

from __future__ import annotations

import keyword

RESERVED = frozenset(keyword.kwlist) | {
    *("bool", "bytes", "float", "int", "list", "str"),
    *("ClassVar", "dataclass", "field", "ros"),
    *("from_dict", "to_dict"),
}
"""Names that a field cannot have in Python: a ``_`` is appended."""


def python_name(name: str) -> str:
    """Return the attribute for a field: ``from_`` for ``from``, and ``from__`` for ``from_``."""
    return f"{name}_" if name.rstrip("_") in RESERVED else name


def ros_name(attribute: str) -> str:
    """Return the field's name for an attribute."""
    return attribute[:-1] if attribute.rstrip("_") in RESERVED else attribute
