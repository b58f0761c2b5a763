"""A package's manifest, package.xml, in the formats 1 (REP 127), 2 (REP 140) and 3 (REP 149)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from fibws.errors import PackageFileError
from fibws.ros1 import xml_tree
from fibws.ros1.workspace.condition import holds
from fibws.suggestions import nearest

FILE = "package.xml"

NAME = re.compile(r"[a-zA-Z0-9][a-zA-Z0-9_-]*", re.ASCII)
"""What catkin takes as the name of a package."""
NAME_RULE = "the name of a package has letters, digits, _ and - only, and no _ or - first"
BY_CONVENTION = re.compile(r"[a-z][a-z0-9_-]*", re.ASCII)
_VERSION = re.compile(r"\d+\.\d+\.\d+", re.ASCII)
_EMAIL = re.compile(r"[^@\s<>]+@[^@\s<>]+\.[^@\s<>]+")

_COMMON = {"name", "version", "description", "maintainer", "license", "url", "author", "export"}
_COMMON |= {"build_depend", "buildtool_depend", "test_depend", "conflict", "replace"}
_DEPEND_2 = {"depend", "build_export_depend", "buildtool_export_depend", "exec_depend"}
_TAGS = {
    1: _COMMON | {"run_depend"},
    2: _COMMON | _DEPEND_2 | {"doc_depend"},
    3: _COMMON | _DEPEND_2 | {"doc_depend", "group_depend", "member_of_group"},
}
_INSTEAD = {"run_depend": "exec_depend", "exec_depend": "run_depend"}
_BUILD = {"build_depend", "depend", "buildtool_depend"}
_EXEC = {"exec_depend", "depend", "run_depend"}
_EXPORTED = {"build_export_depend", "depend", "run_depend"}


@dataclass(frozen=True)
class Dependency:
    """One line that names a package which this one needs; ``tag`` says what for."""

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
    """What a package.xml says.

    Attributes:
        source: the file's name, for errors.
        line: the number of the line that its name stands in.
        depends: what it needs, in the file's order, those left out whose condition is not met.
        exports: the tags in <export>, with what is in them.
        warnings: what should be otherwise, each with file and line.
    """

    name: str
    version: str = "0.0.0"
    description: str = ""
    format: int = 2
    source: str = FILE
    line: int = 1
    maintainers: tuple[Person, ...] = ()
    licenses: tuple[str, ...] = ()
    depends: tuple[Dependency, ...] = ()
    exports: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    @property
    def build(self) -> dict[str, int]:
        """What it needs to be built, each with its line."""
        return self._tagged(_BUILD)

    @property
    def exec(self) -> dict[str, int]:
        """What it needs to run, each with its line."""
        return self._tagged(_EXEC)

    @property
    def exported(self) -> dict[str, int]:
        """What those need that build on it, each with its line."""
        return self._tagged(_EXPORTED)

    @property
    def direct(self) -> list[str]:
        """All packages that it names, but tools, and those for tests and documents."""
        tags = (_BUILD | _EXEC | _EXPORTED) - {"buildtool_depend"}
        return list(dict.fromkeys(each.name for each in self.depends if each.tag in tags))

    @property
    def is_metapackage(self) -> bool:
        """Whether it only gathers others."""
        return "metapackage" in self.exports

    def _tagged(self, tags: set[str]) -> dict[str, int]:
        return {each.name: each.line for each in reversed(self.depends) if each.tag in tags}


def read_name(folder: Path) -> str:
    """The name of the package in ``folder``, without a close look at its manifest.

    A manifest that is broken must not hide the package, so that the folder's name stands in.
    """
    try:
        text = (folder / FILE).read_text("utf-8", errors="replace")
    except OSError:
        return folder.name
    found = re.search(r"<name>\s*([^<\s]+)\s*</name>", re.sub(r"(?s)<!--.*?(?:-->|\Z)", "", text))
    return found[1] if found else folder.name


def read_manifest(folder: Path) -> Manifest:
    """The manifest of the package in ``folder``.

    Raises:
        PackageFileError: it does not parse, or lacks what every manifest has.
        OSError: it cannot be read.
    """
    path = folder / FILE
    return _Manifest(xml_tree.read(path.read_bytes(), str(path), _Element)).read()


class _Element(xml_tree.Element):
    """One element of a manifest."""

    @property
    def words(self) -> str:
        """Its text, with single blanks between the words."""
        return " ".join(self.text.split())

    def fault(self, text: str) -> PackageFileError:
        """An error that tells where this element stands."""
        return PackageFileError(self.file, self.line, text)


class _Manifest:
    """Reads one."""

    def __init__(self, root: _Element) -> None:
        self._root = root
        self._source = root.file
        self._warnings: list[str] = []

    def read(self) -> Manifest:
        if self._root.name != "package":
            raise self._root.fault(f"<package> is the root of a manifest, not <{self._root.name}>")
        format = self._format()
        self._check_tags(format)
        name = self._one("name")
        self._check_name(name)
        version = self._one("version")
        if not _VERSION.fullmatch(version.words):
            raise version.fault(f"the version is not of the form 1.2.3: {version.words!r}")
        depends = tuple(self._depends())
        self._check_depends(name.words, depends)
        return Manifest(
            name=name.words,
            version=version.words,
            description=self._one("description").words,
            format=format,
            source=self._source,
            line=name.line,
            maintainers=tuple(self._maintainers()),
            licenses=tuple(self._licenses()),
            depends=depends,
            exports={
                each.name: each.words
                for export in self._root.all("export")
                for each in export.children
                if self._is_needed(each)
            },
            warnings=tuple(self._warnings),
        )

    def _format(self) -> int:
        text = self._root.attributes.get("format", "1")
        if text not in ("1", "2", "3"):
            raise self._root.fault(f"the formats are 1, 2 and 3; {text!r} is none of them")
        return int(text)

    def _check_tags(self, format: int) -> None:
        known = _TAGS[format]
        for element in self._root.children:
            tag = element.name
            if tag in known:
                continue
            if tag in _INSTEAD and _INSTEAD[tag] in known:
                meant = f" write <{_INSTEAD[tag]}>, or <package format="
                meant += '"2">' if format == 1 else '"1">'
                raise element.fault(f"format {format} has no <{tag}>:{meant}")
            newer = [each for each in (2, 3) if tag in _TAGS[each]]
            if newer:
                fault = f'<{tag}> came with format {newer[0]}: write <package format="{newer[0]}">'
                raise element.fault(fault)
            near = nearest(tag, known)
            meant = f"; did you mean <{near}>?" if near else ""
            raise element.fault(f"a manifest has no <{tag}>{meant}")

    def _one(self, tag: str) -> _Element:
        found = self._root.all(tag)
        if not found:
            raise self._root.fault(f"<{tag}> is missing")
        if len(found) > 1:
            raise found[1].fault(f"there is a second <{tag}>")
        if not found[0].words:
            raise found[0].fault(f"<{tag}> is empty")
        return found[0]

    def _check_name(self, name: _Element) -> None:
        if not NAME.fullmatch(name.words):
            raise name.fault(f"{NAME_RULE}: {name.words!r}")
        if not BY_CONVENTION.fullmatch(name.words):
            self._warn(name, f"by convention a package's name is in lower case: {name.words!r}")

    def _maintainers(self) -> list[Person]:
        found = self._root.all("maintainer")
        if not found:
            raise self._root.fault("<maintainer> is missing: who looks after the package?")
        for each in found:
            email = each.attributes.get("email")
            if email is None:
                raise each.fault('<maintainer> has no email, as in email="me@example.com"')
            if not _EMAIL.fullmatch(email):
                raise each.fault(f"{email!r} is no email address, as in me@example.com")
        return [Person(each.words, each.attributes["email"]) for each in found]

    def _licenses(self) -> list[str]:
        found = self._root.all("license")
        if not found:
            raise self._root.fault("<license> is missing, as in <license>BSD</license>")
        for each in found:
            if not each.words:
                raise each.fault("<license> is empty")
        return [each.words for each in found]

    def _depends(self) -> list[Dependency]:
        depends = []
        for element in self._root.children:
            if not element.name.endswith("depend") or element.name == "group_depend":
                continue
            if not element.words:
                raise element.fault(f"<{element.name}> is empty")
            if self._is_needed(element):
                depends.append(Dependency(element.words, element.name, element.line))
        return depends

    def _is_needed(self, element: _Element) -> bool:
        """Whether the condition is met that the element has, if it has one."""
        try:
            condition = element.attributes.get("condition")
            return condition is None or holds(condition)
        except ValueError as error:
            raise element.fault(str(error)) from None

    def _check_depends(self, name: str, depends: tuple[Dependency, ...]) -> None:
        general = {each.name for each in depends if each.tag == "depend"}
        covered = {"build_depend", "exec_depend", "build_export_depend"}
        for each in depends:
            if each.name == name:
                fault = f"the package cannot depend on itself, as <{each.tag}> says"
                raise PackageFileError(self._source, each.line, fault)
            if each.name in general and each.tag in covered:
                fault = (
                    f"<depend>{each.name}</depend> has said this already: leave <{each.tag}> out"
                )
                raise PackageFileError(self._source, each.line, fault)

    def _warn(self, element: _Element, text: str) -> None:
        self._warnings.append(f"{self._source}, line {element.line}: {text}")
