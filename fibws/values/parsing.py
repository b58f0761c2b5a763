"""Messages that people type in YAML, as for rostopic pub and rosservice call."""

from __future__ import annotations

import time
from base64 import b64encode
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from fibws.errors import InvalidValue
from fibws.suggestions import suggestion_or_known
from fibws.values.typedefs import FLOATS, HEADER, STRINGS, TIMES, TypedefField, Typedefs

if TYPE_CHECKING:
    import yaml

MAX_VALUES = 5_000_000
"""Maximum number of values in a document: by aliases, a few lines can contain billions."""
MAX_LEVELS = 500
"""Maximum number of levels of nested values."""
MAX_BITS = 1024
"""Maximum size of an integer: no field holds more, a float64 included."""
MAX_SHOWN = 200
"""Maximum number of characters of invalid YAML in an error."""
_JSON = (str, int, float, list, dict)


def message(words: Sequence[str], typedefs: Typedefs) -> dict[str, Any]:
    """Return the message of a command line's arguments.

    Args:
        words: one YAML object, ``{data: 5}`` or ``data: 5``, or a value for each field in order.
        typedefs: the definition of the message's type.

    Returns:
        The given fields. A time may be given as ``now``, a header as ``auto``. Missing times are 0:
        the hub's default for a header's stamp is the current time.

    Raises:
        InvalidValue: the words are not YAML, or do not fit the type.
    """
    return fill([parse(word) for word in words], typedefs)


def parse(text: str, loader: type[yaml.SafeLoader] | None = None) -> Any:
    """Return the value of a YAML text; raise `InvalidValue` if it is invalid."""
    import yaml

    with _yaml_errors(text):
        value = yaml.load(text, loader or yaml.SafeLoader)
        check_size(value)
    return value


def documents(stream: Any, loader: type[yaml.SafeLoader] | None = None) -> Iterator[Any]:
    """Yield the values of YAML documents, separated by ``---``; raise as `parse`."""
    import yaml

    with _yaml_errors():
        for value in yaml.load_all(stream, loader or yaml.SafeLoader):
            check_size(value)
            yield value


def messages(documents: Iterable[Any], typedefs: Typedefs) -> Iterator[dict[str, Any]]:
    """Yield the message of each document that is not empty; raise as `message`."""
    for each in documents:
        if each is not None:
            yield fill(each if isinstance(each, list) else [each], typedefs)


@contextmanager
def _yaml_errors(text: str = "") -> Iterator[None]:
    """Raise what PyYAML raises for an invalid text as `InvalidValue`."""
    import yaml

    shown = text if len(text) <= MAX_SHOWN else f"{text[:MAX_SHOWN]}..."
    try:
        yield
    except InvalidValue:
        raise
    except RecursionError:
        raise InvalidValue(f"Invalid YAML: nested too deeply{text and f': {shown!r}'}") from None
    except (yaml.YAMLError, ValueError, AttributeError) as error:
        # For a date of 2020-13-45 PyYAML raises ValueError, for !!timestamp x AttributeError.
        raise InvalidValue(f"Invalid YAML: {_fault(error)}{text and f': {shown!r}'}") from None


def _fault(error: Exception) -> str:
    """Return the fault that PyYAML found, with its position, in one line."""
    problem = getattr(error, "problem", None) or str(error).partition("\n")[0]
    mark = getattr(error, "problem_mark", None)
    return (
        problem if mark is None else f"{problem} (line {mark.line + 1}, column {mark.column + 1})"
    )


def check_size(value: Any) -> None:
    """Check that a value from YAML, which may repeat or contain itself, can be traversed.

    Raises:
        InvalidValue: it has too many values or levels, or too large a number.
    """
    level, count = [value], 0
    for _ in range(MAX_LEVELS):
        above, level = level, []
        for each in above:
            if isinstance(each, list | dict):
                level += each.values() if isinstance(each, dict) else each
                if count + len(level) > MAX_VALUES:
                    raise InvalidValue(f"too many values (limit: {MAX_VALUES}, aliases included)")
            elif isinstance(each, int) and each.bit_length() > MAX_BITS:
                raise InvalidValue(f"number too large (limit: {MAX_BITS} bits)")
        if not level:
            return
        count += len(level)
    raise InvalidValue(f"nested too deeply (limit: {MAX_LEVELS} levels)")


def fill(values: Sequence[Any], typedefs: Typedefs) -> dict[str, Any]:
    """Return the message of the values of a command line's arguments; see `message`."""
    whole = values[0] if len(values) == 1 and isinstance(values[0], dict) else list(values)
    _check_colon(values, typedefs)
    return _Filler(typedefs).message(whole, typedefs.root, "")


def _check_colon(values: Sequence[Any], typedefs: Typedefs) -> None:
    """Refuse data:5, a string in YAML, unless the message consists of one string."""
    if len(values) != 1 or not isinstance(values[0], str) or typedefs.root not in typedefs:
        return
    name, _, value = values[0].partition(":")
    fields = typedefs.fields(typedefs.root)
    is_string = len(fields) == 1 and fields[0].type in STRINGS
    if value and not is_string and any(field.name == name for field in fields):
        raise InvalidValue(f"YAML requires a space after the colon: '{name}: {value}'")


class _Filler:
    """Converts the values of one message, with one current time."""

    def __init__(self, typedefs: Typedefs) -> None:
        self._typedefs = typedefs
        self._now = time.time_ns()

    def message(self, values: Any, type_: str, path: str) -> dict[str, Any]:
        if isinstance(values, list):
            values = self._by_name(values, type_, path)
        elif not isinstance(values, dict):
            raise _invalid(path, self._fields(type_), values)
        if type_ not in self._typedefs:
            return {str(name): _plain(value, f"{path}{name}") for name, value in values.items()}
        fields = {field.name: field for field in self._typedefs.fields(type_)}
        for name in values:
            if name not in fields:
                known = suggestion_or_known(str(name), fields)
                raise InvalidValue(f"No field name [{path}{name}] in {type_}{known}")
        given = {
            name: self._value("" if value is None else value, fields[name], f"{path}{name}")
            for name, value in values.items()
        }
        return given | self._zero_times({k: v for k, v in fields.items() if k not in given})

    def _by_name(self, values: list[Any], type_: str, path: str) -> dict[str, Any]:
        """Return a list of values in the order of a type's fields as an object."""
        if type_ not in self._typedefs:
            raise InvalidValue(f"the fields of {type_} are unknown: expected {{name: value}}")
        names = [field.name for field in self._typedefs.fields(type_)]
        if len(values) != len(names):
            amount = "Too many" if len(values) > len(names) else "Not enough"
            where = f" for [{path.rstrip('.')}]" if path else ""
            expected = f"expected {self._fields(type_)}"
            raise InvalidValue(f"{amount} arguments{where}: {expected}, got {_shown(values)}")
        return dict(zip(names, values, strict=True))

    def _value(self, value: Any, field: TypedefField, path: str) -> Any:
        if field.length is not None:
            return self._array(value, field, path)
        if field.type in TIMES:
            return self._time(value, field.type, path)
        if field.type in self._typedefs:
            if value == "auto" and field.type == HEADER:
                return {"stamp": _secs_and_nsecs(self._now)}
            return self.message(value, field.type, f"{path}.")
        if isinstance(value, list | dict) and field.type:
            raise _invalid(path, field.type, value)
        if isinstance(value, str) and field.type in FLOATS:
            return _float(value)
        if field.type in STRINGS and not isinstance(value, str):
            raise _invalid(path, f"{field.type} (in quotes, such as '\"5\"')", value)
        return _plain(value, path)

    def _array(self, value: Any, field: TypedefField, path: str) -> Any:
        if isinstance(value, bytes):
            return b64encode(value).decode()
        if not isinstance(value, list):
            raise _invalid(path, f"list of {field.type}", value)
        if field.length and len(value) != field.length:
            raise _invalid(path, f"{field.length} elements", len(value))
        element = TypedefField("", field.type)
        return [self._value(each, element, f"{path}[{i}]") for i, each in enumerate(value)]

    def _time(self, value: Any, type_: str, path: str) -> dict[str, Any]:
        if type_ == "time" and value == "now":
            return _secs_and_nsecs(self._now)
        if isinstance(value, int) and not isinstance(value, bool):
            return _secs_and_nsecs(value)  # nanoseconds, as in ROS
        if isinstance(value, list) and len(value) == 2:
            value = dict(zip(("secs", "nsecs"), value, strict=True))
        if isinstance(value, dict) and value.keys() <= {"secs", "nsecs"}:
            return {"secs": 0, "nsecs": 0, **value}
        now = "now, " if type_ == "time" else ""
        raise _invalid(path, f"{now}{{secs: 1, nsecs: 0}} or an integer of nanoseconds", value)

    def _zero_times(self, fields: Mapping[str, TypedefField]) -> dict[str, Any]:
        """Return the fields that are times or contain times, with these as 0."""
        times: dict[str, Any] = {}
        for name, field in fields.items():
            if field.length is not None:
                continue
            if field.type in TIMES:
                times[name] = _secs_and_nsecs(0)
            elif field.type in self._typedefs:
                nested = {each.name: each for each in self._typedefs.fields(field.type)}
                if nested_times := self._zero_times(nested):
                    times[name] = nested_times
        return times

    def _fields(self, type_: str) -> str:
        names = [field.name for field in self._typedefs.fields(type_)]
        return f"{', '.join(names) or 'no values'} ({type_})"


def _secs_and_nsecs(nanoseconds: int) -> dict[str, int]:
    secs, nsecs = divmod(nanoseconds, 10**9)
    return {"secs": secs, "nsecs": nsecs}


def _plain(value: Any, path: str) -> Any:
    """Return a value of YAML as one of JSON."""
    if isinstance(value, list):
        return [_plain(each, f"{path}[{i}]") for i, each in enumerate(value)]
    if isinstance(value, dict):
        return {str(name): _plain(each, f"{path}.{name}") for name, each in value.items()}
    if value is None or isinstance(value, _JSON):
        return None if value != value else value
    raise _invalid(path, "a value that JSON has (strings in quotes)", value)


def _float(word: str) -> Any:
    """Return the number of 1e3, a string in YAML 1.1; the hub refuses other strings."""
    try:
        return float(word)
    except ValueError:
        return word


def _invalid(path: str, expected: str, value: Any) -> InvalidValue:
    where = f"Field [{path.rstrip('.')}]" if path else "message"
    got = _shown(value) if value is None or isinstance(value, _JSON) else _yaml_type(value)
    return InvalidValue(f"{where}: expected {expected}, got {got}")


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."


def _yaml_type(value: Any) -> str:
    return f"the {type(value).__name__} {value}"
