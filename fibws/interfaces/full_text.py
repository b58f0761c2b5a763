"""The text of a type with those of all types nested in it, as genmsg writes and programs send it.

The type's own text comes first, without a title. Each of the others has a line of 80 ``=`` and one
with its name before it.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable

from fibws.errors import DefinitionError
from fibws.interfaces import parser
from fibws.interfaces.definition import ActionDefinition, MessageDefinition, ServiceDefinition
from fibws.interfaces.md5sum import Lookup

SEPARATOR = "=" * 80
"""The line between the definitions."""

_TITLE = re.compile(r"MSG:\s*([A-Za-z]\w*)(?:/msg)?/([A-Za-z]\w*)", re.ASCII)


def write_message(definition: MessageDefinition, lookup: Lookup) -> str:
    """The full text of a message: the nested types are in it depth first, each once."""
    return _write(_unambiguous(definition, lookup), [definition], lookup)


def write_service(definition: ServiceDefinition, lookup: Lookup) -> str:
    """The full text of a service: the text of its .srv file, then the nested types."""
    messages = [definition.request, definition.response]
    return _write(_parts(messages), messages, lookup)


def write_action(definition: ActionDefinition, lookup: Lookup) -> str:
    """The full text of an action: the text of its .action file, then the nested types."""
    messages = [definition.goal, definition.result, definition.feedback]
    return _write(_parts(messages), messages, lookup)


def read_message(text: str, name: str) -> dict[str, MessageDefinition]:
    """The message ``name`` (package/Type) and those that follow in its full text, by type.

    Raises:
        DefinitionError: a line does not parse, or a part does not begin with its type.
    """
    own, nested = _read(text, name)
    return {name: parser.parse_message(own, *_split(name), _source(name)), **nested}


def read_service(text: str, name: str) -> tuple[ServiceDefinition, dict[str, MessageDefinition]]:
    """The service ``name`` and the messages that follow it; it raises as `read_message` does."""
    own, nested = _read(text, name)
    return parser.parse_service(own, *_split(name), _source(name)), nested


def read_action(text: str, name: str) -> tuple[ActionDefinition, dict[str, MessageDefinition]]:
    """The action ``name`` and the messages that follow it; it raises as `read_message` does."""
    own, nested = _read(text, name)
    return parser.parse_action(own, *_split(name), _source(name)), nested


def _write(own: str, messages: Iterable[MessageDefinition], lookup: Lookup) -> str:
    nested: dict[str, MessageDefinition] = {}
    for message in messages:
        _collect(message, lookup, nested)
    parts = [own, *(f"MSG: {name}\n{found.text}" for name, found in nested.items())]
    return f"\n{SEPARATOR}\n".join(parts)


def _unambiguous(definition: MessageDefinition, lookup: Lookup) -> str:
    """The message's own text, where types of one name in two packages have their package's name.

    The text does not name the package of such a type, and Foxglove searches all of them.
    """
    nested: dict[str, MessageDefinition] = {}
    _collect(definition, lookup, nested)
    times = Counter(found.name for found in nested.values())
    text = definition.text
    for field in definition.fields:
        short = field.type.partition("/")[2]
        if times[short] > 1:
            line = rf"^([ \t\r\v\f]*){short}(?=(\[\d*\])?[ \t\r\v\f]+{field.name}\b)"
            text = re.sub(line, rf"\g<1>{field.type}", text, count=1, flags=re.ASCII | re.MULTILINE)
    return text


def _collect(
    definition: MessageDefinition, lookup: Lookup, nested: dict[str, MessageDefinition]
) -> None:
    for field in definition.fields:
        if field.is_nested and field.type not in nested:
            nested[field.type] = lookup(field.type)
            _collect(nested[field.type], lookup, nested)


def _parts(messages: list[MessageDefinition]) -> str:
    *before, last = (message.text for message in messages)
    return "".join(f"{text}\n---\n" if text else "---\n" for text in before) + last


def _read(text: str, name: str) -> tuple[str, dict[str, MessageDefinition]]:
    """The text of the type itself, and the definitions that follow it."""
    lines = text.split("\n")
    (_, end), *others = parser.between(lines, lambda line: line.strip(parser.BLANKS) == SEPARATOR)
    nested: dict[str, MessageDefinition] = {}
    for begin, stop in others:
        title = lines[begin] if begin < stop else ""
        found = _TITLE.fullmatch(title.strip(parser.BLANKS))
        if found is None:
            fault = "expected MSG: package/Type"
            raise DefinitionError(_source(name), begin + 1, title[:200], fault)
        body = "\n".join(lines[begin + 1 : stop])
        draft = parser.parse_message(body, found[1], found[2], _source(name), begin + 2)
        nested[draft.type] = draft
    return "\n".join(lines[:end]), nested


def _split(name: str) -> tuple[str, str]:
    package, _, short = name.partition("/")
    return package, short


def _source(name: str) -> str:
    return f"the definition of {name}"
