"""Reads messages, services and actions from OMG IDL: what rosidl makes of ``.msg`` files, and more.

Structs, typedefs, enums and constants are read. An enum is a uint32 on the wire; its names become
constants of the messages that use it. Other constructs of IDL are errors that name them.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Final, NamedTuple, TypeAlias

from fibws.errors import DefinitionError
from fibws.interfaces import builtin, literals
from fibws.interfaces.definition import (
    ActionDefinition,
    Array,
    Constant,
    Field,
    MessageDefinition,
    Scalar,
    ServiceDefinition,
)
from fibws.interfaces.full_text import SEPARATOR
from fibws.interfaces.literals import LiteralError

Include: TypeAlias = Callable[[str], "str | None"]
"""Returns the text of an included file, ``package/msg/Name.idl``; None if it is not there."""

KINDS: Final = ("msg", "srv", "action")
CONSTANTS_SUFFIX: Final = "_Constants"
"""The module beside a struct that has its constants."""
EMPTY_MEMBER: Final = "structure_needs_at_least_one_member"
"""The member that rosidl gives a struct without any, as IDL wants one."""
DEEPEST_INCLUDE: Final = 50
DEEPEST_MODULE: Final = 20
MOST_CONSTANTS: Final = 10_000
"""Constants of all messages of a file: each has those of all enums that it uses."""
_BASIC: Final = {
    "boolean": "bool",
    "octet": "byte",
    "char": "char",
    "float": "float32",
    "double": "float64",
    "short": "int16",
    "long": "int32",
    "long long": "int64",
    "unsigned short": "uint16",
    "unsigned long": "uint32",
    "unsigned long long": "uint64",
    **{name: name for name in builtin.INTEGERS if name not in ("byte", "char")},
}
_UNSUPPORTED: Final = frozenset(
    {
        *("abstract", "any", "bitfield", "bitmask", "bitset", "component", "custom", "eventtype"),
        *("exception", "fixed", "interface", "local", "map", "native", "porttype", "union"),
        *("valuetype", "wchar"),
    }
)
_UNREAD: Final = frozenset({"optional", "external"})
"""Annotations that change the bytes of a member."""
_TOKEN: Final = re.compile(
    r"""(?P<skip>\s+|//[^\n]*|/\*.*?\*/|^={10,}\s*$|^IDL:[^\n]*)
    |(?P<directive>^[ \t]*\#[^\n]*)
    |(?P<string>L?"(?:[^"\\\n]|\\.)*")|(?P<char>L?'(?:[^'\\\n]|\\.)')
    |(?P<number>(?:0[xX][0-9a-fA-F]+|\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?)[dDfF]?)
    |(?P<name>(?:::)?[A-Za-z_]\w*(?:::[A-Za-z_]\w*)*)
    |(?P<symbol>[{}()\[\]<>;:,=@|^&+\-*/%~])""",
    re.VERBOSE | re.MULTILINE | re.DOTALL | re.ASCII,
)
_INCLUDE: Final = re.compile(r'\s*#\s*include\s*[<"]([^">]+)[">]\s*')
_GUARD: Final = re.compile(r"\s*#\s*(ifndef\s+\w+|define\s+\w+|endif\b.*|pragma\b.*)\s*")
"""Include guards; each file is read once without them."""
_ESCAPES: Final = {"n": "\n", "t": "\t", "r": "\r", "0": "\0"}


class _Token(NamedTuple):
    kind: str
    text: str
    place: int


class _Type(NamedTuple):
    """The type of a member: that of one element, and how many there are."""

    name: str
    limit: int | None = None
    array: Array | None = None
    enum: _Enum | None = None


class _Enum(NamedTuple):
    names: dict[str, int]


class _Struct(NamedTuple):
    scope: tuple[str, ...]
    members: dict[str, Field]
    enums: list[_Enum]


class _IdlFault(ValueError):
    """An error at a token."""

    def __init__(self, place: int, text: str) -> None:
        self.place = place
        super().__init__(text)


class IdlFile:
    """The types that one file defines.

    Args:
        text: its content; in ``ros2idl`` schemas several files follow each other.
        source: its name, for errors.
        include: finds included files, whose typedefs, enums and constants may be used.

    Raises:
        DefinitionError: the text is invalid, or has what cannot be read.
    """

    def __init__(self, text: str, source: str, include: Include = lambda path: None) -> None:
        self._source = source
        reader = _IdlReader(include)
        try:
            reader.read(text)
        except _IdlFault as fault:
            number = text.count("\n", 0, fault.place) + 1
            line = text.split("\n")[number - 1][:200]
            raise DefinitionError(source, number, line, str(fault)) from None
        self._reader = reader
        self._structs = {each.scope: each for each in reader.structs}

    def messages(self) -> dict[str, MessageDefinition]:
        """Return the messages, in modules ``package::msg`` or ``package``, by their names.

        Raises:
            DefinitionError: there are too many constants.
        """
        found = {}
        room = MOST_CONSTANTS
        for scope in self._structs:
            if len(scope) == 2 or (len(scope) == 3 and scope[1] == "msg"):
                message = self._message(scope, scope[-1])
                found[message.type] = message
                room -= len(message.constants)
                if room < 0:
                    fault = f"too many constants (limit {MOST_CONSTANTS})"
                    raise DefinitionError(self._source, 1, "", fault)
        return found

    def service(self, package: str, name: str) -> ServiceDefinition | None:
        """Return a service of ``package::srv``, if it is there."""
        scopes = [(package, "srv", f"{name}_{part}") for part in ("Request", "Response")]
        if not self._structs.keys() >= {*scopes}:
            return None
        return ServiceDefinition(
            package,
            name,
            self._message(scopes[0], f"{name}Request"),
            self._message(scopes[1], f"{name}Response"),
        )

    def action(self, package: str, name: str) -> ActionDefinition | None:
        """Return an action of ``package::action``, if it is there."""
        parts = ("Goal", "Result", "Feedback")
        scopes = [(package, "action", f"{name}_{part}") for part in parts]
        if not self._structs.keys() >= {*scopes}:
            return None
        goal, result, feedback = (
            self._message(scope, f"{name}{part}") for scope, part in zip(scopes, parts, strict=True)
        )
        return ActionDefinition(package, name, goal, result, feedback)

    def _message(self, scope: tuple[str, ...], name: str) -> MessageDefinition:
        struct = self._structs[scope]
        members = struct.members
        if [*members] == [EMPTY_MEMBER]:
            members = {}
        constants = self._reader.constants_of(scope)
        for enum in struct.enums:
            for label, value in enum.names.items():
                if label not in members and label not in constants:
                    constants[label] = Constant(label, "uint32", value, str(value))
        lines = [f"{each.type} {each.name}={each.text}" for each in constants.values()]
        lines += [f"{each.ros1_type} {each.name}" for each in members.values()]
        return MessageDefinition(
            scope[0],
            name,
            tuple(members.values()),
            tuple(constants.values()),
            "\n".join(lines),
            self._source,
        )


def full_text(name: str, text: str) -> str:
    """Return the text of a ``ros2idl`` schema as that of ``.msg`` files; see `full_text`.

    Args:
        name: the type, ``package/Type``.
        text: its IDL, and that of all types in it.

    Raises:
        DefinitionError: the text is invalid, has what cannot be read, or lacks the type.
    """
    source = f"the schema of {name}"
    messages = IdlFile(text, source).messages()
    own = messages.pop(name, None)
    if own is None:
        raise DefinitionError(source, 1, text.partition("\n")[0][:200], f"no struct {name}")
    parts = [own.text, *(f"MSG: {each}\n{found.text}" for each, found in messages.items())]
    return f"\n{SEPARATOR}\n".join(parts)


class _IdlReader:
    """Reads declarations; each has the scope of its module."""

    def __init__(self, include: Include) -> None:
        self.structs: list[_Struct] = []
        self._include = include
        self._included: set[str] = set()
        self._depth = 0
        self._known: dict[tuple[str, ...], _Type | Constant] = {}
        """Typedefs, enums and structs as types; constants and names of enums."""
        self._constants: dict[tuple[str, ...], dict[str, Constant]] = {}
        """The constants of each module."""
        self._scope: tuple[str, ...] = ()
        self._tokens: list[_Token] = []
        self._next = 0

    def read(self, text: str) -> None:
        """Read a file; raise `_IdlFault`."""
        self._tokens, self._next = self._split(text), 0
        while self._peek().text:
            self._declaration()

    def constants_of(self, scope: tuple[str, ...]) -> dict[str, Constant]:
        """Return the constants in the module beside a struct."""
        beside = (*scope[:-1], scope[-1] + CONSTANTS_SUFFIX)
        return dict(self._constants.get(beside, {}))

    def _split(self, text: str) -> list[_Token]:
        tokens, place = [], 0
        while place < len(text):
            found = _TOKEN.match(text, place)
            if found is None:
                raise _IdlFault(place, f"unexpected {text[place : place + 1]!r}")
            kind = str(found.lastgroup)
            if kind == "directive":
                self._directive(found[0], place)
            elif kind != "skip":
                tokens.append(_Token(kind, found[0], place))
            place = found.end()
        return [*tokens, _Token("end", "", len(text))]

    def _directive(self, line: str, place: int) -> None:
        if _GUARD.fullmatch(line):
            return
        found = _INCLUDE.fullmatch(line)
        if found is None:
            raise _IdlFault(place, f"{line.strip()[:40]} is not supported")
        path = found[1]
        if path in self._included or self._depth >= DEEPEST_INCLUDE:
            return
        self._included.add(path)
        text = self._include(path)
        if text is None:
            return
        kept = (self.structs, self._scope, self._tokens, self._next)
        self.structs, self._scope = [], ()
        self._depth += 1
        try:
            self.read(text)
        except _IdlFault as fault:
            raise _IdlFault(place, f"{path}: {fault}") from None
        finally:
            self._depth -= 1
            self.structs, self._scope, self._tokens, self._next = kept

    # Tokens.

    def _peek(self) -> _Token:
        return self._tokens[self._next]

    def _take(self, text: str | None = None, kind: str | None = None) -> _Token:
        token = self._peek()
        if (text is not None and token.text != text) or (kind is not None and token.kind != kind):
            found = repr(token.text[:40]) if token.text else "the end"
            raise _IdlFault(token.place, f"expected {text or f'a {kind}'}, got {found}")
        self._next += 1
        return token

    def _accept(self, text: str) -> bool:
        if self._peek().text == text:
            self._next += 1
            return True
        return False

    def _name(self) -> str:
        token = self._take(kind="name")
        if "::" in token.text:
            raise _IdlFault(token.place, f"expected a name, got {token.text[:40]}")
        # An underscore in front lets a name be a keyword.
        return token.text.removeprefix("_")

    # Declarations.

    def _declaration(self) -> None:
        self._annotations()
        token = self._take()
        match token.text:
            case "module":
                self._module()
            case "struct":
                self._struct()
            case "typedef":
                self._typedef()
            case "enum":
                self._enum()
            case "const":
                self._constant()
            case ";":
                return
            case _:
                raise _unsupported(token, "struct, enum, typedef, const or module")
        self._accept(";")

    def _module(self) -> None:
        outer, place = self._scope, self._peek().place
        if len(outer) >= DEEPEST_MODULE:
            raise _IdlFault(place, f"modules are nested too deeply (limit {DEEPEST_MODULE})")
        self._scope = (*outer, self._name())
        self._take("{")
        while not self._accept("}"):
            self._declaration()
        self._scope = outer

    def _struct(self) -> None:
        place = self._peek().place
        scope = (*self._scope, self._name())
        if self._peek().text == ";":
            return  # A declaration in advance.
        if self._peek().text == ":":
            raise _IdlFault(place, f"{scope[-1]}: a struct that inherits is not supported")
        self._known[scope] = _Type(_message_name(scope, place))
        struct = _Struct(scope, {}, [])
        self._take("{")
        while not self._accept("}"):
            self._member(struct)
        self.structs.append(struct)

    def _member(self, struct: _Struct) -> None:
        default = self._annotations().get("default")
        type_ = self._type()
        while True:
            place = self._peek().place
            name = self._name()
            whole = self._dimensions(type_)
            if name in struct.members:
                raise _IdlFault(place, f"duplicate name {name}")
            field = Field(name, whole.name, whole.array, whole.limit)
            if default is not None:
                value = self._default(field, default, place)
                field = Field(name, whole.name, whole.array, whole.limit, value)
            struct.members[name] = field
            if whole.enum is not None and whole.enum not in struct.enums:
                struct.enums.append(whole.enum)
            if not self._accept(","):
                break
        self._take(";")

    def _typedef(self) -> None:
        type_ = self._type()
        while True:
            name = self._name()
            self._known[*self._scope, name] = self._dimensions(type_)
            if not self._accept(","):
                return

    def _enum(self) -> None:
        scope = (*self._scope, self._name())
        names: dict[str, int] = {}
        self._take("{")
        while not self._accept("}"):
            given = self._annotations().get("value")
            place, label = self._peek().place, self._name()
            if label in names:
                raise _IdlFault(place, f"duplicate name {label}")
            last = next(reversed(names.values()), -1)
            value = self._evaluated(given, place) if given else last + 1
            names[label] = int(_checked("uint32", value, place))
            constant = Constant(label, "uint32", names[label], str(names[label]))
            self._known[*self._scope, label] = constant
            if not self._accept(","):
                self._take("}")
                break
        self._known[scope] = _Type("uint32", enum=_Enum(names))

    def _constant(self) -> None:
        place = self._peek().place
        type_ = self._type()
        if type_.array is not None or type_.name not in builtin.CONSTANTS:
            raise _IdlFault(place, "a constant must be of a basic type, a string or an enum")
        name = self._name()
        self._take("=")
        value = _checked(type_.name, self._value(), place)
        kind = "string" if type_.name in builtin.STRINGS else type_.name
        text = str(value)
        if isinstance(value, str) and ("\n" in value or "\r" in value):
            raise _IdlFault(place, f"{name}: a constant with several lines is not supported")
        constant = self._known[*self._scope, name] = Constant(name, kind, value, text)
        self._constants.setdefault(self._scope, {})[name] = constant

    # Types.

    def _type(self) -> _Type:
        token = self._take(kind="name")
        if token.text in ("string", "wstring"):
            return _Type(token.text, limit=self._bound())
        if token.text == "sequence":
            return self._sequence(token)
        words = token.text
        while words in ("unsigned", "long", "unsigned long") and self._peek().text in (
            *("short", "long", "double"),
        ):
            words = f"{words} {self._take().text}"
        if words in _BASIC:
            return _Type(_BASIC[words])
        if words in _UNSUPPORTED or " " in words or words == "unsigned":
            raise _IdlFault(token.place, f"{words} is not supported")
        return self._named(token)

    def _sequence(self, token: _Token) -> _Type:
        self._take("<")
        nested = self._peek().text == "sequence"
        element = _Type("") if nested else self._type()
        if nested or element.array is not None:
            raise _IdlFault(token.place, "a sequence of sequences or arrays is not supported")
        bound = None
        if self._accept(","):
            bound = self._size()
        self._take(">")
        return element._replace(array=Array(bound, bound is not None))

    def _bound(self) -> int | None:
        if not self._accept("<"):
            return None
        bound = self._size()
        self._take(">")
        return bound

    def _dimensions(self, type_: _Type) -> _Type:
        """Return the type with the array that a name has behind it."""
        token = self._peek()
        if not self._accept("["):
            return type_
        size = self._size()
        self._take("]")
        if type_.array is not None or self._peek().text == "[":
            raise _IdlFault(token.place, "an array of arrays or sequences is not supported")
        return type_._replace(array=Array(size))

    def _size(self) -> int:
        place, value = self._peek().place, self._value()
        if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 10**9:
            raise _IdlFault(place, "a size must be an integer from 0 on")
        return value

    def _named(self, token: _Token) -> _Type:
        """Return a type by its name, in this module or in those around it."""
        found = self._find(token)
        if isinstance(found, _Type):
            return found
        scope = tuple(filter(None, token.text.split("::")))
        if found is not None or len(scope) == 1:
            raise _IdlFault(token.place, f"{token.text[:40]} is not a type")
        # It is of a file that was not found; a message of this name may be.
        return _Type(_message_name(scope, token.place))

    def _find(self, token: _Token) -> _Type | Constant | None:
        scope = tuple(filter(None, token.text.split("::")))
        outer = () if token.text.startswith("::") else self._scope
        for depth in range(len(outer), -1, -1):
            found = self._known.get((*outer[:depth], *scope))
            if found is not None:
                return found
        return None

    # Values.

    def _annotations(self) -> dict[str, list[_Token]]:
        """Return the annotations here, each with the tokens of its value."""
        found: dict[str, list[_Token]] = {}
        while self._accept("@"):
            token = self._take(kind="name")
            if token.text in _UNREAD:
                raise _IdlFault(token.place, f"@{token.text} is not supported")
            tokens = self._parameters() if self._peek().text == "(" else []
            is_named = [each.text for each in tokens[:2]] == ["value", "="]
            found[token.text] = tokens[2:] if is_named else tokens
        return found

    def _parameters(self) -> list[_Token]:
        self._take("(")
        depth = 1
        found: list[_Token] = []
        while True:
            token = self._take()
            if token.kind == "end":
                raise _IdlFault(token.place, "expected ), got the end")
            depth += {"(": 1, ")": -1}.get(token.text, 0)
            if not depth:
                return found
            found.append(token)

    def _default(
        self, field: Field, tokens: list[_Token], place: int
    ) -> Scalar | tuple[Scalar, ...]:
        if field.type not in builtin.CONSTANTS:
            raise _IdlFault(place, f"{field.name}: {field.type} cannot have a default")
        value = self._evaluated(tokens, place)
        if field.array is None:
            return _checked(field.type, value, place)
        # rosidl writes the default of an array as a string: "(1, 2)".
        if not isinstance(value, str) or not (value.startswith("(") and value.endswith(")")):
            raise _IdlFault(place, f'{field.name}: the default of an array is like "(1, 2)"')
        try:
            texts = literals.elements(field.type, f"[{value[1:-1].removesuffix(',')}]")
            return tuple(literals.scalar(field.type, text) for text in texts)
        except LiteralError as fault:
            raise _IdlFault(place, f"{field.name}: {fault}") from None

    def _evaluated(self, tokens: list[_Token], place: int) -> Scalar:
        """Return the value that an annotation has."""
        kept = self._tokens, self._next
        self._tokens, self._next = [*tokens, _Token("end", "", place)], 0
        try:
            value = self._value()
            self._take(kind="end")
        finally:
            self._tokens, self._next = kept
        return value

    def _value(self) -> Scalar:
        """Return a literal, a constant by its name, or a number with signs in front."""
        token = self._take()
        match token.kind:
            case "string":
                parts = [token.text]
                while self._peek().kind == "string":
                    parts.append(self._take().text)
                return "".join(map(_unescaped, parts))
            case "char":
                return ord(_unescaped(token.text))
            case "number":
                return self._no_operator(_number(token))
            case "name":
                return self._no_operator(self._constant_value(token))
        if token.text in ("-", "+") and self._peek().kind in ("number", "name"):
            value = self._value()
            if not isinstance(value, str):
                return -value if token.text == "-" else +value
        raise _IdlFault(token.place, f"expected a value, got {token.text[:40] or 'the end'}")

    def _no_operator(self, value: Scalar) -> Scalar:
        token = self._peek()
        if token.text and token.text in "|^&<+-*/%":
            raise _IdlFault(token.place, f"expressions ({token.text}) are not supported")
        return value

    def _constant_value(self, token: _Token) -> Scalar:
        if token.text in ("TRUE", "FALSE", "True", "False", "true", "false"):
            return token.text.lower() == "true"
        found = self._find(token)
        if not isinstance(found, Constant):
            raise _IdlFault(token.place, f"{token.text[:40]} is not a constant")
        return found.value


def _unsupported(token: _Token, expected: str) -> _IdlFault:
    if token.text in _UNSUPPORTED:
        return _IdlFault(token.place, f"{token.text} is not supported")
    return _IdlFault(token.place, f"expected {expected}, got {token.text[:40] or 'the end'}")


def _message_name(scope: tuple[str, ...], place: int) -> str:
    """Return the name of a message: ``package/Name`` for ``package::msg::Name``."""
    name = scope[-1]
    if not (len(scope) == 2 or (len(scope) == 3 and scope[1] in KINDS)):
        text = f"{'::'.join(scope)}: a struct must be in a module package::msg, or in package"
        raise _IdlFault(place, text)
    full = f"{scope[0]}/{name}"
    return builtin.ALIASES.get(full, full)


def _number(token: _Token) -> int | float:
    text = token.text
    if text[:2] in ("0x", "0X"):
        return int(text, 16)
    try:
        if text.isdigit():
            return int(text, 8) if len(text) > 1 and text.startswith("0") else int(text)
        return float(text.rstrip("dDfF"))
    except ValueError:
        raise _IdlFault(token.place, f"{text[:40]} is not a number") from None


def _unescaped(text: str) -> str:
    inner = text.removeprefix("L")[1:-1]
    return re.sub(r"\\(.)", lambda found: _ESCAPES.get(found[1], found[1]), inner)


def _checked(kind: str, value: Scalar, place: int) -> Scalar:
    """Return a value of a type; raise `_IdlFault` if it is none."""
    if kind in builtin.STRINGS:
        if isinstance(value, str):
            return value
        raise _IdlFault(place, f"{value} is not a string")
    if isinstance(value, str):
        raise _IdlFault(place, f"{value[:40]!r} is not a {kind}")
    if kind == "bool" and isinstance(value, bool):
        return value
    try:
        return literals.scalar(kind, str(value) if kind == "bool" else repr(value))
    except LiteralError as fault:
        raise _IdlFault(place, str(fault)) from None
