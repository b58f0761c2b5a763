"""Evaluates expressions about messages, under fibws's genpy or, as a script, under the real one.

As a script it reads lines of JSON: ``["define", type, full text]`` makes a class known, and
``["say", expression]`` is answered by a line that holds what `say` returns.
"""

from __future__ import annotations

import copy
import importlib
import io
import json
import pickle
import sys
from collections.abc import Callable
from typing import Any

import genpy
import genpy.message


class World:
    """Where expressions are evaluated.

    Args:
        find: gives the class of a message type.
    """

    def __init__(self, find: Callable[[str], Any]) -> None:
        self._names: dict[str, Any] = {
            **vars(genpy.message),
            "C": find,
            "Duration": genpy.Duration,
            "TVal": genpy.TVal,
            "M": lambda type_, *args, **fields: find(type_)(*args, **fields),
            "Time": genpy.Time,
            "constants": constants,
            "copied": lambda message: copy.deepcopy(message),
            "inf": float("inf"),
            "nan": float("nan"),
            "packed": packed,
            "filled": filled,
            "pickle": pickle,
            "parts": parts,
            "set": assigned,
            "srv": service,
        }

    def say(self, expression: str) -> str:
        """The value's repr, or the error's class and text."""
        try:
            return repr(eval(expression, dict(self._names)))
        except Exception as error:
            return f"{type(error).__name__}: {error}"


def constants(message_class: Any) -> list[tuple[str, Any]]:
    """The constants of a message class."""
    values = (int, float, str)
    found = [(name, value) for name, value in vars(message_class).items() if name[0] != "_"]
    return sorted(each for each in found if isinstance(each[1], values))


def packed(message: Any) -> bytes:
    """The message's bytes."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def service(type_: str) -> Any:
    """The class of a service, imported as scripts do it."""
    package, _, name = type_.partition("/")
    return getattr(importlib.import_module(f"{package}.srv"), name)


def filled(message: Any, args: Any, **keys: Any) -> Any:
    """The message, filled from a list or a dict."""
    genpy.message.fill_message_args(message, args, keys)
    return message


def assigned(message: Any, **fields: Any) -> Any:
    """The message, with some of its fields set."""
    for name, value in fields.items():
        setattr(message, name, value)
    return message


def parts(value: Any) -> Any:
    """Return a message as Python's own types, which distinguish lists from tuples."""
    if isinstance(value, (genpy.Time, genpy.Duration)):
        return (type(value).__name__, value.secs, value.nsecs)
    if isinstance(value, genpy.Message):
        return {name: parts(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, list):
        return [parts(element) for element in value]
    return value


def main() -> None:
    """Answer the lines of the standard input."""
    dynamic = importlib.import_module("genpy.dynamic")
    classes: dict[str, Any] = {}
    world = World(classes.__getitem__)
    for line in sys.stdin:
        task, *arguments = json.loads(line)
        if task == "define":
            made = dynamic.generate_dynamic(*arguments)
            for type_, made_class in made.items():
                made_class.__name__ = type_.partition("/")[2]  # as in generated modules
            classes.update(made)
        else:
            print(json.dumps(world.say(*arguments)), flush=True)


if __name__ == "__main__":
    main()
