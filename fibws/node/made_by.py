"""Classes of which only fibws makes objects: help does not show how."""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, Signature
from typing import Any, TypeVar

C = TypeVar("C", bound=type[Any])


def made_by(*methods: str) -> Callable[[C], C]:
    """Return a decorator that hides the arguments of a class's constructor from help.

    Args:
        methods: what makes its objects, such as ``Node.advertise``.
    """

    def hide(class_: C) -> C:
        constructor = vars(class_)["__init__"]
        constructor.__signature__ = Signature([Parameter("self", Parameter.POSITIONAL_ONLY)])
        constructor.__doc__ = f"Made by {' and '.join(methods)}; programs do not call this."
        return class_

    return hide
