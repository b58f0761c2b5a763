"""Read the catkin macros of a CMakeLists.txt, which name the files that a package consists of.

CMake is not interpreted: conditions, loops and functions are not evaluated, so that the
commands inside them count, and all other commands are ignored. Variables of ``set()``,
``list(APPEND)`` and ``file(GLOB)`` are replaced; arguments with any other variable are unknown.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from fibws.errors import FibwsError
from fibws.processes import is_python
from fibws.ros1.errors import PackageFileError
from fibws.ros1.workspace.discovery import find_files
from fibws.suggestions import suggestion

FILE = "CMakeLists.txt"
ADD_FILES = {
    "msg": "add_message_files",
    "srv": "add_service_files",
    "action": "add_action_files",
}
"""The macros that list definitions, by the kind of the definitions."""

TESTS = ("add_rostest", "catkin_add_nosetests", "roslaunch_add_file_check")
"""The macros that list tests; roslaunch_add_file_check() lists launch files to be checked."""
CPP_TESTS = (
    *("catkin_add_gtest", "catkin_add_gmock", "catkin_add_executable_with_gtest"),
    *("add_rostest_gtest", "add_rostest_gmock"),
)

_TOKEN = re.compile(
    r"""
      (?P<blank> \s+ | \#(?!\[=*\[)[^\n]* | \#\[(?P<comment>=*)\[ .*? \](?P=comment)\] )
    | \[(?P<equals>=*)\[ \n? (?P<bracket> .*? ) \](?P=equals)\]
    | "(?P<quoted> (?: [^"\\] | \\. )* )"
    | (?P<parenthesis> [()] )
    | (?!\[=*\[) (?P<word> (?: [^\s()\#"\\] | \\. | (?<=[^\s(])"(?:[^"\\\n]|\\.)*" )+ )
    """,
    re.DOTALL | re.VERBOSE,
)
_VARIABLE = re.compile(r"\$\{([^${}]*)\}")
_MOST_NESTED = 10
_MOST_REPLACED = 1_000_000
"""How many characters all variables of one file may add to it."""


class Word(NamedTuple):
    """One argument of a command after its variables were replaced."""

    text: str
    line: int

    @property
    def is_known(self) -> bool:
        return "${" not in self.text


@dataclass(frozen=True)
class ListedFile:
    """A file that a macro names, with the line that names it."""

    path: Path
    line: int
    target: str = ""
    """For a program, the file in devel/ that starts it."""


@dataclass(frozen=True)
class ListedTest:
    """A file with tests, or a folder of such files, and the macro that names it."""

    macro: str
    path: Path
    arguments: tuple[str, ...]
    line: int


@dataclass
class CMakeLists:
    """The content of the macros of one CMakeLists.txt.

    Attributes:
        source: the file's path.
        project: the name in project(), with its line; empty if it is unknown.
        components: the packages in find_package(catkin COMPONENTS ...), each with its line.
        definitions: the listed files, by their kind: msg, srv, action.
        generates: the line of generate_messages(), or None.
        message_packages: its DEPENDENCIES, each with its line.
        programs: the Python programs that are installed.
        reconfigure: the .cfg files of generate_dynamic_reconfigure_options().
        python_setup: the line of catkin_python_setup(), or None.
        cpp_targets: the C++ programs and libraries, each with its line.
        tests: the tests that are not in C++.
        cpp_tests: the names of C++ tests.
        errors: why the package cannot be built.
        warnings: likely mistakes, each with file and line.
    """

    source: str
    project: Word = field(default_factory=lambda: Word("", 1))
    components: dict[str, int] = field(default_factory=dict)
    definitions: dict[str, list[ListedFile]] = field(
        default_factory=lambda: {kind: [] for kind in ADD_FILES}
    )
    generates: int | None = None
    message_packages: dict[str, int] = field(default_factory=dict)
    programs: list[ListedFile] = field(default_factory=list)
    reconfigure: list[ListedFile] = field(default_factory=list)
    python_setup: int | None = None
    cpp_targets: dict[str, int] = field(default_factory=dict)
    tests: list[ListedTest] = field(default_factory=list)
    cpp_tests: list[str] = field(default_factory=list)
    errors: list[FibwsError] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def error(self, line: int, text: str) -> None:
        """Add an error of this file."""
        self.errors.append(PackageFileError(self.source, line, text))

    def warn(self, line: int, text: str) -> None:
        """Add a warning about this file."""
        self.warnings.append(f"{self.source}, line {line}: {text}")


def read_cmake_lists(folder: Path, package: str) -> CMakeLists:
    """Read the CMakeLists.txt of a package.

    Args:
        folder: the package's folder.
        package: its name, which ``${PROJECT_NAME}`` stands for.

    Raises:
        PackageFileError: a parenthesis, a string or a comment has no end.
        OSError: the file cannot be read.
    """
    return _CommandReader(folder, package).read()


class _Command(NamedTuple):
    name: str
    arguments: list[tuple[str, bool, int]]
    """Text, whether it is quoted, and line."""
    line: int


def _commands(text: str, source: str) -> Iterator[_Command]:
    """Split a text into its commands; the names are in lower case, as CMake ignores the case."""
    at, line, depth = 0, 1, 0
    command = _Command("", [], 1)
    while at < len(text):
        token = _TOKEN.match(text, at)
        if token is None:
            shown = text[at : at + 30].splitlines()[0]
            raise PackageFileError(source, line, f"unterminated string or comment: {shown}")
        kind, begin, at = token.lastgroup, line, token.end()
        line += token[0].count("\n")
        if token["parenthesis"] == "(":
            depth += 1
        elif token["parenthesis"] == ")":
            depth -= 1
            if depth < 0:
                raise PackageFileError(source, begin, "unmatched ')'; is its '(' commented out?")
            if depth == 0:
                yield command
                command = _Command("", [], line)
        elif kind != "blank" and depth:
            command.arguments.append((token[kind or 0], kind != "word", begin))
        elif kind == "word":
            command = _Command(token["word"].lower(), [], begin)
    if depth:
        raise PackageFileError(source, command.line, f"missing ')' of {command.name}()")


class _CommandReader:
    """Reads one file, with a method for each command that matters."""

    def __init__(self, folder: Path, package: str) -> None:
        self._folder = folder
        self._package = package
        self._lists = CMakeLists(str(folder / FILE))
        self._replaced = 0
        here = folder.as_posix()
        self._variables = {
            "PROJECT_NAME": package,
            "CMAKE_CURRENT_SOURCE_DIR": here,
            "CMAKE_CURRENT_LIST_DIR": here,
            "CMAKE_SOURCE_DIR": here,
            "PROJECT_SOURCE_DIR": here,
            f"{package}_SOURCE_DIR": here,
            "CATKIN_ENABLE_TESTING": "ON",
            "CATKIN_PACKAGE_BIN_DESTINATION": f"lib/{package}",
            "CATKIN_PACKAGE_LIB_DESTINATION": f"lib/{package}",
            "CATKIN_PACKAGE_SHARE_DESTINATION": f"share/{package}",
            "CATKIN_PACKAGE_PYTHON_DESTINATION": f"lib/python3/dist-packages/{package}",
            "CATKIN_GLOBAL_BIN_DESTINATION": "bin",
            "CATKIN_GLOBAL_LIB_DESTINATION": "lib",
            "CATKIN_GLOBAL_SHARE_DESTINATION": "share",
        }
        self._readers: dict[str, Callable[[_Command, list[Word]], None]] = {
            "set": self._set,
            "list": self._list,
            "file": self._file,
            "project": self._project,
            "find_package": self._find_package,
            "generate_messages": self._generate_messages,
            "generate_dynamic_reconfigure_options": self._reconfigure,
            "catkin_python_setup": self._python_setup,
            "catkin_install_python": self._install,
            "install": self._install,
            "add_executable": self._cpp_target,
            "add_library": self._cpp_target,
            **dict.fromkeys(ADD_FILES.values(), self._add_files),
            **dict.fromkeys(TESTS, self._add_test),
            **dict.fromkeys(CPP_TESTS, self._add_cpp_test),
        }

    def read(self) -> CMakeLists:
        source = self._lists.source
        text = Path(source).read_text("utf-8-sig", errors="replace")
        for command in _commands(text, source):
            if reader := self._readers.get(command.name):
                reader(command, list(self._words(command)))
        listed = [file for files in self._lists.definitions.values() for file in files]
        if listed and self._lists.generates is None:
            self._lists.warn(
                min(file.line for file in listed), "generate_messages() is missing: not generated"
            )
        return self._lists

    def _words(self, command: _Command) -> Iterator[Word]:
        """Yield the arguments with their variables replaced; a list becomes several words."""
        for text, is_quoted, line in command.arguments:
            for _ in range(_MOST_NESTED):  # ${${PROJECT_NAME}_SOURCE_DIR}
                before, text = text, _VARIABLE.sub(self._value, text)
                if text == before:
                    break
            parts = [text] if is_quoted else filter(None, text.split(";"))
            yield from (Word(re.sub(r"\\(.)", r"\1", part), line) for part in parts)

    def _value(self, found: re.Match[str]) -> str:
        value = self._variables.get(found[1], found[0])
        self._replaced += len(value)
        return value if self._replaced < _MOST_REPLACED else found[0]

    def _set(self, command: _Command, words: list[Word]) -> None:
        texts = [word.text for word in words]
        if texts:
            ends = [texts.index(end) for end in ("CACHE", "PARENT_SCOPE") if end in texts]
            self._variables[texts[0]] = ";".join(texts[1 : min(ends, default=None)])

    def _list(self, command: _Command, words: list[Word]) -> None:
        texts = [word.text for word in words]
        if texts[:1] == ["APPEND"] and len(texts) > 2:
            old = self._variables.get(texts[1], "")
            self._variables[texts[1]] = ";".join([old, *texts[2:]] if old else texts[2:])

    def _file(self, command: _Command, words: list[Word]) -> None:
        texts = [word.text for word in words if word.text not in ("CONFIGURE_DEPENDS",)]
        if len(texts) < 3 or texts[0] not in ("GLOB", "GLOB_RECURSE"):
            return
        relative, patterns = self._folder, texts[2:]
        if patterns[0] == "RELATIVE" and len(patterns) > 1:
            relative, patterns = self._folder / patterns[1], patterns[2:]
        paths: list[str] = []
        search = self._folder.rglob if texts[0] == "GLOB_RECURSE" else self._folder.glob
        for pattern in patterns:
            inside = pattern.removeprefix(f"{self._folder.as_posix()}/")
            try:
                found = sorted(path for path in search(inside) if path.is_file())
            except (ValueError, NotImplementedError):
                continue  # An absolute path, or a pattern that Python does not have.
            paths += [
                (path.relative_to(relative) if path.is_relative_to(relative) else path).as_posix()
                for path in found
            ]
        self._variables[texts[1]] = ";".join(paths)

    def _project(self, command: _Command, words: list[Word]) -> None:
        if words and words[0].is_known:
            self._lists.project = words[0]

    def _find_package(self, command: _Command, words: list[Word]) -> None:
        if words and words[0].text == "catkin":
            parts = _grouped(words[1:], "REQUIRED", "COMPONENTS", "QUIET", "OPTIONAL_COMPONENTS")
            # Without the word COMPONENTS, the names behind REQUIRED are components, too.
            for word in (*parts.get("REQUIRED", ()), *parts.get("COMPONENTS", ())):
                if word.is_known:
                    self._lists.components.setdefault(word.text, word.line)

    def _add_files(self, command: _Command, words: list[Word]) -> None:
        kind = next(kind for kind, name in ADD_FILES.items() if name == command.name)
        parts = _grouped(words, "FILES", "DIRECTORY", "BASE_DIR", "NOINSTALL")
        for word in parts[""]:
            if word.is_known:
                self._lists.error(word.line, f"{command.name}(): expected FILES before {word.text}")
        directory = next((word.text for word in parts.get("DIRECTORY", ()) if word.is_known), kind)
        folder = self._folder / directory
        files = self._lists.definitions[kind]
        if "FILES" in parts and all(word.is_known for word in parts["FILES"]):
            found = [ListedFile(folder / word.text, word.line) for word in parts["FILES"]]
        else:
            paths = sorted(folder.glob(f"*.{kind}"))
            found = [ListedFile(path, command.line) for path in paths]
            if not folder.is_dir():
                self._lists.error(command.line, f"{command.name}(): folder {folder} not found")
        for file in found:
            if file.path not in (other.path for other in files):
                files.append(file)

    def _generate_messages(self, command: _Command, words: list[Word]) -> None:
        self._lists.generates = command.line
        for word in _grouped(words, "DEPENDENCIES", "LANGS").get("DEPENDENCIES", ()):
            if word.is_known:
                self._lists.message_packages.setdefault(word.text, word.line)

    def _reconfigure(self, command: _Command, words: list[Word]) -> None:
        for word in words:
            if word.is_known and self._exists(word, command):
                self._lists.reconfigure.append(ListedFile(self._folder / word.text, word.line))

    def _python_setup(self, command: _Command, words: list[Word]) -> None:
        if self._exists(Word("setup.py", command.line), command):
            self._lists.python_setup = command.line

    def _install(self, command: _Command, words: list[Word]) -> None:
        if not words or words[0].text.upper() != "PROGRAMS":
            if command.name == "catkin_install_python":
                self._lists.error(command.line, "catkin_install_python(): expected PROGRAMS first")
            return
        parts = _grouped(words[1:], "DESTINATION", "RENAME", "OPTIONAL", "PERMISSIONS", "COMPONENT")
        is_optional = "OPTIONAL" in parts
        destinations = [word.text for word in parts.get("DESTINATION", ()) if word.is_known]
        destination = PurePosixPath(destinations[0] if destinations else f"lib/{self._package}")
        if destination.is_absolute() or ".." in destination.parts:
            return  # It is outside devel/.
        for word in parts[""]:
            path = self._folder / word.text
            if not word.is_known or (is_optional and not path.is_file()):
                continue
            if self._exists(word, command) and is_python(path):
                name = parts["RENAME"][0].text if parts.get("RENAME") else path.name
                target = (destination / name).as_posix()
                self._lists.programs.append(ListedFile(path, word.line, target))

    def _cpp_target(self, command: _Command, words: list[Word]) -> None:
        kinds = {word.text for word in words[1:2]}
        if words and not kinds & {"INTERFACE", "ALIAS", "IMPORTED"}:
            self._lists.cpp_targets.setdefault(words[0].text, words[0].line)

    def _add_test(self, command: _Command, words: list[Word]) -> None:
        options = ("DEPENDENCIES", "TIMEOUT", "WORKING_DIRECTORY", "OPTIONS")
        parts = _grouped(words, "ARGS", *options, "USE_TEST_DEPENDENCIES")
        files = [word for word in parts[""] if word.is_known]
        # The arguments of roslaunch_add_file_check() are name=value; those of rostest, name:=value.
        arguments = [word.text for word in (*files[1:], *parts.get("ARGS", ()))]
        if command.name == "roslaunch_add_file_check":
            arguments = [re.sub(r"(?<!:)=", ":=", each, count=1) for each in arguments]
        for word in files[:1]:
            path = self._folder / word.text
            test = ListedTest(command.name, path, tuple(arguments), command.line)
            if path.is_relative_to(self._folder) and test not in self._lists.tests:
                self._lists.tests.append(test)

    def _add_cpp_test(self, command: _Command, words: list[Word]) -> None:
        self._lists.cpp_tests += [word.text for word in words[:1]]

    def _exists(self, word: Word, command: _Command) -> bool:
        """Return whether a file exists; report it if it does not.

        It is an error where catkin_make has an error, and else a warning.
        """
        if (self._folder / word.text).is_file():
            return True
        text = f"{command.name}(): {word.text} not found{self._similar_file(word.text)}"
        if command.name == "install":
            self._lists.warn(word.line, text)
        else:
            self._lists.error(word.line, text)
        return False

    def _similar_file(self, name: str) -> str:
        path = PurePosixPath(name)
        files = [each.relative_to(self._folder).as_posix() for each in find_files(self._folder)]
        for file in files:
            if PurePosixPath(file).name == path.name:
                return f"; did you mean {file}?"
        return suggestion(name, [file for file in files if file.endswith(path.suffix)])


def _grouped(words: Sequence[Word], *keywords: str) -> dict[str, list[Word]]:
    """Return the words behind each keyword; the words before the first one are under ""."""
    groups: dict[str, list[Word]] = {"": []}
    group = groups[""]
    for word in words:
        if word.text in keywords:
            group = groups.setdefault(word.text, [])
        else:
            group.append(word)
    return groups
