"""How public classes look: what help and completion show, and errors of common mistakes."""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, Signature
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

C = TypeVar("C", bound=type[Any])


class Public:
    """The base of public classes: `dir`, and Python's "Did you mean", leave out what is not API."""

    __slots__ = ()

    def __dir__(self) -> list[str]:
        return [name for name in super().__dir__() if name[0] != "_" or name[:2] == "__"]


class AsyncContext(Public):
    """A public class for ``async with``: a plain ``with`` raises an error that says so."""

    __slots__ = ()

    if not TYPE_CHECKING:  # Type checkers have an error of their own.

        def __enter__(self) -> NoReturn:
            raise TypeError(f"write async with, not with, for a {type(self).__name__}")

        def __exit__(self, *error: object) -> None:
            pass


class AsyncIterable(Public):
    """A public class for ``async for``: a plain ``for`` raises an error that says so."""

    __slots__ = ()

    if not TYPE_CHECKING:

        def __iter__(self) -> NoReturn:
            raise TypeError(f"write async for, not for, for a {type(self).__name__}")


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
