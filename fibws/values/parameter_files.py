"""Parameters as YAML, as rosparam writes and reads it."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fibws import names
from fibws.errors import InvalidValue, ParameterError
from fibws.values import parsing

if TYPE_CHECKING:
    import yaml

MOST_CHARACTERS = 2**26
"""Of a file: no hub takes as many, and a device may have no end."""
NAMESPACE = "_ns"
"""The key by which a document names the namespace of its parameters."""


def written(value: Any) -> str:
    """A value as ``rosparam get`` prints it, to be followed by a line break."""
    return dumped(value).removesuffix("\n...\n")


def dumped(value: Any) -> str:
    """A value as a document that ``rosparam load`` reads."""
    import yaml

    text: str = yaml.safe_dump(value)
    return text


def pretty(value: Any, indent: str = "") -> Iterator[str]:
    """The lines of a value as ``rosparam get -p`` prints them."""
    if isinstance(value, str) and not indent:
        yield value
        return
    if not isinstance(value, dict):
        yield written(value)
        return
    for key, each in sorted(value.items()):
        if isinstance(each, dict):
            yield f"{indent}{key}:"
            yield from pretty(each, f"{indent}  ")
        elif isinstance(each, str) and "\n" in each:
            yield f"{indent}{key}: |"
            yield from (f"{indent}  {line}" for line in each.split("\n"))
        else:
            text = each if isinstance(each, str) else written(each).rstrip("\n")
            yield f"{indent}{key}: {text}"


def text_of(path: Path) -> str:
    """What is in a file; it raises `ClickException` if it cannot be read as text."""
    try:
        with path.open(encoding="utf-8") as file:
            text = file.read(MOST_CHARACTERS + 1)
    except OSError as error:
        raise ParameterError(f"Cannot read {path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ParameterError(f"{path} is no text in UTF-8") from None
    if len(text) > MOST_CHARACTERS:
        raise ParameterError(f"{path} has more than {MOST_CHARACTERS} characters")
    return text


def value(word: str) -> Any:
    """The value that a word in YAML stands for; it raises `UsageError` if that is none."""
    import yaml

    try:
        return yaml.load(word, loader())
    except yaml.YAMLError as error:
        raise InvalidValue(f"This is no YAML: {parsing.fault(error)}: {word!r}") from None
    except parsing.FAULTS as error:
        raise InvalidValue(f"{word[:80]!r}: {error}") from None


def parameters(text: str, namespace: str) -> list[tuple[str, str]]:
    """The parameters in a file, as `leaves` gives them; several documents may be in it.

    Args:
        text: what is in the file.
        namespace: that of all whose names are relative.

    Raises:
        ClickException: the text is no YAML, or there is something in it that no parameter can be.
    """
    import yaml

    found = []
    try:
        for document in yaml.load_all(text, loader()):
            above = namespace
            if isinstance(document, dict) and isinstance(document.get(NAMESPACE), str):
                inner = document.pop(NAMESPACE)
                above = inner if inner.startswith("/") else names.join(namespace, inner)
            if document is not None:
                found += leaves(above, document)
    except yaml.YAMLError as error:
        raise ParameterError(f"This is no YAML: {parsing.fault(error)}") from None
    except parsing.FAULTS as error:
        raise ParameterError(str(error)) from None
    return found


def leaves(name: str, value: Any) -> list[tuple[str, str]]:
    """The names and the values, in JSON, that are to be set for a parameter to have a value.

    An object is many: what else there is in that namespace stays, as with rosparam.

    Raises:
        ClickException: the value is nothing that a parameter can be.
    """
    try:
        parsing.check_size(value)
        return list(_leaves(name, value))
    except RecursionError:
        raise ParameterError(f"{name} has too many values in each other") from None


def _leaves(name: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for key, each in value.items():
            if not isinstance(key, str):
                raise ParameterError(
                    f"{name} has the key {key!r}, which is no text to YAML: write '\"{key}\"'"
                )
            yield from _leaves(names.join(name, key), each)
        return
    if name == "/":
        raise ParameterError("/ is the namespace of all parameters: set it to an object")
    if _has_null(value):
        raise ParameterError(f"Parameter [{name}]: null is no value; to unset it, delete it")
    try:
        yield name, json.dumps(value, ensure_ascii=False, allow_nan=False, default=_refuse)
    except ValueError as error:
        fault = str(error)
        if isinstance(value, float) and not math.isfinite(value):
            fault = f"{value} is no number that JSON has"
        raise ParameterError(f"Parameter [{name}]: {fault}") from None


def _has_null(value: Any) -> bool:
    if isinstance(value, list | dict):
        return any(map(_has_null, value.values() if isinstance(value, dict) else value))
    return value is None


def _refuse(value: object) -> None:
    if isinstance(value, bytes):
        raise ValueError("bytes are no value that JSON has")
    kind = type(value).__name__
    raise ValueError(f"{value} is a {kind} to YAML: put it between quotation marks to be a text")


def loader() -> type[yaml.SafeLoader]:
    """Return the loader of YAML with angles, as rosparam reads it."""
    import yaml

    class Loader(yaml.SafeLoader):
        pass

    for tag, word, angle in (("!degrees", "deg", degrees), ("!radians", "rad", radians)):

        def construct(loader: Any, node: Any, angle: Callable[[str], float] = angle) -> float:
            return angle(str(loader.construct_scalar(node)))

        Loader.add_constructor(tag, construct)
        Loader.add_implicit_resolver(tag, re.compile(rf"{word}\([^)]*\)$"), [word[0]])
    return Loader


def degrees(text: str) -> float:
    """Return the radians of ``deg(180)`` or ``180``; raise `InvalidValue` for anything else."""
    try:
        return math.radians(float(_argument("deg", text)))
    except ValueError:
        raise InvalidValue(f"invalid angle in degrees {text!r}; example: deg(180)") from None


def radians(text: str) -> float:
    """Return the value of ``rad(2*pi)`` or ``2*pi``; raise `InvalidValue` for anything else."""
    from fibws.values.expressions import Expression

    try:
        return float(Expression(_argument("rad", text), {"pi": math.pi}).value())
    except (ValueError, TypeError, OverflowError):
        raise InvalidValue(f"invalid angle in radians {text!r}; example: rad(pi/2)") from None


def _argument(function: str, text: str) -> str:
    text = text.strip()
    return text[len(function) + 1 : -1] if text.startswith(f"{function}(") else text
