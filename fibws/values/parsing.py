"""Messages as people type them: YAML, in the ways of rostopic pub and rosservice call."""

from __future__ import annotations

import time
from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fibws.errors import InvalidValue
from fibws.suggestions import nearest
from fibws.values.typedefs import FLOATS, HEADER, STRINGS, TIMES, Field, Typedefs

MOST_VALUES = 5_000_000
"""Values in a document, repeated ones as often as they are: a few lines can stand for billions."""
MOST_LEVELS = 500
MOST_BITS = 1024
"""Of a whole number: no field holds more, a float64 included."""
LONGEST_WORD = 200
"""Characters of what is told of a word that is no YAML."""
FAULTS = (ValueError, RecursionError, AttributeError)
"""What PyYAML raises besides its own: for a date of 2020-13-45, for [[[[..., for !!timestamp x."""
_JSON = (str, int, float, list, dict)


def message(words: Sequence[str], typedefs: Typedefs) -> dict[str, Any]:
    """The message that the words of a command line stand for.

    Args:
        words: one object in YAML, ``{data: 5}`` or ``data: 5``, or a value for each field in order.
        typedefs: those of the message's type.

    Returns:
        What the words say. A time may be the word ``now`` and a header ``auto``, and whatever holds
        a time of which nothing is said has 0 for it: a hub's default for stamps would be now.

    Raises:
        UsageError: the words are no YAML, or what they say is no such message.
    """
    return fill([parse(word) for word in words], typedefs)


def parse(word: str) -> Any:
    """The value that a text in YAML stands for; it raises `ClickException` if that is none."""
    import yaml

    try:
        value = yaml.safe_load(word)
        check_size(value)
    except (yaml.YAMLError, *FAULTS) as error:
        shown = word if len(word) <= LONGEST_WORD else f"{word[:LONGEST_WORD]}..."
        raise InvalidValue(f"This is no YAML: {fault(error)}: {shown!r}") from None
    return value


def documents(stream: Any) -> Iterator[Any]:
    """The values in a file of YAML, which ``---`` stands between; raises as `parse`."""
    import yaml

    try:
        for value in yaml.safe_load_all(stream):
            check_size(value)
            yield value
    except (yaml.YAMLError, *FAULTS) as error:
        raise InvalidValue(f"This is no YAML: {fault(error)}") from None


def check_size(value: Any) -> None:
    """See to it that a value from YAML, in which aliases may repeat others, can be walked through.

    Raises:
        ClickException: it has more values, or a larger number, than any message or parameter.
        RecursionError: they are too deep in each other; one may hold itself.
    """
    level, seen = [value], 0
    for _ in range(MOST_LEVELS):
        above, level = level, []
        for each in above:
            if isinstance(each, list | dict):
                level += each.values() if isinstance(each, dict) else each
                if seen + len(level) > MOST_VALUES:
                    raise InvalidValue(f"This YAML has more than {MOST_VALUES} values")
            elif isinstance(each, int) and each.bit_length() > MOST_BITS:
                raise InvalidValue("This YAML has a number that no field has room for")
        if not level:
            return
        seen += len(level)
    raise RecursionError("it has too many values in each other")


def fault(error: Exception) -> str:
    """What PyYAML says is wrong, and where, in one line."""
    problem = getattr(error, "problem", None) or str(error).partition("\n")[0]
    mark = getattr(error, "problem_mark", None)
    return (
        problem if mark is None else f"{problem} (line {mark.line + 1}, column {mark.column + 1})"
    )


def fill(values: Sequence[Any], typedefs: Typedefs) -> dict[str, Any]:
    """The message of the values that the words of a command line had; as `message`."""
    whole = values[0] if len(values) == 1 and isinstance(values[0], dict) else list(values)
    _check_blank(values, typedefs)
    return _Reading(typedefs).message(whole, typedefs.root, "")


def _check_blank(values: Sequence[Any], typedefs: Typedefs) -> None:
    """Catch data:5, which is one word in YAML, unless the message may be just that word."""
    if len(values) != 1 or not isinstance(values[0], str) or typedefs.root not in typedefs:
        return
    name, _, value = values[0].partition(":")
    fields = typedefs.fields(typedefs.root)
    may_be_word = len(fields) == 1 and fields[0].type in STRINGS
    if value and not may_be_word and any(field.name == name for field in fields):
        raise InvalidValue(f"YAML wants a blank after the colon: '{name}: {value}'")


class _Reading:
    """One message being read, at one time."""

    def __init__(self, typedefs: Typedefs) -> None:
        self._typedefs = typedefs
        self._now = time.time_ns()

    def message(self, values: Any, type_: str, path: str) -> dict[str, Any]:
        if isinstance(values, list):
            values = self._named(values, type_, path)
        elif not isinstance(values, dict):
            raise _wrong(path, f"must be {self._shape(type_)} instead of {_written(values)}")
        if type_ not in self._typedefs:
            return {str(name): _plain(value, f"{path}{name}") for name, value in values.items()}
        fields = {field.name: field for field in self._typedefs.fields(type_)}
        for name in values:
            if name not in fields:
                raise InvalidValue(self._no_such_field(path, str(name), fields))
        read = {
            name: self._value("" if value is None else value, fields[name], f"{path}{name}")
            for name, value in values.items()
        }
        return read | self._times({k: v for k, v in fields.items() if k not in read})

    def _named(self, values: list[Any], type_: str, path: str) -> dict[str, Any]:
        if type_ not in self._typedefs:
            raise InvalidValue(
                f"The fields of {type_} are not known here: write the message as {{name: value}}"
            )
        names = [field.name for field in self._typedefs.fields(type_)]
        if len(values) != len(names):
            amount = "Too many" if len(values) > len(names) else "Not enough"
            where = f" for [{path.rstrip('.')}]" if path else ""
            expected = f"expected {self._shape(type_)}"
            raise InvalidValue(f"{amount} arguments{where}: given {_written(values)}, {expected}")
        return dict(zip(names, values, strict=True))

    def _value(self, value: Any, field: Field, path: str) -> Any:
        if field.length is not None:
            return self._array(value, field, path)
        if field.type in TIMES:
            return self._time(value, field.type, path)
        if field.type in self._typedefs:
            if value == "auto" and field.type == HEADER:
                return {"stamp": self._parts(self._now)}
            return self.message(value, field.type, f"{path}.")
        if isinstance(value, list | dict) and field.type:
            raise _wrong(path, f"must be {_a(field.type)} instead of {_written(value)}")
        if isinstance(value, str) and field.type in FLOATS:
            return _float(value)
        if field.type in STRINGS and not isinstance(value, str):
            quotes = "put it between quotation marks, as in '\"5\"'"
            raise _wrong(path, f"must be a text instead of {_written(value)}: {quotes}")
        return _plain(value, path)

    def _array(self, value: Any, field: Field, path: str) -> Any:
        if isinstance(value, bytes):
            return b64encode(value).decode()
        if not isinstance(value, list):
            raise _wrong(path, f"must be a list of {field.type} instead of {_written(value)}")
        if field.length and len(value) != field.length:
            raise _wrong(
                path, f"has incorrect number of elements: {len(value)} instead of {field.length}"
            )
        element = Field("", field.type)
        return [self._value(each, element, f"{path}[{i}]") for i, each in enumerate(value)]

    def _time(self, value: Any, type_: str, path: str) -> dict[str, Any]:
        if type_ == "time" and value == "now":
            return self._parts(self._now)
        if isinstance(value, int) and not isinstance(value, bool):
            return self._parts(value)  # nanoseconds, as in ROS
        if isinstance(value, list) and len(value) == 2:
            value = dict(zip(("secs", "nsecs"), value, strict=True))
        if isinstance(value, dict) and value.keys() <= {"secs", "nsecs"}:
            return {"secs": 0, "nsecs": 0, **value}
        now = "now, " if type_ == "time" else ""
        raise _wrong(
            path,
            f"must be {now}{{secs: 1, nsecs: 0}} or whole nanoseconds instead of {_written(value)}",
        )

    def _parts(self, nanoseconds: int) -> dict[str, int]:
        secs, nsecs = divmod(nanoseconds, 10**9)
        return {"secs": secs, "nsecs": nsecs}

    def _times(self, fields: Mapping[str, Field]) -> dict[str, Any]:
        """What of these fields has a time in it, with 0 for that."""
        found: dict[str, Any] = {}
        for name, field in fields.items():
            if field.length is not None:
                continue
            if field.type in TIMES:
                found[name] = self._parts(0)
            elif field.type in self._typedefs:
                inner = {each.name: each for each in self._typedefs.fields(field.type)}
                if times := self._times(inner):
                    found[name] = times
        return found

    def _shape(self, type_: str) -> str:
        names = [field.name for field in self._typedefs.fields(type_)]
        return f"{', '.join(names) or 'nothing'} ({type_})"

    def _no_such_field(self, path: str, name: str, fields: Mapping[str, Field]) -> str:
        near = nearest(name, fields)
        hint = f"did you mean {near}?" if near else f"there are {', '.join(fields) or 'none'}"
        return f"No field name [{path}{name}]: {hint}"


def _plain(value: Any, path: str) -> Any:
    """A value that JSON has, too."""
    if isinstance(value, list):
        return [_plain(each, f"{path}[{i}]") for i, each in enumerate(value)]
    if isinstance(value, dict):
        return {str(name): _plain(each, f"{path}.{name}") for name, each in value.items()}
    if value is None or isinstance(value, _JSON):
        return None if value != value else value
    kind = type(value).__name__
    raise _wrong(path, f"is a {kind} to YAML ({value}): put it between quotation marks")


def _float(word: str) -> Any:
    # YAML 1.1 takes 1e3 for a text, having no point in it.
    try:
        return float(word)
    except ValueError:
        return word  # The hub says what is wrong with it.


def _written(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."


def _a(type_: str) -> str:
    return f"{'an' if type_[0] in 'aeio' else 'a'} {type_}"


def _wrong(path: str, fault: str) -> InvalidValue:
    where = path.rstrip(".")
    return InvalidValue(f"Field [{where}] {fault}" if where else f"The message {fault}")
