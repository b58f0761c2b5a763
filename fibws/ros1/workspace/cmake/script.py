"""Goes through a CMakeLists.txt as CMake would: variables, if and foreach; it yields the rest."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from fibws.errors import PackageFileError
from fibws.ros1.workspace.cmake.condition import holds
from fibws.ros1.workspace.cmake.syntax import Argument, Command, split

_VARIABLE = re.compile(r"\$(?P<env>ENV)?\{(?P<name>[^${}]*)\}")
_ESCAPE = re.compile(r"\\(.)", re.DOTALL)
_ESCAPED = {"n": "\n", "t": "\t", "r": "\r", ";": "\\;"}
_ENDS = {"if": "endif", "foreach": "endforeach", "while": "endwhile", "block": "endblock"}
_ENDS |= {"function": "endfunction", "macro": "endmacro"}
_DEEPEST = 20
_MOST_COMMANDS = 20_000
"""That are carried out: loops in each other are soon without end."""
_MOST_CHARACTERS = 1_000_000
"""Of one command's arguments with all variables put in."""


@dataclass(frozen=True)
class Value:
    """One value that an argument has become, with the number of the argument's line."""

    text: str
    line: int


@dataclass(frozen=True)
class Call:
    """A command that is carried out, its arguments expanded."""

    name: str
    values: tuple[Value, ...]
    line: int

    @property
    def texts(self) -> list[str]:
        """The values alone."""
        return [value.text for value in self.values]


class Script:
    """What the commands of one file do, as far as it matters which are carried out.

    Args:
        commands: of the file.
        folder: that the file is in.
        source: the file's name, for errors.
        variables: that are set before it begins.

    Attributes:
        defined: the functions and macros that the file defines; their bodies are not looked at.
        unset: the variables that were asked for and had no value, each with its first line.
    """

    def __init__(
        self, commands: list[Command], folder: Path, source: str, variables: dict[str, str]
    ) -> None:
        self._commands = commands
        self._folder = folder
        self._source = source
        self.variables = dict(variables)
        self.targets: set[str] = set()
        self.defined: set[str] = set()
        self.unset: dict[str, int] = {}
        self._returned = False
        self._count = 0
        self._length = 0

    def calls(self) -> Iterator[Call]:
        """The commands that are carried out, but those that only steer it or set variables.

        Whoever reads them may set `variables` and `targets` between two of them.

        Raises:
            PackageFileError: an ``endif()`` or the like is missing, or stands alone.
        """
        yield from self._run(self._commands, 0)

    def _run(self, commands: list[Command], depth: int) -> Iterator[Call]:
        at = 0
        while at < len(commands) and not self._returned:
            command = commands[at]
            self._count += 1
            if self._count > _MOST_COMMANDS:
                raise self._fault(command, f"more than {_MOST_COMMANDS} commands are carried out")
            if command.name in _ENDS:
                end = self._end(commands, at)
                if depth < _DEEPEST:
                    yield from self._block(command, commands[at + 1 : end], depth)
                at = end
            elif command.name in {*_ENDS.values(), "else", "elseif"}:
                raise self._fault(command, f"{command.name}() ends nothing that was begun")
            elif command.name == "return":
                self._returned = True
            else:
                call = Call(command.name, tuple(self.expand(command.arguments)), command.line)
                if not self._sets(call):
                    yield call
            at += 1

    def _end(self, commands: list[Command], begin: int) -> int:
        """Where the block ends that begins there."""
        opened = [commands[begin]]
        for at in range(begin + 1, len(commands)):
            name = commands[at].name
            if name in _ENDS:
                opened.append(commands[at])
            elif name == _ENDS[opened[-1].name]:
                opened.pop()
                if not opened:
                    return at
            elif name in _ENDS.values():
                begun = opened[-1]
                missing = f"{begun.name}() of line {begun.line} has no {_ENDS[begun.name]}()"
                raise self._fault(commands[at], missing)
        last = opened[-1]
        raise self._fault(last, f"{last.name}() has no {_ENDS[last.name]}()")

    def _block(self, begin: Command, body: list[Command], depth: int) -> Iterator[Call]:
        if begin.name in ("function", "macro"):
            if begin.arguments:
                self.defined.add(begin.arguments[0].text.lower())
        elif begin.name == "foreach":
            variable, items = self._items(begin)
            for item in items:
                self.variables[variable] = item
                yield from self._run(body, depth + 1)
        elif begin.name == "if":
            yield from self._run(self._branch(begin, body), depth + 1)
        elif begin.name == "block":
            yield from self._run(body, depth + 1)

    def _branch(self, begin: Command, body: list[Command]) -> list[Command]:
        """The commands of the branch whose condition is met."""
        cuts = [0]
        heads = [begin]
        level = 0
        for at, command in enumerate(body):
            level += (command.name in _ENDS) - (command.name in _ENDS.values())
            if not level and command.name in ("else", "elseif"):
                cuts.append(at + 1)
                heads.append(command)
        ends = [*(cut - 1 for cut in cuts[1:]), len(body)]
        for head, first, last in zip(heads, cuts, ends, strict=True):
            if head.name == "else" or self._holds(head):
                return body[first:last]
        return []

    def _items(self, command: Command) -> tuple[str, list[str]]:
        texts = [value.text for value in self.expand(command.arguments)]
        if not texts:
            raise self._fault(command, "foreach() needs a variable")
        variable, items = texts[0], texts[1:]
        if items[:1] == ["RANGE"]:
            return variable, []
        if items[:1] == ["IN"]:
            kind, found = "", []
            for text in items[1:]:
                if text in ("LISTS", "ITEMS"):
                    kind = text
                elif kind == "LISTS":
                    found += split(self.variables.get(text, ""))
                else:
                    found.append(text)
            return variable, found
        return variable, items

    def _sets(self, call: Call) -> bool:
        """Carry out a command that sets a variable; False if it is no such command."""
        texts = call.texts
        if call.name == "set" and texts:
            values = texts[1:]
            if "CACHE" in values:
                values = values[: values.index("CACHE")]
            if values[-1:] == ["PARENT_SCOPE"]:
                values.pop()
            if values:
                self.variables[texts[0]] = ";".join(values)
            else:
                self.variables.pop(texts[0], None)
        elif call.name == "unset" and texts:
            self.variables.pop(texts[0], None)
        elif call.name == "option" and texts:
            self.variables.setdefault(texts[0], texts[2] if len(texts) > 2 else "OFF")
        elif call.name == "list" and len(texts) > 1:
            self._list(*texts)
        elif call.name == "file" and texts[:1] in (["GLOB"], ["GLOB_RECURSE"]):
            self._glob(texts)
        else:
            return False
        return True

    def _list(self, action: str, name: str, *values: str) -> None:
        items = split(self.variables.get(name, ""))
        if action == "APPEND":
            items += values
        elif action == "PREPEND":
            items = [*values, *items]
        elif action == "REMOVE_ITEM":
            items = [item for item in items if item not in values]
        elif action == "REMOVE_DUPLICATES":
            items = list(dict.fromkeys(items))
        elif action == "SORT":
            items.sort()
        else:
            return
        self.variables[name] = ";".join(items)

    def _glob(self, texts: list[str]) -> None:
        action, name, *patterns = [*texts, ""] if len(texts) == 1 else texts
        relative = None
        if patterns[:1] == ["RELATIVE"]:
            relative, patterns = Path(patterns[1]) if len(patterns) > 1 else None, patterns[2:]
        found: list[str] = []
        for pattern in patterns:
            if pattern in ("CONFIGURE_DEPENDS", "FOLLOW_SYMLINKS"):
                continue
            inside = Path(pattern)
            if inside.is_absolute():
                if not inside.is_relative_to(self._folder):
                    continue
                inside = inside.relative_to(self._folder)
            search = self._folder.rglob if action == "GLOB_RECURSE" else self._folder.glob
            try:
                paths = sorted(search(str(inside))) if inside.parts else []
            except ValueError:
                continue  # It is a pattern of CMake that is none of Python, as in **x.
            for path in paths:
                if relative is not None and path.is_relative_to(relative):
                    path = path.relative_to(relative)
                found.append(path.as_posix())
        self.variables[name] = ";".join(found)

    def expand(self, arguments: tuple[Argument, ...]) -> Iterator[Value]:
        """The values of arguments: variables put in, and those without quotes split at ``;``."""
        self._length = 0
        for argument in arguments:
            if argument.literal:
                yield Value(argument.text, argument.line)
                continue
            text = _unescaped(self._with_variables(argument))
            if argument.quoted:
                yield Value(text.replace("\\;", ";"), argument.line)
            else:
                yield from (Value(part, argument.line) for part in split(text))

    def _with_variables(self, argument: Argument) -> str:
        text = argument.text
        for _ in range(_DEEPEST):  # ${${PROJECT_NAME}_TARGETS}: from the inside out
            text, count = _VARIABLE.subn(lambda found: self._value(found, argument.line), text)
            if not count:
                break
        return text

    def _value(self, found: re.Match[str], line: int) -> str:
        if found["env"]:
            return ""
        name = found["name"]
        if name not in self.variables:
            self.unset.setdefault(name, line)
        value = self.variables.get(name, "")
        self._length += len(value)
        if self._length > _MOST_CHARACTERS:
            fault = f"${{{name}}} makes this longer than {_MOST_CHARACTERS} characters"
            raise PackageFileError(self._source, line, fault)
        return value

    def _holds(self, command: Command) -> bool:
        """Whether the condition of an ``if()`` is met."""
        words = [value.text for value in self.expand(command.arguments)]
        return holds(words, self.variables, self.targets, self.defined)

    def _fault(self, command: Command, fault: str) -> PackageFileError:
        return PackageFileError(self._source, command.line, fault)


def _unescaped(text: str) -> str:
    return _ESCAPE.sub(lambda found: _ESCAPED.get(found[1], found[1]), text)
