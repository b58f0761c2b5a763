"""``$(arg x)``, ``$(find p)`` and the others in the attributes of launch files."""

from __future__ import annotations

import os.path
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from fibws.ros1.launch.evaluation import evaluate
from fibws.ros1.launch.value import automatic
from fibws.suggestions import suggestion_or_known

if TYPE_CHECKING:
    from fibws.ros1.launch.scope import Scope

MOST_CHARACTERS = 1_000_000
"""Of an attribute with all put in: arguments that hold each other twice grow without end."""
_COMMAND = re.compile(r"\$\(([^()$]*)\)")
_EVAL = "$(eval "


def substitute(text: str, scope: Scope) -> str:
    """A text with every ``$(...)`` in it replaced.

    Args:
        text: that of an attribute.
        scope: what holds where it stands.

    Raises:
        ValueError: one of them is not known, or stands for nothing.
        fibws.errors.WorkspaceError: a package is not found.
    """
    if "$(" not in text:
        return text
    if text.startswith(_EVAL) and text.endswith(")"):
        return _evaluated(text[len(_EVAL) : -1], scope)
    if _EVAL in text:
        raise ValueError("$(eval ...) must be all of it: nothing may stand before or behind it")
    rest = _COMMAND.sub("", text)
    if "$(" in rest:
        fault = "is not closed" if ")" not in rest else "has another ( or $ in it"
        raise ValueError(f"a $( {fault}: {text}")
    length = len(text)

    def put_in(found: re.Match[str]) -> str:
        nonlocal length
        value = _replaced(found, scope)
        length += len(value)
        if length > MOST_CHARACTERS:
            raise ValueError(f"{found[0]} makes this longer than {MOST_CHARACTERS} characters")
        return value

    return _COMMAND.sub(put_in, text)


def _replaced(found: re.Match[str], scope: Scope) -> str:
    command, *words = found[1].split() or [""]
    if command not in _REPLACE:
        near = suggestion_or_known(command, [*_REPLACE, "eval"])
        raise ValueError(f"{found[0]}: there is no $({command}){near}")
    return _REPLACE[command](words, scope)


def _arg(words: list[str], scope: Scope) -> str:
    return scope.argument(_one("arg", words))


def _env(words: list[str], scope: Scope) -> str:
    name = _one("env", words)
    if name not in scope.world.environment:
        raise ValueError(
            f"the environment variable {name} is not set; $(optenv {name}) need not be"
        )
    return scope.world.environment[name]


def _optenv(words: list[str], scope: Scope) -> str:
    if not words:
        raise ValueError("$(optenv) names no variable: write $(optenv NAME DEFAULT)")
    return scope.world.environment.get(words[0], " ".join(words[1:]))


def _anon(words: list[str], scope: Scope) -> str:
    return scope.anonymous(_one("anon", words))


def _dirname(words: list[str], scope: Scope) -> str:
    if words:
        raise ValueError("$(dirname) takes no words")
    if scope.file.startswith("<"):
        raise ValueError("$(dirname): what is read from standard input is in no folder")
    return os.path.dirname(os.path.abspath(scope.file))


def _find(words: list[str], scope: Scope) -> str:
    return str(scope.world.find(_one("find", words)))


def _one(command: str, words: list[str]) -> str:
    if len(words) != 1:
        raise ValueError(f"$({' '.join([command, *words])}): write one name, $({command} NAME)")
    return words[0]


_REPLACE: dict[str, Callable[[list[str], Scope], str]] = {
    "arg": _arg,
    "env": _env,
    "optenv": _optenv,
    "anon": _anon,
    "dirname": _dirname,
    "find": _find,
}


def _evaluated(expression: str, scope: Scope) -> str:
    functions: dict[str, Callable[..., Any]] = {
        "arg": lambda name: automatic(_arg([name], scope)),
        "env": lambda name: _env([name], scope),
        "optenv": lambda name, default="": _optenv([name, default], scope),
        "find": lambda package: _find([package], scope),
        "anon": lambda name: _anon([name], scope),
        "dirname": lambda: _dirname([], scope),
    }
    try:
        return str(evaluate(expression, _Names(scope, functions)))
    except ValueError as error:
        raise ValueError(f"$(eval {expression}): {error}") from None


class _Names(dict[str, Any]):
    """What an expression may name: the functions given, and the arguments."""

    def __init__(self, scope: Scope, functions: dict[str, Callable[..., Any]]) -> None:
        super().__init__(functions)
        self._scope = scope

    def __missing__(self, name: str) -> Any:
        if name in self._scope.values or name in self._scope.declared:
            return automatic(self._scope.argument(name))
        raise KeyError(name)
