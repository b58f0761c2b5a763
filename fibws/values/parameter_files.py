"""Parameters in YAML, as rosparam writes and reads them."""

from __future__ import annotations

import base64
import json
import math
import re
from collections.abc import Callable, Iterator
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from fibws import names
from fibws.errors import InvalidValue, ParameterError
from fibws.values import parsing

if TYPE_CHECKING:
    import yaml

MAX_CHARACTERS = 2**26
"""Maximum size of a file: no hub takes more, and a device may be endless."""
NAMESPACE = "_ns"
"""The key of the namespace of a document's parameters."""
VALUE = "!value"
"""The tag of an object that is one value, as it has a key that cannot be a part of a name."""
BINARY, DATE = "$binary", "$date"
"""The keys of objects that stand for bytes and dates in the JSON of parameters."""
ANGLES = (("!degrees", "deg"), ("!radians", "rad"))
"""The tags of angles, and the functions that they may be written as."""


class OneValue(dict[str, Any]):
    """An object that is the value of one parameter, rather than a namespace."""


def text(value: Any) -> str:
    """Return a value as ``rosparam get`` prints it, without the last line break."""
    return dumped(value).removesuffix("\n...\n")


def dumped(value: Any) -> str:
    """Return a value as a YAML document, in which a string such as ``deg(90)`` has quotes."""
    import yaml

    document: str = yaml.dump(value, Dumper=_dumper(yaml.SafeDumper))
    return document


def saved(value: Any) -> str:
    """Return a parameter or a namespace as a YAML document from which `entries` restores it.

    Args:
        value: with bytes, dates and NaN as such.
    """
    import yaml

    # The faster one ends some texts in another way.
    base = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
    document: str = yaml.dump(_with_values(value), Dumper=_dumper(base))
    return document


def _with_values(value: Any) -> Any:
    """Return a value whose objects that are no namespaces are marked."""
    if not isinstance(value, dict):
        return value
    if not all(key and "/" not in key for key in value):
        return OneValue(value)
    return {key: _with_values(each) for key, each in value.items()}


def native(value: Any) -> Any:
    """Return a value from the JSON of parameters with bytes, dates and NaN as such."""
    match value:
        case None:
            return math.nan
        case {"$binary": str() as text} if len(value) == 1:
            return base64.b64decode(text)
        case {"$date": str() as text} if len(value) == 1:
            return datetime.fromisoformat(text)
        case dict():
            return {key: native(each) for key, each in value.items()}
        case list():
            return [native(each) for each in value]
    return value


def pretty(value: Any, indent: str = "") -> Iterator[str]:
    """Yield the lines of a value as ``rosparam get -p`` prints it."""
    if isinstance(value, str) and not indent:
        yield value
        return
    if not isinstance(value, dict):
        yield text(value)
        return
    for key, each in sorted(value.items()):
        if isinstance(each, dict):
            yield f"{indent}{key}:"
            yield from pretty(each, f"{indent}  ")
        elif isinstance(each, str) and "\n" in each:
            yield f"{indent}{key}: |"
            yield from (f"{indent}  {line}" for line in each.split("\n"))
        else:
            line = each if isinstance(each, str) else text(each).rstrip("\n")
            yield f"{indent}{key}: {line}"


def read(path: Path) -> str:
    """Return the text of a file; raise `ParameterError` if it cannot be read."""
    try:
        with path.open(encoding="utf-8") as file:
            content = file.read(MAX_CHARACTERS + 1)
    except OSError as error:
        raise ParameterError(f"Cannot read {path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ParameterError(f"{path} is not a UTF-8 text file") from None
    if len(content) > MAX_CHARACTERS:
        raise ParameterError(f"{path} is too long (limit: {MAX_CHARACTERS} characters)")
    return content


def parse(text: str) -> Any:
    """Return the value of a YAML text with angles; raise `InvalidValue` if it is invalid."""
    return parsing.parse(text, loader())


def parameters(text: str, namespace: str) -> list[tuple[str, str]]:
    """Return the parameters in the text of a file with their values in JSON; see `entries`."""
    return [
        (name, json.dumps(value, ensure_ascii=False, default=_marked))
        for name, value in entries(text, namespace)
        if value != {} or isinstance(value, OneValue)
    ]


def entries(text: str, namespace: str) -> list[tuple[str, Any]]:
    """Return the names and the values of the parameters in the text of a file.

    Values may be bytes, dates with a time, NaN, and an empty dict for a namespace with nothing
    in it.

    Args:
        text: YAML with angles, of one document or several.
        namespace: the namespace of relative names.

    Raises:
        InvalidValue: invalid YAML.
        ParameterError: a value that parameters cannot have.
    """
    found: list[tuple[str, Any]] = []
    for document in parsing.documents(text, loader()):
        above = namespace
        if isinstance(document, dict) and isinstance(document.get(NAMESPACE), str):
            inner = document.pop(NAMESPACE)
            above = inner if inner.startswith("/") else names.join(namespace, inner)
        if document is not None:
            found += _entries(above, document)
    return found


def leaves(name: str, value: Any) -> list[tuple[str, str]]:
    """Return the names and the values, in JSON, that set a parameter to a value.

    An object sets a parameter for each of its keys; others in that namespace stay, as in rosparam.

    Raises:
        ParameterError: a value that parameters cannot have.
    """
    try:
        parsing.check_size(value)
    except InvalidValue as error:
        raise ParameterError(f"Parameter [{name}]: {error}") from None
    return [(each, _json(each, leaf)) for each, leaf in _entries(name, value) if leaf != {}]


def _json(name: str, value: Any) -> str:
    try:
        return json.dumps(value, ensure_ascii=False, allow_nan=False, default=_refuse)
    except ValueError as error:
        fault = str(error)
        if isinstance(value, float) and not math.isfinite(value):
            fault = f"{value} is not a JSON number"
        raise ParameterError(f"Parameter [{name}]: {fault}") from None


def _entries(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict) and not isinstance(value, OneValue):
        for key, each in value.items():
            if not isinstance(key, str):
                raise ParameterError(
                    f"Parameter [{name}]: key {key!r} is not a string: quote it, '\"{key}\"'"
                )
            yield from _entries(names.join(name, key), each)
        if not value and name != "/":
            yield name, value
        return
    if name == "/":
        raise ParameterError("expected an object of parameters, as in rate: 10; got a value alone")
    if _has_null(value):
        raise ParameterError(f"Parameter [{name}]: null is not allowed; use delete to unset it")
    yield name, value


def _has_null(value: Any) -> bool:
    if isinstance(value, list | dict):
        return any(map(_has_null, value.values() if isinstance(value, dict) else value))
    return value is None


def _marked(value: object) -> dict[str, str]:
    """Return what JSON lacks as an object."""
    if isinstance(value, bytes):
        return {BINARY: base64.b64encode(value).decode()}
    if isinstance(value, datetime):
        return {DATE: value.isoformat()}
    _refuse(value)


def _refuse(value: object) -> NoReturn:
    if isinstance(value, bytes):
        raise ValueError("bytes are not allowed")
    raise ValueError(f"{value} is a {type(value).__name__} in YAML: quote it to make it a string")


def loader() -> type[yaml.SafeLoader]:
    """Return the loader of YAML with angles, as in rosparam."""
    import yaml

    class Loader(yaml.SafeLoader):
        pass

    def construct_value(loader: Any, node: Any) -> OneValue:
        return OneValue(loader.construct_mapping(node, deep=True))

    for (tag, _), angle in zip(ANGLES, (degrees, radians), strict=True):

        def construct(loader: Any, node: Any, angle: Callable[[str], float] = angle) -> float:
            return angle(str(loader.construct_scalar(node)))

        Loader.add_constructor(tag, construct)
    Loader.add_constructor(VALUE, construct_value)
    _resolve_angles(Loader)
    return Loader


def _dumper(base: Any) -> Any:
    class Dumper(base):  # type: ignore[misc]
        pass

    def represent_value(dumper: Any, value: OneValue) -> Any:
        return dumper.represent_mapping(VALUE, value)

    Dumper.add_representer(OneValue, represent_value)
    _resolve_angles(Dumper)
    return Dumper


def _resolve_angles(reader_or_writer: Any) -> None:
    for tag, word in ANGLES:
        pattern = re.compile(rf"{word}\([^)]*\)$")
        reader_or_writer.add_implicit_resolver(tag, pattern, [word[0]])


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
