"""The definitions in folders of packages: the standard ones and the user's.

Packages have ROS's layout, ``<package>/msg/Type.msg``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from typing import Literal, NamedTuple, TypeAlias, TypeVar

from fibws.errors import InterfaceError, UnknownPackage, UnknownType
from fibws.interfaces import parser
from fibws.interfaces.definition import (
    ACTION_SUFFIXES,
    ActionDefinition,
    MessageDefinition,
    ServiceDefinition,
)
from fibws.interfaces.idl import IdlFile
from fibws.suggestions import nearest

D = TypeVar("D", MessageDefinition, ServiceDefinition, ActionDefinition)
Kind: TypeAlias = Literal["msg", "srv", "action"]
KINDS: tuple[Kind, ...] = ("msg", "srv", "action")


STANDARD = Path(__file__).parent / "definitions"
"""The folder of the standard packages."""


IDL = "idl"
"""The suffix of the files that rosidl makes of all others, and that a package may have instead."""
SIMILAR = 0.85
"""Similarity from which a package is suggested for another: many names end in ``_msgs``."""


class InterfacePackage:
    """The definition files of one package, listed on first use.

    Attributes:
        standard: the standard package of the same name, whose types it hides one by one.
    """

    __slots__ = ("_files", "_is_ros2s", "folder", "name", "standard")

    def __init__(self, name: str, folder: Path) -> None:
        self.name = name
        self.folder = folder
        self.standard: InterfacePackage | None = None
        self._files: dict[Kind, dict[str, Path]] = {}
        self._is_ros2s: bool | None = None

    def files(self, kind: Kind) -> dict[str, Path]:
        """Return the files of one kind by the names of their types."""
        if kind not in self._files:
            own = self._own_files(kind)
            self._files[kind] = own if self.standard is None else self._hidden(kind) | own
        return self._files[kind]

    def is_ros2s(self, path: Path) -> bool:
        """Return whether one of its files is ROS 2's: the manifest depends on rosidl."""
        if path.parent.parent != self.folder:
            return False  # It is of the standard package.
        if self._is_ros2s is None:
            manifest = self.folder / "package.xml"
            text = manifest.read_text("utf-8", "replace") if manifest.is_file() else ""
            self._is_ros2s = "rosidl_" in text
        return self._is_ros2s

    def _own_files(self, kind: Kind) -> dict[str, Path]:
        # An installed package of ROS 2 has both; IDL is what .msg files became.
        paths = [path for suffix in (IDL, kind) for path in self.folder.glob(f"{kind}/*.{suffix}")]
        found = {path.stem: path for path in paths if _is_name(path.stem)}
        return dict(sorted(found.items()))

    def _hidden(self, kind: Kind) -> dict[str, Path]:
        """The files of the standard package; messages hide the action that they are made of."""
        assert self.standard is not None
        files = self.standard.files(kind)
        if kind != "action":
            return files
        messages = self._own_files("msg")
        made = {name: [f"{name}{suffix}" for suffix in ACTION_SUFFIXES] for name in files}
        return {name: files[name] for name in files if messages.keys().isdisjoint(made[name])}


def find_packages(folder: Path) -> Iterator[InterfacePackage]:
    """Yield the packages in ``folder``, which may be a package itself."""
    if _is_package(folder):
        yield InterfacePackage(folder.resolve().name, folder)
        return
    for entry in sorted(folder.iterdir()):
        if _is_package(entry):
            yield InterfacePackage(entry.name, entry)


def _is_package(folder: Path) -> bool:
    named = _is_name(folder.resolve().name)
    return named and any((folder / kind).is_dir() for kind in KINDS)


def _is_name(text: str) -> bool:
    return text.isascii() and text.isidentifier()


class _File(NamedTuple):
    """A file that defines a type.

    ``text`` has its content, the package, the type's own name and the file's name.
    """

    text: tuple[str, str, str, str]
    is_ros2s: bool


class Folders:
    """The definitions in the packages of several folders, each parsed on first use.

    Of the user's packages with the same name, only the one in the folder that was added last
    counts. It hides the standard package type by type.
    """

    def __init__(self) -> None:
        self._folders = [STANDARD]
        self._forget()

    def _forget(self) -> None:
        self._packages: dict[str, InterfacePackage] = {}
        self._messages: dict[str, MessageDefinition] = {}
        self._services: dict[str, ServiceDefinition] = {}
        self._actions: dict[str, ActionDefinition] = {}
        self._idl_files: dict[Path, IdlFile] = {}

    def add(self, folder: Path) -> bool:
        """Add a folder, which holds packages side by side or is one; return whether it is new.

        Raises:
            InterfaceError: there is no such folder.
        """
        if folder in self._folders:
            return False
        if not folder.is_dir():
            raise InterfaceError(f"{folder}: folder of definitions not found")
        self._folders.append(folder)
        self._forget()
        return True

    def find_message(self, name: str) -> MessageDefinition | None:
        """The message of that name, or None; types nested in it may be unknown.

        Raises:
            DefinitionError: the definition is wrong.
        """
        return _kept(self._messages, name, self._parse_message)

    def find_service(self, name: str) -> ServiceDefinition | None:
        """The service of that name, or None; as `find_message`."""
        return _kept(self._services, name, self._parse_service)

    def find_action(self, name: str) -> ActionDefinition | None:
        """The action of that name, or None; as `find_message`."""
        return _kept(self._actions, name, self._parse_action)

    def _parse_message(self, name: str) -> MessageDefinition | None:
        package, _, short = name.partition("/")
        for suffix in ACTION_SUFFIXES:
            base = short.removesuffix(suffix)
            action = self.find_action(f"{package}/{base}") if base != short else None
            if action is not None:
                return next(message for message in action.messages() if message.type == name)
        found = self._read(name, "msg")
        if isinstance(found, _File):
            return parser.parse_message(*found.text, ros2=found.is_ros2s)
        if found is not None and (message := found.messages().get(name)) is not None:
            return message
        return self._find_beside(name)

    def _parse_service(self, name: str) -> ServiceDefinition | None:
        found = self._read(name, "srv")
        if isinstance(found, IdlFile):
            return found.service(*name.split("/"))
        return parser.parse_service(*found.text, ros2=found.is_ros2s) if found else None

    def _parse_action(self, name: str) -> ActionDefinition | None:
        found = self._read(name, "action")
        if isinstance(found, IdlFile):
            return found.action(*name.split("/"))
        return parser.parse_action(*found.text, ros2=found.is_ros2s) if found else None

    def packages(self) -> dict[str, InterfacePackage]:
        """The packages by name."""
        if not self._packages:
            # Assigned at once: in rospy's programs several threads call this.
            standard, *users = (
                {found.name: found for found in find_packages(folder)} for folder in self._folders
            )
            packages = dict(standard)
            for found in users:
                packages |= found
            for name, package in packages.items():
                if package is not standard.get(name):
                    package.standard = standard.get(name)
            self._packages = packages
        return self._packages

    @property
    def is_standard(self) -> bool:
        """Whether there are no folders of the user."""
        return len(self._folders) == 1

    def is_users(self, package: str) -> bool:
        """Whether the package is in one of the user's folders."""
        if self.is_standard:
            return False  # without a look at the folder of the standard packages
        found = self.packages().get(package)
        return found is not None and found.folder.parent != STANDARD

    def names(self, kind: Kind, package: str) -> Iterator[str]:
        """The types of one kind in a package as ``package/Name``."""
        yield from (f"{package}/{name}" for name in self._files(kind, package))
        if kind == "msg":
            for name in self._files("action", package):
                yield from (f"{package}/{name}{suffix}" for suffix in ACTION_SUFFIXES)

    def nearest(self, package: str) -> str | None:
        """The package with the most similar name, or None."""
        return nearest(package, self.packages(), SIMILAR)

    def unknown(self, kind: Kind, name: str) -> UnknownPackage | UnknownType:
        """The error to raise for a name that is not found; it may suggest another one.

        That is a similar name of the same package, or the same name in another package.
        """
        package, _, short = name.partition("/")
        if package not in self.packages():
            near = self.nearest(package)
            return UnknownPackage(package, near, near and self._similar(kind, near, short))
        near = self._similar(kind, package, short)
        if near is None:
            others = (each.name for each in self.packages().values() if short in each.files(kind))
            near = next((f"{other}/{short}" for other in others), None)
        other = next((each for each in KINDS if name in self.names(each, package)), None)
        return UnknownType(kind, package, short, near, other)

    def _similar(self, kind: Kind, package: str, short: str) -> str | None:
        """The package's type with the most similar name, if one is similar."""
        names = [other.partition("/")[2] for other in self.names(kind, package)]
        near = nearest(short, names)
        return f"{package}/{near}" if near else None

    def _find_beside(self, name: str) -> MessageDefinition | None:
        """The message of that name in an IDL file that is named after another type, or None."""
        for path in self._files("msg", name.partition("/")[0]).values():
            if path.suffix == f".{IDL}":
                try:
                    found = self._idl(path).messages().get(name)
                except InterfaceError:
                    continue  # It is told by those who ask for the type of the file's name.
                if found is not None:
                    return found
        return None

    def _idl(self, path: Path) -> IdlFile:
        if path not in self._idl_files:
            text = path.read_text("utf-8-sig", errors="replace")
            self._idl_files[path] = IdlFile(text, str(path), partial(self._included, path))
        return self._idl_files[path]

    def _included(self, by: Path, path: str) -> str | None:
        """The text of a file that another one includes, or None."""
        package, slash, rest = path.partition("/")
        found = self.packages().get(package) if slash else None
        place = found.folder / rest if found is not None else by.parent / path
        try:
            return place.read_text("utf-8-sig", errors="replace")
        except OSError:
            return None

    def _read(self, name: str, kind: Kind) -> _File | IdlFile | None:
        """The file that defines a type."""
        package, _, short = name.partition("/")
        path = self._files(kind, package).get(short)
        if path is None:
            return None
        if path.suffix == f".{IDL}":
            return self._idl(path)
        # Editors of Windows begin a file with a mark; a comment in Latin-1 does no harm.
        text = path.read_text("utf-8-sig", errors="replace")
        is_ros2s = self.packages()[package].is_ros2s(path)
        return _File((text, package, short, str(path)), is_ros2s)

    def _files(self, kind: Kind, package: str) -> dict[str, Path]:
        found = self.packages().get(package)
        return found.files(kind) if found else {}


def _kept(known: dict[str, D], name: str, parse: Callable[[str], D | None]) -> D | None:
    """Return what is known by a name, or is parsed for it and then known; None if there is none."""
    found = known.get(name) or parse(name)
    if found is not None:
        known[name] = found
    return found


@cache
def standard_folders() -> Folders:
    """The standard packages alone: they do not change, so all hubs of a process may share them."""
    return Folders()
