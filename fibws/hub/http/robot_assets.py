"""The files of robots: meshes and pictures of the packages that a robot's description names.

A robot's description names its meshes by URIs such as ``package://my_robot/meshes/arm.stl``, which
only a machine with the package can open. ``GET /assets/package/my_robot/meshes/arm.stl`` reads them
for the hub's page.

Whoever may set a robot's description decides which packages are open, and nobody else; so only
files of the kinds in `CONTENT_TYPES` are, of packages with a package.xml.
"""

from __future__ import annotations

import http
import re
import stat
import zlib
from collections.abc import Callable, Collection, Mapping
from functools import partial
from heapq import nsmallest
from pathlib import Path
from typing import TypeAlias
from urllib.parse import unquote

from pydantic_core import to_json
from websockets.datastructures import Headers
from websockets.http11 import Response

from fibws.access.rights import Principal, Right
from fibws.hub.access.authentication import Authentication
from fibws.hub.errors import AssetRefused
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.http.file_route import FileRoute
from fibws.hub.http.requests import Get, HttpRequests, accepts, response
from fibws.hub.log.audit import Audit
from fibws.hub.memory.byte_room import ByteRoom, Reservation
from fibws.hub.package_folders import MANIFEST, PackageFolders, name_of
from fibws.hub.settings import MIB
from fibws.hub.worker_threads import WorkerThreads

DESCRIPTION = "/robot_description"
"""The end of the names of parameters and topics with robots' descriptions."""
STRING = "std_msgs/String"
SCHEME = "package://"
CONTENT_TYPES = {
    ".stl": "model/stl",
    ".dae": "model/vnd.collada+xml",
    ".obj": "model/obj",
    ".mtl": "model/mtl",
    ".png": "image/png",
    ".jpg": "image/jpeg",
    ".jpeg": "image/jpeg",
}
"""The files that are served, by their suffixes in lower case."""
COMPRESSED = {".jpeg", ".jpg", ".png"}
"""The suffixes of files that gzip cannot make smaller."""
LARGEST = 64 * MIB
MOST_UNSENT = 2 * LARGEST
"""Bytes of files that may be on their way to clients at once."""
LONGEST_URI = 2000
MOST_SHOWN = 20
"""Packages that a refusal names: a description may name a million."""
QUICK = 1
"""zlib's level, at which 10 MB take 0.08 s; level 6 saves a tenth more, in 0.2 to 0.4 s."""

Allows: TypeAlias = Callable[[Right, str], bool]
"""Returns whether a client may use a name."""

_URI = re.compile(rb"package://([A-Za-z][\w-]*)/", re.ASCII)
_PACKAGE = re.compile(r"[A-Za-z][\w-]*", re.ASCII)
_PREFIXES = ("CMAKE_PREFIX_PATH", "AMENT_PREFIX_PATH")


class RobotAssets:
    """Finds the files of the robots whose descriptions are loaded.

    A description is a parameter, or the latched message of a topic of std_msgs/String, whose name
    ends in ``/robot_description``.

    Args:
        environment: has the variables that name folders of packages, as `PackageFolders`.
    """

    def __init__(self, graph: Graph, environment: Mapping[str, str]) -> None:
        self._graph = graph
        self._packages = PackageFolders(environment, _PREFIXES)
        self._parameters: dict[str, frozenset[str]] | None = None
        """The packages that parameters name; None after a parameter has changed."""
        graph.parameters.watch(self._forget)

    def named(self, allows: Allows) -> frozenset[str]:
        """Return the packages in the descriptions that a client may read, in the event loop."""
        graph = self._graph
        if self._parameters is None:
            names = [each for each in graph.parameters.names() if each.endswith(DESCRIPTION)]
            self._parameters = {name: _packages_in(graph.parameters.text(name)) for name in names}
        found = frozenset[str]()
        for name, packages in self._parameters.items():
            if allows("param_read", name):
                found |= packages
        for name, topic in graph.topics.items():
            if name.endswith(DESCRIPTION) and allows("subscribe", name):
                for source in topic.publishers.values():
                    latched = source.recall() if source.type.name == STRING else None
                    if latched is not None:
                        found |= latched.cached("packages", partial(_packages_of, latched))
        return found

    def resolve(self, uri: str, named: Collection[str]) -> Path:
        """Return the file that a URI names, in any thread.

        Args:
            uri: ``package://PACKAGE/PATH``; the path may be percent-encoded.
            named: the packages whose files may be read, from `named`.

        Raises:
            AssetRefused: there is no such file, or it is not to be served.
        """
        if not uri.startswith(SCHEME) or len(uri) > LONGEST_URI:
            raise AssetRefused(f"expected {SCHEME}PACKAGE/PATH, got {uri[:200]}")
        package, _, path = unquote(uri.removeprefix(SCHEME)).partition("/")
        parts = path.split("/")
        if not _PACKAGE.fullmatch(package) or not all(map(_is_plain, parts)):
            raise AssetRefused(f"invalid address of a file: {uri}")
        _check_suffix(parts[-1])
        if package not in named:
            raise AssetRefused(_why_not_named(package, named))
        folders = [each for each in self._packages.find(package) if (each / MANIFEST).is_file()]
        if not folders:
            raise AssetRefused(
                f"package {package} was not found on the hub's machine; start the hub where its "
                "workspace is set up (ROS_PACKAGE_PATH)"
            )
        for folder in folders:
            file = folder.joinpath(*parts)
            if file.is_file():
                return _checked(file, folder, package)
        raise AssetRefused(f"package {package} has no file {path} on the hub's machine")

    def _forget(self, name: str, node: str) -> None:
        self._parameters = None


def _packages_in(text: bytes | bytearray | memoryview) -> frozenset[str]:
    return frozenset(each.decode() for each in _URI.findall(text))


def _packages_of(publication: Publication) -> frozenset[str]:
    return _packages_in(publication.ros1())


def _is_plain(part: str) -> bool:
    """Return whether a part of a path leads down to a file or a folder that is not hidden."""
    return part != "" and not part.startswith(".") and not any(each in part for each in "\\\0")


def _check_suffix(name: str) -> None:
    suffix = Path(name).suffix.lower()
    if suffix not in CONTENT_TYPES:
        raise AssetRefused(
            f"files of the kind {suffix or name!r} are not served, only {' '.join(CONTENT_TYPES)}"
        )


def _why_not_named(package: str, named: Collection[str]) -> str:
    if not named:
        return f"no robot_description is loaded that names {SCHEME}{package}/"
    others = ", ".join(nsmallest(MOST_SHOWN, named))
    more = " and others" if len(named) > MOST_SHOWN else ""
    return f"package {package} is not in the loaded robot_description, which names {others}{more}"


def _checked(file: Path, folder: Path, package: str) -> Path:
    """Return a file without symbolic links, which must be in its package and not too large."""
    real = file.resolve()
    if not real.is_relative_to(folder.resolve()) and not _is_of(real, package):
        raise AssetRefused(f"{file.name} is a link to a file that is not in package {package}")
    _check_suffix(real.name)
    size = real.stat().st_size
    if size > LARGEST:
        raise AssetRefused(f"{file.name} is too large: {size} bytes (limit {LARGEST})")
    return real


def _is_of(file: Path, package: str) -> bool:
    """Return whether a file is in a source folder of a package.

    ``colcon build --symlink-install`` installs links to these.
    """
    for folder in file.parents:
        if (folder / MANIFEST).is_file():
            return name_of(folder) == package
    return False


class AssetRoute(FileRoute):
    """``/assets/package/``.

    Who may read a robot's description may read its files: pages that may open a WebSocket, with
    the same token. Refusals are 404, with ``{"reason": "..."}``. The threads compress the files,
    too.
    """

    PATH = "/assets/package/"

    def __init__(
        self,
        requests: HttpRequests,
        assets: RobotAssets,
        authentication: Authentication | None,
        threads: WorkerThreads,
        room: ByteRoom,
        audit: Audit,
    ) -> None:
        self._assets = assets
        super().__init__(requests, authentication, threads, room, audit)

    def _find(
        self, get: Get, path: str, principal: Principal | None, reservation: Reservation
    ) -> Callable[[], Response]:
        named = self._assets.named(principal.rights.allows if principal is not None else _allow)
        return partial(self._make, f"{SCHEME}{path}", named, get.headers, reservation)

    def _refusal(self, status: http.HTTPStatus, reason: str) -> Response:
        found = response(status, "application/json", to_json({"reason": reason}))
        found.headers["Cache-Control"] = "no-store"
        return found

    def _completed(self, found: Response, get: Get) -> Response:
        return _shared(found, get.headers.get("Origin"))

    def _make(
        self, uri: str, named: Collection[str], headers: Headers, download: Reservation
    ) -> Response:
        try:
            found = self._read(self._assets.resolve(uri, named), headers, download)
        except AssetRefused as error:
            found = self._refusal(http.HTTPStatus.NOT_FOUND, str(error))
        except OSError as error:
            found = self._refusal(
                http.HTTPStatus.NOT_FOUND, f"the hub cannot read it: {error.strerror}"
            )
        return _shared(found, headers.get("Origin"))

    def _read(self, path: Path, headers: Headers, download: Reservation) -> Response:
        with path.open("rb") as file:
            info = path.stat()
            if not stat.S_ISREG(info.st_mode):
                raise AssetRefused(f"{path.name} is not a file")
            if info.st_size > self._room.size:
                raise AssetRefused(
                    f"{path.name} is too large: {info.st_size} bytes (limit {self._room.size}, "
                    "an eighth of --max-memory)"
                )
            etag = f'W/"{info.st_mtime_ns:x}-{info.st_size:x}"'
            known = ",".join(headers.get_all("If-None-Match"))
            if any(tag.strip() in (etag, "*") for tag in known.split(",")):
                found = response(http.HTTPStatus.NOT_MODIFIED)
            elif not download.reserve(info.st_size):
                return self._busy()
            else:
                found = _content(path.suffix.lower(), file.read(info.st_size), headers)
        found.headers["Cache-Control"] = "no-cache"
        found.headers["ETag"] = etag
        return found


def _content(suffix: str, data: bytes, headers: Headers) -> Response:
    is_zipped = suffix not in COMPRESSED and accepts(headers, "gzip")
    if is_zipped:
        data = zlib.compress(data, QUICK, zlib.MAX_WBITS | 16)
    found = response(http.HTTPStatus.OK, CONTENT_TYPES[suffix], data)
    if is_zipped:
        found.headers["Content-Encoding"] = "gzip"
    return found


def _allow(right: Right, name: str) -> bool:
    return True


def _shared(found: Response, origin: str | None) -> Response:
    """Let the page of an allowed origin read a response, and no other."""
    found.headers["Content-Security-Policy"] = "default-src 'none'; sandbox"
    found.headers["Vary"] = "Accept-Encoding, Origin"
    found.headers["Cross-Origin-Resource-Policy"] = "cross-origin" if origin else "same-origin"
    if origin:
        found.headers["Access-Control-Allow-Origin"] = origin
    return found
