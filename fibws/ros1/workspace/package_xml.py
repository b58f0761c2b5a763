"""Read package.xml in its formats 1 (REP 127), 2 (REP 140) and 3 (REP 149)."""

from __future__ import annotations

import operator
import os
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from fibws.ros1 import xml_tree
from fibws.ros1.errors import PackageFileError
from fibws.ros1.shell.environment import OF_ROS
from fibws.suggestions import suggestion

FILE = "package.xml"

NAME = re.compile(r"[a-zA-Z0-9][a-zA-Z0-9_-]*", re.ASCII)
"""The names that catkin allows for packages."""
NAME_RULE = "a package name consists of letters, digits, _ and -, and begins with a letter or digit"
CONVENTIONAL_NAME = re.compile(r"[a-z][a-z0-9_-]*", re.ASCII)
VERSION = re.compile(r"\d+\.\d+\.\d+", re.ASCII)
_EMAIL = re.compile(
    r"[-\w%+]+(\.[-\w%+]+)*@[-a-zA-Z0-9%]+(\.[-a-zA-Z0-9%]+)*\.[a-zA-Z]{2,}", re.ASCII
)

_VERSIONS = {"version_lt", "version_lte", "version_eq", "version_gte", "version_gt"}
_COMMON = {"name", "version", "description", "maintainer", "license", "url", "author", "export"}
_COMMON |= {"build_depend", "buildtool_depend", "test_depend", "conflict", "replace"}
_DEPEND_2 = {"depend", "build_export_depend", "buildtool_export_depend", "exec_depend"}
_DEPEND_2 |= {"doc_depend"}
_GROUPS = {"group_depend", "member_of_group"}
_TAGS = {
    1: _COMMON | {"run_depend"},
    2: _COMMON | _DEPEND_2,
    3: _COMMON | _DEPEND_2 | _GROUPS,
}
_ATTRIBUTES = {
    "version": {"compatibility"},
    "maintainer": {"email"},
    "author": {"email"},
    "url": {"type"},
    "license": {"file"},
}
_INSTEAD = {"run_depend": "exec_depend", "exec_depend": "run_depend"}
_TAGS_OF = {
    "build": {"build_depend", "depend"},
    "build_export": {"build_export_depend", "depend", "run_depend"},
    "exec": {"exec_depend", "depend", "run_depend"},
}
"""The elements that stand for a kind of dependency, if there are several."""


@dataclass(frozen=True)
class Dependency:
    """One dependency; ``tag`` is its element, as in ``build_depend``."""

    name: str
    tag: str
    line: int


@dataclass(frozen=True)
class Person:
    """A maintainer or an author."""

    name: str
    email: str


@dataclass(frozen=True)
class Manifest:
    """The content of a package.xml.

    Attributes:
        source: the file's path.
        line: the line of its name.
        depends: the dependencies whose conditions are true, in the file's order.
        group_depends: the groups whose members it needs.
        groups: the groups that it is a member of.
        exports: the elements in <export>, with their texts.
        warnings: likely mistakes, each with file and line.
    """

    name: str
    version: str = "0.0.0"
    description: str = ""
    format: int = 2
    source: str = FILE
    line: int = 1
    maintainers: tuple[Person, ...] = ()
    authors: tuple[Person, ...] = ()
    licenses: tuple[str, ...] = ()
    depends: tuple[Dependency, ...] = ()
    group_depends: tuple[str, ...] = ()
    groups: tuple[str, ...] = ()
    exports: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def needs(self, *kinds: str) -> list[str]:
        """Return the names of dependencies, each once.

        Args:
            kinds: build, buildtool, build_export, buildtool_export, exec, test or doc.
        """
        tags = {tag for kind in kinds for tag in _TAGS_OF.get(kind, {f"{kind}_depend"})}
        return list(dict.fromkeys(each.name for each in self.depends if each.tag in tags))

    @property
    def direct(self) -> list[str]:
        """The packages that it needs to be built and to run, without tools, tests and docs."""
        return self.needs("build", "build_export", "exec")

    @property
    def is_metapackage(self) -> bool:
        """Whether it only groups other packages."""
        return "metapackage" in self.exports


def read_name(folder: Path) -> str:
    """Return the name of the package in ``folder``, even if its package.xml is invalid.

    Without a name in the file, it is the folder's name.
    """
    try:
        text = (folder / FILE).read_text("utf-8", errors="replace")
    except OSError:
        return folder.name
    found = re.search(r"<name>\s*([^<\s]+)\s*</name>", re.sub(r"(?s)<!--.*?(?:-->|\Z)", "", text))
    return found[1] if found else folder.name


def read_manifest(folder: Path) -> Manifest:
    """Read the package.xml in ``folder``.

    Raises:
        PackageFileError: the file is invalid.
        OSError: the file cannot be read.
    """
    path = folder / FILE
    return _ManifestReader(xml_tree.read(path.read_bytes(), str(path), _Element)).read()


class _Element(xml_tree.Element):
    """One element of a package.xml."""

    @property
    def words(self) -> str:
        """Its text, with single spaces between the words."""
        return " ".join(self.text.split())

    def fault(self, text: str) -> PackageFileError:
        """Return an error at this element."""
        return PackageFileError(self.file, self.line, text)


class _ManifestReader:
    """Reads and checks one package.xml, by the rules of catkin_pkg."""

    def __init__(self, root: _Element) -> None:
        self._root = root
        self._source = root.file
        self._warnings: list[str] = []

    def read(self) -> Manifest:
        if self._root.name != "package":
            raise self._root.fault(f"expected <package> as the root, got <{self._root.name}>")
        format = self._format()
        self._check_elements(format)
        name = self._one("name")
        self._check_name(name)
        version = self._one("version")
        if not VERSION.fullmatch(version.words):
            raise version.fault(f"invalid version {version.words!r}, expected e.g. 1.2.3")
        self._check_dependencies(name.words, format)
        exports = self._root.all("export")
        if len(exports) > 1:
            raise exports[1].fault("more than one <export>")
        return Manifest(
            name=name.words,
            version=version.words,
            description=self._one("description", may_have_children=True).words,
            format=format,
            source=self._source,
            line=name.line,
            maintainers=tuple(self._maintainers()),
            authors=tuple(self._people("author")),
            licenses=tuple(self._licenses()),
            depends=tuple(
                Dependency(each.words, each.name, each.line)
                for each in self._dependencies()
                if _is_true(each)
            ),
            group_depends=self._groups("group_depend"),
            groups=self._groups("member_of_group"),
            exports={
                each.name: each.words
                for export in exports
                for each in export.children
                if _is_true(each)
            },
            warnings=tuple(self._warnings),
        )

    def _format(self) -> int:
        text = self._root.attributes.get("format", "1")
        if text not in ("1", "2", "3"):
            raise self._root.fault(f"unknown format {text!r}; known are 1, 2 and 3")
        return int(text)

    def _check_elements(self, format: int) -> None:
        self._check_attributes(self._root, {"format"})
        for element in self._root.children:
            tag = element.name
            if tag not in _TAGS[format]:
                raise element.fault(_unknown_element(tag, format))
            known = set(_ATTRIBUTES.get(tag, ()))
            if tag == "license" and format < 3:
                known = set()
            if tag in _GROUPS:
                known = {"condition"}
            elif tag.endswith("depend") or tag in ("conflict", "replace"):
                known = _VERSIONS | ({"condition"} if format == 3 else set())
            self._check_attributes(element, known)
            if element.children and tag not in ("description", "export"):
                child = element.children[0]
                raise child.fault(f"<{tag}> must contain only text, got <{child.name}>")

    def _check_attributes(self, element: _Element, known: set[str]) -> None:
        for name in element.attributes:
            if name not in known and name != "xmlns" and ":" not in name:
                text = f"<{element.name}>: unknown attribute {name}{suggestion(name, known)}"
                raise element.fault(text)

    def _one(self, tag: str, *, may_have_children: bool = False) -> _Element:
        found = self._root.all(tag)
        if not found:
            raise self._root.fault(f"<{tag}> is missing")
        if len(found) > 1:
            raise found[1].fault(f"more than one <{tag}>")
        if not found[0].words and not (may_have_children and found[0].children):
            raise found[0].fault(f"<{tag}> is empty")
        return found[0]

    def _check_name(self, name: _Element) -> None:
        if not NAME.fullmatch(name.words):
            raise name.fault(f"invalid name {name.words!r}: {NAME_RULE}")
        if not CONVENTIONAL_NAME.fullmatch(name.words):
            text = f"by convention, package names are in lower case: {name.words!r}"
            self._warnings.append(f"{self._source}, line {name.line}: {text}")

    def _people(self, tag: str) -> Iterator[Person]:
        for each in self._root.all(tag):
            email = each.attributes.get("email")
            if email is not None and not _EMAIL.fullmatch(email):
                raise each.fault(f"invalid email {email!r}, expected e.g. me@example.com")
            yield Person(each.words, email or "")

    def _maintainers(self) -> list[Person]:
        people = list(self._people("maintainer"))
        if not people:
            raise self._root.fault("<maintainer> is missing")
        for each in self._root.all("maintainer"):
            if "email" not in each.attributes:
                raise each.fault('<maintainer> requires email="me@example.com"')
        return people

    def _licenses(self) -> list[str]:
        found = self._root.all("license")
        if not found:
            raise self._root.fault("<license> is missing, as in <license>BSD</license>")
        for each in found:
            if not each.words:
                raise each.fault("<license> is empty")
        return [each.words for each in found]

    def _groups(self, tag: str) -> tuple[str, ...]:
        return tuple(each.words for each in self._root.all(tag) if _is_true(each))

    def _dependencies(self) -> list[_Element]:
        """Return the elements of dependencies, whatever their conditions."""
        found = [
            each
            for each in self._root.children
            if each.name.endswith("depend") and each.name not in _GROUPS
        ]
        for each in found:
            if not each.words:
                raise each.fault(f"<{each.name}> is empty")
        return found

    def _check_dependencies(self, name: str, format: int) -> None:
        if format == 1:
            covered = {tag: {"test_depend"} for tag in ("build_depend", "run_depend")}
        else:
            covered = {"depend": {"build_depend", "exec_depend", "build_export_depend"}}
        groups = {each.words for each in self._root.all("member_of_group")}
        for each in self._root.all("group_depend"):
            if each.words in groups:
                raise each.fault(f"<group_depend>: the package is a member of {each.words} itself")
        dependencies = self._dependencies()
        general = [each for each in dependencies if each.name in covered]
        for each in dependencies:
            if each.words == name:
                raise each.fault(f"<{each.name}>: the package cannot depend on itself")
            for other in general:
                is_same = (each.words, each.attributes) == (other.words, other.attributes)
                if is_same and each.name in covered[other.name]:
                    text = f"<{each.name}>{each.words} is redundant: line {other.line}"
                    raise each.fault(f"{text} has <{other.name}>{other.words}")


def _unknown_element(tag: str, format: int) -> str:
    """Return the text of the error about an element that the format does not have."""
    other = _INSTEAD.get(tag)
    if other in _TAGS[format]:
        other_format = 2 if format == 1 else 1
        remedy = f'write <{other}>, or <package format="{other_format}">'
        return f"format {format} has no <{tag}>: {remedy}"
    for newer in (2, 3):
        if tag in _TAGS[newer]:
            return f'<{tag}> requires <package format="{newer}">'
    return f"unknown element <{tag}>{suggestion(tag, _TAGS[format])}"


def _is_true(element: _Element) -> bool:
    """Return whether an element's condition is true, or it has none."""
    try:
        condition = element.attributes.get("condition")
        return condition is None or evaluate_condition(condition)
    except ValueError as error:
        raise element.fault(str(error)) from None


_WORD = re.compile(r"""\s*(?:([()])|([=!<>]=|[<>])|(["'])(.*?)\3|(\$\w+)|([\w-]+))""", re.ASCII)
_OPERATORS: dict[str, Callable[[str, str], bool]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<=": operator.le,
    ">=": operator.ge,
    "<": operator.lt,
    ">": operator.gt,
}


def evaluate_condition(condition: str, variables: Mapping[str, str] | None = None) -> bool:
    """Evaluate a condition of format 3: ``$ROS_VERSION == 1 and $A != "b"``.

    Values are compared as texts, as in catkin.

    Args:
        condition: the text of the attribute.
        variables: the values of ``$NAME``; by default the environment, with `OF_ROS`.

    Raises:
        ValueError: the condition is invalid.
    """
    if variables is None:
        variables = {**OF_ROS, **os.environ}
    return _Condition(condition, variables).evaluate()


class _Condition:
    """Reads a condition from left to right; ``and`` binds closer than ``or``."""

    def __init__(self, text: str, variables: Mapping[str, str]) -> None:
        self._text = text.rstrip()
        self._at = 0
        self._variables = variables

    def evaluate(self) -> bool:
        value = self._either()
        if self._at < len(self._text):
            raise self._error()
        return value

    def _either(self) -> bool:
        value = self._both()
        while self._take("or"):
            value = self._both() or value
        return value

    def _both(self) -> bool:
        value = self._comparison()
        while self._take("and"):
            value = self._comparison() and value
        return value

    def _comparison(self) -> bool:
        if self._take("("):
            value = self._either()
            if not self._take(")"):
                raise self._error()
            return value
        left = self._value()
        found = _WORD.match(self._text, self._at)
        if found is None or not found[2]:
            raise self._error()
        self._at = found.end()
        return _OPERATORS[found[2]](left, self._value())

    def _value(self) -> str:
        found = _WORD.match(self._text, self._at)
        if found is None or found[1] or found[2]:
            raise self._error()
        self._at = found.end()
        if found[3]:
            return found[4]
        return self._variables.get(found[5][1:], "") if found[5] else found[6]

    def _take(self, word: str) -> bool:
        found = _WORD.match(self._text, self._at)
        if found is None or word not in (found[1], found[6]):
            return False
        self._at = found.end()
        return True

    def _error(self) -> ValueError:
        return ValueError(f"invalid condition {self._text!r}, expected e.g. $ROS_VERSION == 1")
