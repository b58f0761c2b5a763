"""How public classes look: what help and completion show, and errors of common mistakes."""

from __future__ import annotations

import asyncio
import inspect
from collections.abc import Callable, Mapping
from functools import wraps
from inspect import Parameter, Signature
from types import FunctionType
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, TypeVar

from fibws.suggestions import suggestion_or_known

C = TypeVar("C", bound=type[Any])


class Public:
    """The base of public classes.

    `dir`, and Python's "Did you mean", leave out what is not API. Calls whose arguments do not fit
    raise a TypeError that says what would be right; Python's own only counts them.
    """

    __slots__ = ()

    _hints: ClassVar[Mapping[str, str]] = {}
    """What to write in place of common mistakes, by the name of the method."""
    _other_names: ClassVar[Mapping[str, str]] = {}
    """What to write in place of methods that other libraries have, by their names."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if cls.__module__.startswith("fibws."):
            for name, each in [*vars(cls).items()]:
                if isinstance(each, FunctionType) and (name == "__init__" or name[0] != "_"):
                    setattr(cls, name, _with_usage(cls, each))

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if (right := self._other_names.get(name)) is None:
                return object.__getattribute__(self, name)  # Raises the usual error.
            text = f"{type(self).__name__!r} object has no attribute {name!r}; write {right}"
            raise AttributeError(text)

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


def _with_usage(class_: type[Any], function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a method whose arguments are explained if they do not fit."""
    parameters = [*inspect.signature(function).parameters.values()][1:]
    takes_all = {Parameter.VAR_POSITIONAL, Parameter.VAR_KEYWORD}
    if not parameters or takes_all <= {each.kind for each in parameters}:
        return function

    @wraps(function)
    def checked(*arguments: Any, **named: Any) -> Any:
        try:
            return function(*arguments, **named)
        except TypeError as error:
            # Only an error of the call itself has no further frame.
            if error.__traceback__ is None or error.__traceback__.tb_next is not None:
                raise
            fault = _mismatch(class_, checked, parameters, arguments[1:], named)
        raise TypeError(fault)

    if inspect.iscoroutinefunction(function):
        _mark_coroutine_function(checked)
    return checked


def _mark_coroutine_function(function: Any) -> None:
    """Let `iscoroutinefunction` be true for what returns a coroutine, as mocks expect."""
    if mark := getattr(inspect, "markcoroutinefunction", None):  # From Python 3.12 on.
        mark(function)
    else:
        function._is_coroutine = getattr(asyncio.coroutines, "_is_coroutine", None)


def _mismatch(
    class_: type[Any],
    function: Callable[..., Any],
    parameters: list[Parameter],
    arguments: tuple[Any, ...],
    named: Mapping[str, Any],
) -> str:
    """Return why arguments do not fit a method's parameters, and what to write."""
    is_constructor = function.__name__ == "__init__"
    if is_constructor and not [*inspect.signature(function).parameters][1:]:
        return f"{class_.__name__}: {function.__doc__}"
    name = class_.__name__ if is_constructor else f"{class_.__name__}.{function.__name__}"
    by_position = [each for each in parameters if each.kind is Parameter.POSITIONAL_OR_KEYWORD]
    by_name = [each.name for each in parameters if each.kind is Parameter.KEYWORD_ONLY]
    known = [each.name for each in parameters]
    unknown = [each for each in named if each not in known]
    hint = class_._hints.get(function.__name__)
    right = f"; {hint}" if hint else f"; write {_usage(name, by_position, by_name)}"
    if unknown:
        meant = suggestion_or_known(unknown[0], known)
        return f"{name}() has no argument {unknown[0]}{meant}{f'; {hint}' if hint else ''}"
    if len(arguments) > len(by_position):
        most = f"{len(by_position)} argument{'s' * (len(by_position) != 1)}"
        return f"{name}() takes {most} by position, got {len(arguments)}{right}"
    missing = [
        each.name
        for each in parameters[len(arguments) :]
        if each.default is Parameter.empty and each.name not in named
    ]
    if missing:
        return f"{name}() needs {' and '.join(missing)}{right}"
    twice = [each.name for each in by_position[: len(arguments)] if each.name in named]
    return f"{name}() got {', '.join(twice)} twice{right}"


def _usage(name: str, by_position: list[Parameter], by_name: list[str]) -> str:
    """Return a call as one writes it: ``advertise(topic, type, queue_size=..., ...)``."""
    shown = [
        each.name if each.default is Parameter.empty else f"{each.name}=..." for each in by_position
    ]
    shown += [f"{each}=..." for each in by_name[:2]]
    return f"{name.rpartition('.')[2]}({', '.join(shown)}{', ...' if len(by_name) > 2 else ''})"
