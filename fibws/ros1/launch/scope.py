"""The scope of a tag: namespace, arguments, remappings; and ``$(...)`` evaluated in it."""

from __future__ import annotations

import math
import os.path
import re
from ast import Name, expr
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from fibws import names
from fibws.errors import InvalidValue
from fibws.ros1.launch.environment import Environment
from fibws.suggestions import suggestion_or_known
from fibws.values.expressions import FUNCTIONS, Expression, Names, Value, bounded

PRIVATE = "~"
MOST_CHARACTERS = 1_000_000
"""Longest attribute after substitution; arguments that contain each other twice grow fast."""


@dataclass
class Scope:
    """The scope of a file, <group>, <include> or <node>; it starts as a copy of its parent's.

    Attributes:
        file: the launch file, for ``$(dirname)``.
        namespace: a global name, ``/`` or ``/robot``.
        values: the values of arguments.
        declared: the arguments with an <arg> in this scope.
        passes_all: whether the file was included with pass_all_args, which allows an <arg> to
            change a value.
        names: the names made by ``$(anon)``.
        remaps: the remappings of the nodes that follow.
        private: private parameters of the nodes that follow.
        variables: environment variables of the nodes that follow.
    """

    environment: Environment
    file: str
    namespace: str = "/"
    values: dict[str, str] = field(default_factory=dict)
    declared: set[str] = field(default_factory=set)
    passes_all: bool = False
    names: dict[str, str] = field(default_factory=dict)
    remaps: dict[str, str] = field(default_factory=dict)
    private: dict[str, Any] = field(default_factory=dict)
    variables: dict[str, str] = field(default_factory=dict)

    def inner(self, namespace: str | None = None) -> Scope:
        """Return a scope within this one, in a relative or global namespace."""
        return replace(
            self,
            namespace=self.namespace if namespace is None else self.join(namespace),
            values=dict(self.values),
            declared=set(self.declared),
            passes_all=False,
            names=dict(self.names),
            remaps=dict(self.remaps),
            private=dict(self.private),
            variables=dict(self.variables),
        )

    def included(self, file: str, namespace: str | None, *, passes_all: bool) -> Scope:
        """Return the scope of an included file.

        Args:
            file: the launch file.
            namespace: as for `inner`.
            passes_all: whether it gets all arguments of this scope; otherwise it gets none.
        """
        inner = self.inner(namespace)
        values = inner.values if passes_all else {}
        return replace(
            inner, file=file, values=values, declared=set(), passes_all=passes_all, names={}
        )

    def join(self, name: str) -> str:
        """Return the global name for a name in this namespace."""
        return normalized(name if name.startswith("/") else names.join(self.namespace, name))

    def remap(self, source: str, target: str) -> None:
        """Remap a name for the nodes that follow."""
        self.remaps.pop(source, None)
        self.remaps[source] = target

    def argument(self, name: str) -> str:
        """Return the value of an argument, or raise `ValueError`."""
        if name in self.values:
            return self.values[name]
        if name in self.declared:
            raise ValueError(f"missing value of arg {name}; pass {name}:=VALUE")
        raise ValueError(f"unknown arg {name}{suggestion_or_known(name, sorted(self.declared))}")

    def anonymous(self, name: str) -> str:
        """Return the name for ``$(anon name)``, the same one every time."""
        if name not in self.names:
            self.names[name] = self.environment.anonymous(name)
        return self.names[name]


def normalized(name: str) -> str:
    """Return a name without redundant slashes: ``/a/b`` for ``/a//b/``."""
    first = "/" if name.startswith("/") else ""
    return first + "/".join(part for part in name.split("/") if part)


def boolean(text: str) -> bool:
    """Return the bool in a text; raise `ValueError` if it is neither true nor false."""
    value = {"true": True, "1": True, "false": False, "0": False}.get(text.strip().lower())
    if value is None:
        raise ValueError(f"expected true or false, got {text!r}")
    return value


def automatic(text: str) -> bool | int | float | str:
    """Return the number or the bool in a text, or else the text."""
    try:
        if "." in text:
            return float(text)
        if "_" not in text:
            # Python reads 1_000 as a number; no other ROS tool does.
            return int(text)
    except ValueError:
        pass
    return boolean(text) if text.lower() in ("true", "false") else text


_SUBSTITUTION = re.compile(r"\$\(([^()$]*)\)")
_EVAL = "$(eval "


def substitute(text: str, scope: Scope) -> str:
    """Return the text of an attribute with every ``$(...)`` replaced.

    Raises:
        ValueError: a substitution is invalid.
        fibws.ros1.errors.WorkspaceError: a package is not found.
    """
    if "$(" not in text:
        return text
    if text.startswith(_EVAL) and text.endswith(")"):
        return _eval(text[len(_EVAL) : -1], scope)
    if _EVAL in text:
        raise ValueError("$(eval ...) must be the whole text")
    rest = _SUBSTITUTION.sub("", text)
    if "$(" in rest:
        fault = "unclosed $(" if ")" not in rest else "( or $ within $(...)"
        raise ValueError(f"{fault}: {text}")
    length = len(text)

    def value_of(found: re.Match[str]) -> str:
        nonlocal length
        command, *words = found[1].split() or [""]
        if command not in _COMMANDS:
            near = suggestion_or_known(command, [*_COMMANDS, "eval"])
            raise ValueError(f"unknown substitution {found[0]}{near}")
        value = _COMMANDS[command](words, scope)
        length += len(value)
        if length > MOST_CHARACTERS:
            raise ValueError(f"text too long with {found[0]} (limit is {MOST_CHARACTERS})")
        return value

    return _SUBSTITUTION.sub(value_of, text)


def _arg(words: list[str], scope: Scope) -> str:
    return scope.argument(_one_name("arg", words))


def _env(words: list[str], scope: Scope) -> str:
    name = _one_name("env", words)
    if name not in scope.environment.variables:
        raise ValueError(f"environment variable {name} is not set; see also $(optenv {name})")
    return scope.environment.variables[name]


def _optenv(words: list[str], scope: Scope) -> str:
    if not words:
        raise ValueError("$(optenv): missing name; expected $(optenv NAME DEFAULT)")
    return scope.environment.variables.get(words[0], " ".join(words[1:]))


def _anon(words: list[str], scope: Scope) -> str:
    return scope.anonymous(_one_name("anon", words))


def _dirname(words: list[str], scope: Scope) -> str:
    if words:
        raise ValueError("$(dirname) takes no arguments")
    if scope.file.startswith("<"):
        raise ValueError("$(dirname): standard input has no folder")
    return os.path.dirname(os.path.abspath(scope.file))


def _find(words: list[str], scope: Scope) -> str:
    return str(scope.environment.find(_one_name("find", words)))


def _one_name(command: str, words: list[str]) -> str:
    if len(words) != 1:
        raise ValueError(f"$({' '.join([command, *words])}): expected $({command} NAME)")
    return words[0]


_COMMANDS: dict[str, Callable[[list[str], Scope], str]] = {
    "arg": _arg,
    "env": _env,
    "optenv": _optenv,
    "anon": _anon,
    "dirname": _dirname,
    "find": _find,
}


def _limited(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function for small numbers only."""

    def limited(*arguments: Any) -> Any:
        if not all(map(_is_small, arguments)):
            raise InvalidValue("number too large (limit: 1000)")
        return function(*arguments)

    return limited


def _is_small(value: Any) -> bool:
    if isinstance(value, list):
        return len(value) <= 100 and all(map(_is_small, value))
    return isinstance(value, int | float) and abs(value) <= 1000


_GROWING = ("factorial", "comb", "perm", "prod", "lcm")
"""Functions whose results are much larger than their arguments."""
_MATH = {name: each for name, each in vars(math).items() if not name.startswith("_")}
ALLOWED_NAMES: Names = {
    **_MATH,
    **{name: _limited(_MATH[name]) for name in _GROWING},
    **FUNCTIONS,
    "true": True,
    "false": False,
}
"""The names that every expression may use, as in roslaunch."""


def evaluate(expression: str, variables: Mapping[str, Any]) -> Any:
    """Return the value of an expression.

    Args:
        expression: Python: ``arg('speed') > 2``.
        variables: what it may use besides `ALLOWED_NAMES`: values and functions.

    Raises:
        InvalidValue: it is not an expression, uses something that is not allowed, or fails.
    """
    if "__" in expression:
        raise InvalidValue("double underscores are not allowed")

    def variable(part: expr) -> Value | None:
        if not isinstance(part, Name):
            return None
        name = part.id

        def value(_: Any) -> Any:
            try:
                return bounded(variables[name])
            except KeyError:
                raise InvalidValue(f"unknown name {name}: no function, no <arg>") from None

        return value

    return Expression(expression, ALLOWED_NAMES, variable).value()


def _eval(expression: str, scope: Scope) -> str:
    functions: dict[str, Callable[..., Any]] = {
        "arg": lambda name: automatic(_arg([name], scope)),
        "env": lambda name: _env([name], scope),
        "optenv": lambda name, default="": _optenv([name, default], scope),
        "find": lambda package: _find([package], scope),
        "anon": lambda name: _anon([name], scope),
        "dirname": lambda: _dirname([], scope),
    }
    try:
        return str(evaluate(expression, _Variables(scope, functions)))
    except ValueError as error:
        raise ValueError(f"$(eval {expression}): {error}") from None


class _Variables(dict[str, Any]):
    """The functions and the arguments that an expression may use."""

    def __init__(self, scope: Scope, functions: dict[str, Callable[..., Any]]) -> None:
        super().__init__(functions)
        self._scope = scope

    def __missing__(self, name: str) -> Any:
        if name in self._scope.values or name in self._scope.declared:
            return automatic(self._scope.argument(name))
        raise KeyError(name)
