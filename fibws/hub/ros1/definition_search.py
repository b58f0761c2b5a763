"""The search for type definitions in the packages of an installed ROS and of its workspaces.

ROS 1 nodes name their services' types, but never send the definitions. Files are looked for only
when a definition is needed: nothing here is read when the hub starts.
"""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from threading import Lock
from typing import NamedTuple

from fibws.errors import InterfaceError, UnknownPackage, UnknownType
from fibws.hub.package_folders import PackageFolders
from fibws.hub.ros1.tcpros import ANY
from fibws.interfaces import (
    ActionDefinition,
    Interfaces,
    MessageDefinition,
    ServiceDefinition,
    parser,
)
from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.client_definitions import LONGEST_TEXT
from fibws.interfaces.definition import ACTION_SUFFIXES
from fibws.interfaces.folders import STANDARD, Kind


class FoundDefinition(NamedTuple):
    """A definition that was found in a file."""

    path: Path
    text: str
    """With the types nested in it, as clients send it."""
    md5sum: str


class DefinitionSearch:
    """Finds definitions by the names and md5s of types.

    They are looked for in the user's folders first, then in the packages of an installed ROS and of
    its workspaces (`PackageFolders`), then in fibws's standard ones. `find` may be called in any
    thread.

    Args:
        folders: the user's, as for `Interfaces`.
        environment: has the variables.
    """

    def __init__(self, folders: Iterable[Path], environment: Mapping[str, str]) -> None:
        self._folders = tuple(folders)
        self._installed = PackageFolders(environment)
        self._lock = Lock()

    async def find_soon(self, kind: Kind, name: str, md5sum: str = ANY) -> FoundDefinition:
        """Return what `find` does, which searches in another thread."""
        return await asyncio.to_thread(self.find, kind, name, md5sum)

    def find(self, kind: Kind, name: str, md5sum: str = ANY) -> FoundDefinition:
        """Return the first definition of a type, ``package/Type``, that has an md5.

        Raises:
            InvalidTypeName: the name is not valid.
            InterfaceError: not found, or found only with another md5; the text names the folders
                that were searched, and what to do.
        """
        name = Interfaces.canonical(name)
        package, _, short = name.partition("/")
        faults = []
        with self._lock:
            for folder in self.packages(package):
                try:
                    path = _file_of(folder, kind, short)
                    if path is None:
                        continue
                    found = _read(_PackageDefinitions(self, package, folder), kind, name, path)
                except InterfaceError as error:
                    faults.append(str(error))
                    continue
                except OSError as error:
                    faults.append(f"{folder}: {error}")
                    continue
                if md5sum in (ANY, found.md5sum):
                    return found
                faults.append(f"{path} has the md5sum {found.md5sum}")
        raise InterfaceError(self._not_found(name, md5sum, faults))

    def packages(self, name: str) -> Iterator[Path]:
        """Yield the folders of a package, in the order of the search path."""
        seen = set()
        for folder in self._places(name):
            if folder not in seen and any((folder / kind).is_dir() for kind in _KINDS):
                seen.add(folder)
                yield folder

    def _places(self, name: str) -> Iterator[Path]:
        """Yield the folders that may be a package's."""
        for folder in self._folders:
            if folder.resolve().name == name:
                yield folder
            yield folder / name
        yield from self._installed.find(name)
        yield STANDARD / name

    def _not_found(self, name: str, md5sum: str, faults: list[str]) -> str:
        package = name.partition("/")[0]
        wanted = name if md5sum == ANY else f"{name} (md5sum {md5sum})"
        text = f"the definition of {wanted} was not found on the hub's machine"
        if faults:
            text = f"{text}: {'; '.join(faults)}"
        return (
            f"{text}; start the hub with --interfaces DIR, the folder that holds the package "
            f"{package}, or with ROS_PACKAGE_PATH as in that package's workspace"
        )


class _PackageDefinitions(Definitions):
    """The definitions of one folder of a package, and of all packages for those nested in them."""

    def __init__(self, search: DefinitionSearch, package: str, folder: Path) -> None:
        super().__init__()
        self._search = search
        self._package = package
        self._folder = folder

    def _find_message(self, name: str) -> MessageDefinition:
        package, _, short = name.partition("/")
        for folder in self._folders(package):
            for suffix in ACTION_SUFFIXES:
                base = short.removesuffix(suffix)
                if base != short and (path := _own_file(folder, "action", base)):
                    action = parser.parse_action(_text(path), package, base, str(path))
                    return next(each for each in action.messages() if each.type == name)
            if path := _own_file(folder, "msg", short):
                return parser.parse_message(_text(path), package, short, str(path))
        raise self._unknown("msg", package, short)

    def _find_service(self, name: str) -> ServiceDefinition:
        package, _, short = name.partition("/")
        for folder in self._folders(package):
            if path := _own_file(folder, "srv", short):
                return parser.parse_service(_text(path), package, short, str(path))
        raise self._unknown("srv", package, short)

    def _find_action(self, name: str) -> ActionDefinition:
        package, _, short = name.partition("/")
        for folder in self._folders(package):
            if path := _own_file(folder, "action", short):
                return parser.parse_action(_text(path), package, short, str(path))
        raise self._unknown("action", package, short)

    def _folders(self, package: str) -> Iterable[Path]:
        return [self._folder] if package == self._package else self._search.packages(package)

    def _unknown(self, kind: Kind, package: str, short: str) -> InterfaceError:
        if any(self._folders(package)):
            return UnknownType(kind, package, short, None)
        return UnknownPackage(package, None)


_KINDS: tuple[Kind, ...] = ("msg", "srv", "action")


def _read(definitions: Definitions, kind: Kind, name: str, path: Path) -> FoundDefinition:
    match kind:
        case "msg":
            return FoundDefinition(path, definitions.full_text(name), definitions.md5(name))
        case "srv":
            text, md5sum = definitions.service_text(name), definitions.service_md5(name)
            return FoundDefinition(path, text, md5sum)
        case "action":
            # An action's definition has no md5 of its own.
            return FoundDefinition(path, definitions.action_text(name), ANY)


def _file_of(folder: Path, kind: Kind, short: str) -> Path | None:
    """Return the file in a package's folder that defines a type; a message may be an action's."""
    if kind == "msg":
        for suffix in ACTION_SUFFIXES:
            base = short.removesuffix(suffix)
            if base != short and (path := _own_file(folder, "action", base)):
                return path
    return _own_file(folder, kind, short)


def _own_file(folder: Path, kind: Kind, short: str) -> Path | None:
    path = folder / kind / f"{short}.{kind}"
    return path if path.is_file() else None


def _text(path: Path) -> str:
    if path.stat().st_size > LONGEST_TEXT:
        raise InterfaceError(f"{path} is too long (limit is {LONGEST_TEXT} bytes)")
    return path.read_text("utf-8-sig", errors="replace")
