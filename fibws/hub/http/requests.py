"""HTTP requests on the hub's port: which WebSockets may open, and responses to plain requests.

Which web pages may open a WebSocket is decided in `fibws.origins`. A browser does not show a page
why its WebSocket was refused, so the page asks ``/origin``: the response says which origin the hub
sees, if it may connect, and which option lets it in. It says nothing that trying would not show, so
pages of any origin may read it.

The page at ``/``, its parts, ``/roslib.js`` and ``/roslib.mjs`` are files that the package's build
makes. They are read once, when the first hub of a process starts; a request's path never reaches
the file system.
"""

from __future__ import annotations

import email.utils
import hashlib
import http
import logging
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import resources
from importlib.resources.abc import Traversable
from threading import Lock
from typing import BinaryIO, TypeAlias
from urllib.parse import parse_qs

from pydantic_core import to_json
from websockets.datastructures import Headers, MultipleValuesError
from websockets.http11 import Request, Response

from fibws import names
from fibws.errors import InvalidName
from fibws.hub.access.authentication import Certificate
from fibws.hub.http.proxies import PROTO, is_secure
from fibws.hub.settings import KIB, Settings
from fibws.origins import AllowedOrigins, OwnHosts, WebOrigin, origin_of_url

logger = logging.getLogger("fibws.hub")

BUILT = resources.files("fibws").joinpath("hub", "page")

# The system's table of types, which the module mimetypes reads, may be wrong.
CONTENT_TYPES = {
    "css": "text/css",
    "html": "text/html",
    "ico": "image/vnd.microsoft.icon",
    "js": "text/javascript",
    "mjs": "text/javascript",
    "json": "application/json",
    "png": "image/png",
    "svg": "image/svg+xml",
    "txt": "text/plain",
    "woff2": "font/woff2",
}
PIECE = 256 * KIB
"""Bytes of a large file that are read at once."""
CODINGS = {"br": ".br", "gzip": ".gz"}
"""The codings in which the build packs files, the best first, and the suffixes that it adds."""

CONTENT_SECURITY_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' data:",
        "connect-src 'self' ws: wss: http: https:",
        "worker-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
        "require-trusted-types-for 'script'",
        "trusted-types fibws",
    )
)
"""The page's policy: nothing is loaded from other hosts, and no text becomes markup or script.

The page may connect to other hubs, whose ``/origin`` it asks why they refuse it.

``fibws`` is the page's only policy of Trusted Types, which lets its worker's address through.
"""

NOT_BUILT = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>fibws hub</title>
<h1>This is a fibws hub, without its page</h1>
<p>Nodes and other clients can connect. The page that shows the graph was not built when fibws was
installed. Install it again in its checkout, without <code>FIBWS_SKIP_PAGE</code>, and restart the
hub:</p>
<pre>python -m pip install -e .</pre>
<p>How the hub is doing is at <a href="healthz">healthz</a>.</p>
"""


@dataclass(frozen=True, slots=True)
class Get:
    """A GET request, or a HEAD request, whose response is the same without its body.

    Attributes:
        path: the request's target, with its query.
        address: the client's IP address; empty if it is unknown.
        certificate: the client's, which TLS has verified.
    """

    headers: Headers
    path: str = "/"
    address: str = ""
    certificate: Certificate | None = None


class FileResponse(Response):
    """A response whose body is a file, of which only a piece is in memory at a time.

    Args:
        file: open for reading; it is closed in the end.
        size: bytes to send.
        status: of the response; PARTIAL_CONTENT for a part of the file.
    """

    def __init__(
        self,
        headers: Headers,
        file: BinaryIO,
        size: int,
        status: http.HTTPStatus = http.HTTPStatus.OK,
    ) -> None:
        super().__init__(status, status.phrase, headers)
        self._file = file
        self.left = size
        """Bytes that are still to be read."""
        self._reading = Lock()
        self._is_closed = False

    def read(self) -> bytes:
        """Return the next piece, in any thread; nothing if the file is shorter than it was."""
        try:
            with self._reading:
                piece = self._file.read(min(PIECE, self.left))
        except (OSError, ValueError):  # It cannot be read, or has been closed.
            piece = b""
        self.left -= len(piece)
        if self._is_closed:
            self.close()
        return piece

    def close(self) -> None:
        """Close the file, at any time and without waiting: after the piece that is being read."""
        self._is_closed = True
        if self._reading.acquire(blocking=False):
            self._file.close()
            self._reading.release()


class DeferredResponse(Response):
    """A response that takes too long to make for the event loop; it is empty until `start` is done.

    Args:
        make: returns the response, in any thread.
        run: calls its first argument in a thread, and then the second one in the event loop.
        ended: called once the response is sent, or its connection lost.
    """

    def __init__(
        self,
        make: Callable[[], Response],
        run: Callable[[Callable[[], object], Callable[[], object]], object],
        ended: Callable[[], object] = lambda: None,
    ) -> None:
        super().__init__(http.HTTPStatus.OK, http.HTTPStatus.OK.phrase, Headers())
        self.has_body = True
        self._make = make
        self._run = run
        self._ended = ended
        self._send: Callable[[Response], object] | None = None
        """Takes the response; None once it is not wanted any more."""
        self._made: Response | None = None

    def start(self, send: Callable[[Response], object]) -> None:
        """Make the response, and give it to a function in the event loop, unless it has ended."""
        self._send = send
        self._run(self._work, self._done)

    def read_on(self, take: Callable[[bytes], object]) -> bool:
        """Read the next piece of a file, and give it to a function in the event loop.

        Args:
            take: gets nothing if the file cannot be read.

        Returns:
            Whether there is one.
        """
        made = self._made
        if not isinstance(made, FileResponse) or not self.has_body or not made.left:
            return False
        pieces: list[bytes] = []

        def done() -> None:
            if self._send is not None:
                take(pieces[0])

        self._run(lambda: pieces.append(made.read()), done)
        return True

    def end(self) -> None:
        """Forget the response."""
        self._send = None  # First: a thread that makes it meanwhile closes it.
        made, self._made = self._made, None
        if isinstance(made, FileResponse):
            made.close()
        self._ended()

    def _work(self) -> None:
        if self._send is None:
            return
        try:
            self._keep(self._make())
        except Exception:
            logger.exception("A response could not be made.")
            fault = "The hub failed; its log says why"
            self._keep(text_response(http.HTTPStatus.INTERNAL_SERVER_ERROR, fault))

    def _keep(self, made: Response) -> None:
        self._made = made
        if self._send is None and isinstance(made, FileResponse):  # It ended meanwhile.
            made.close()

    def _done(self) -> None:
        if self._send is not None and self._made is not None:
            if not self.has_body:
                self._made.body = b""
            self._send(self._made)


Route: TypeAlias = Callable[[Get], Response]
"""Responds to a GET request."""


class HttpRequests:
    """Responds to the requests that reach the hub's port.

    Args:
        files: the files that a browser may fetch, as of `built_files`.
        reserved: names of nodes that no client may take.
        refused: takes the reason and the client's address whenever a page's origin, or a name of
            the hub, is refused: a browser does not show its page why.
    """

    def __init__(
        self,
        settings: Settings,
        files: Mapping[str, bytes],
        reserved: Collection[str] = (),
        refused: Callable[[str, str], object] = lambda reason, address: None,
    ) -> None:
        self._base = settings.base_path
        self._origins = AllowedOrigins(settings.allow_origin, OwnHosts([settings.host]))
        self._reserved = reserved
        self._refused = refused
        self._closed = ""
        """Why no WebSocket may open any more."""
        self._routes: dict[str, Route] = {"/": _respond_not_built, "/origin": self._describe_origin}
        self._folders: dict[str, Route] = {}
        for path, content in files.items():
            if not path.endswith(tuple(CODINGS.values())):
                self._routes[f"/{path}"] = PageFile(path, content, packed(files, path)).respond
        if "/index.html" in self._routes:
            self._routes["/"] = self._routes.pop("/index.html")

    def add(self, path: str, respond: Callable[[], bytes], content_type: str) -> None:
        """Add a resource that only hosts and origins known to be the hub's may read.

        Args:
            path: of its URL.
            respond: returns the body.
        """

        def route(get: Get) -> Response:
            refusal = self.host_refusal(get)
            if refusal is None:
                return response(http.HTTPStatus.OK, content_type, respond())
            self._refused(refusal, get.address)
            return text_response(http.HTTPStatus.FORBIDDEN, refusal)

        self.add_route(path, route)

    def add_route(self, path: str, route: Route) -> None:
        """Add a resource that decides itself who may read it."""
        self._routes[path] = route

    def add_folder(self, path: str, route: Route) -> None:
        """Add all resources below a path, which ends in ``/``; others may be at paths in it."""
        self._folders[path] = route

    def refuse_websockets(self, reason: str) -> None:
        """Let no WebSocket open from now on; plain requests still get their responses.

        Args:
            reason: a sentence without its full stop.
        """
        self._closed = reason

    def is_deliberate(self, headers: Headers) -> bool:
        """Return whether a request counts against its address.

        Any web page can have its visitor's browser send the others.
        """
        try:
            if headers.get("Upgrade", "").lower() == "websocket":
                return self._page_refusal(headers) is None
        except MultipleValuesError:
            return True  # No browser sends that.
        return "Authorization" in headers

    def respond(
        self, request: Request, address: str = "", certificate: Certificate | None = None
    ) -> Response | None:
        """Return the response to a plain or refused request; None if a WebSocket may open.

        Args:
            address: the client's IP address.
            certificate: the client's.
        """
        try:
            host = request.headers.get("Host")
            if host is not None and WebOrigin.of_host("http", host) is None:
                return text_response(http.HTTPStatus.BAD_REQUEST, "Invalid header Host")
            if self._base and (elsewhere := self._enter_base(request)) is not None:
                return elsewhere
            upgrade = request.headers.get("Upgrade", "").lower()
            if not upgrade and "Sec-WebSocket-Key" in request.headers:
                return _respond_without_upgrade()
            if upgrade != "websocket":
                get = Get(request.headers, request.path, address, certificate)
                return self._respond_to_plain(request.method, get)
            if self._closed:
                return text_response(http.HTTPStatus.SERVICE_UNAVAILABLE, self._closed)
            refusal = self._page_refusal(request.headers)
            if refusal is not None:
                self._refused(refusal, address)
                return text_response(http.HTTPStatus.FORBIDDEN, refusal)
            if node_name(request.path) in self._reserved:
                fault = "that name is the hub's own; choose another"
                return text_response(http.HTTPStatus.BAD_REQUEST, f"The query's node: {fault}")
        except MultipleValuesError as error:
            return text_response(http.HTTPStatus.BAD_REQUEST, f"More than one header {error}")
        except InvalidName as error:
            return text_response(http.HTTPStatus.BAD_REQUEST, f"The query's node: {error}")
        return None

    def _enter_base(self, request: Request) -> Response | None:
        """Take the hub's own path off the request's; return the response if it is another one.

        A page must be below ``/robot/``, so that its relative URLs are; a WebSocket need not.
        """
        path, _, query = request.path.partition("?")
        if path == self._base and request.headers.get("Upgrade", "").lower() != "websocket":
            found = text_response(http.HTTPStatus.TEMPORARY_REDIRECT, f"See {self._base}/")
            last = self._base.rpartition("/")[2]  # A proxy may have put a path before it.
            found.headers["Location"] = f"{last}/{f'?{query}' if query else ''}"
            return found
        if path != self._base and not path.startswith(f"{self._base}/"):
            fault = f"Nothing is at {path}; this hub is at {self._base}/"
            return text_response(http.HTTPStatus.NOT_FOUND, fault)
        request.path = request.path.removeprefix(self._base)
        if not request.path.startswith("/"):
            request.path = f"/{request.path}"
        return None

    def _respond_to_plain(self, method: str, get: Get) -> Response:
        if method == "OPTIONS" and self._folder_of(get.path) is not None:
            return self._permit(get)
        if method not in ("GET", "HEAD"):
            fault = "Only GET and HEAD are answered"
            refusal = text_response(http.HTTPStatus.METHOD_NOT_ALLOWED, fault)
            refusal.headers["Allow"] = "GET, HEAD"
            return refusal
        path = get.path.partition("?")[0]
        route = self._routes.get(path) or self._folder_of(path)
        if route is None:
            fault = f"Nothing is at {path}; see {self._base}/"
            found = text_response(http.HTTPStatus.NOT_FOUND, fault)
        else:
            found = route(get)
        if method == "HEAD":
            if isinstance(found, DeferredResponse):
                found.has_body = False
            else:
                found.body = b""
        return found

    def _permit(self, get: Get) -> Response:
        """Answer a browser that asks if a page may send its token to a folder (CORS preflight)."""
        refusal = self.refusal(get)
        if refusal is not None:
            return text_response(http.HTTPStatus.FORBIDDEN, refusal)
        found = response(http.HTTPStatus.NO_CONTENT)
        found.headers["Vary"] = "Origin"
        if (origin := get.headers.get("Origin")) is not None:
            found.headers["Access-Control-Allow-Origin"] = origin
            found.headers["Access-Control-Allow-Headers"] = "Authorization"
            found.headers["Access-Control-Max-Age"] = "600"
        return found

    def _folder_of(self, path: str) -> Route | None:
        for folder, route in self._folders.items():
            if path.startswith(folder):
                return route
        return None

    def refusal(self, get: Get) -> str | None:
        """Return why a page may not read what it could learn by a WebSocket; None if it may.

        Raises:
            MultipleValuesError: a header is repeated.
        """
        return self._page_refusal(get.headers) or self.host_refusal(get)

    def _page_refusal(self, headers: Headers) -> str | None:
        """Return why the page that sends a request may not open a WebSocket; None if it may."""
        origin = headers.get("Origin")
        return self._refusal_of(origin, headers) if origin is not None else None

    def _refusal_of(self, origin: str, headers: Headers) -> str | None:
        """Return why a page of an origin may not connect, and what lets it in."""
        host = headers.get("Host", "")
        fault = self._origins.refusal_of(origin, host, is_secure(headers))
        advice = f"Start the hub with --allow-origin {origin} to let them in"
        return fault and f"{fault}. {advice}"

    def host_refusal(self, get: Get) -> str | None:
        """Return why a request with this Host header is refused (DNS rebinding), or None."""
        host = get.headers.get("Host", "localhost")
        if self._origins.knows_host(host, secure=is_secure(get.headers)):
            return None
        scheme = get.headers.get(PROTO, "http")
        return (
            f"{host} is not known to be this hub's name. "
            f"Start it with --allow-origin {scheme}://{host}"
        )

    def _describe_origin(self, get: Get) -> Response:
        """Respond with the origin that the hub sees, and whether its pages may connect.

        A browser names the origin in ``Origin`` if the request goes to another one, and in
        ``Referer`` if the page asks it to.
        """
        headers = get.headers
        origin = headers.get("Origin") or origin_of_url(headers.get("Referer", ""))
        refusal = origin and self._refusal_of(origin, headers)
        body = {
            "origin": origin,
            "allowed": not refusal,
            "reason": refusal or "",
            "option": f"--allow-origin {origin}" if refusal else "",
        }
        found = response(http.HTTPStatus.OK, "application/json", to_json(body))
        found.headers["Cache-Control"] = "no-store"
        found.headers["Access-Control-Allow-Origin"] = "*"
        return found


class PageFile:
    """A file, and how it is sent.

    Args:
        path: relative to the built folder. The name of a file in ``assets/`` holds a digest of its
            content, so that it may be cached for ever.
        packed: the content in the codings in which the build has packed it.
    """

    def __init__(self, path: str, content: bytes, packed: Mapping[str, bytes]) -> None:
        self._content = content
        self._packed = packed
        suffix = path.rpartition(".")[2]
        self._content_type = CONTENT_TYPES.get(suffix, "application/octet-stream")
        forever = path.startswith("assets/")
        self._headers = {
            "Cache-Control": "public, max-age=31536000, immutable" if forever else "no-cache",
            "Content-Security-Policy": CONTENT_SECURITY_POLICY,
            "Referrer-Policy": "no-referrer",
            "Vary": "Accept-Encoding",
        }
        if path in ("roslib.js", "roslib.mjs"):  # Other sites' pages may load it, too.
            self._headers["Access-Control-Allow-Origin"] = "*"
            self._headers["Cross-Origin-Resource-Policy"] = "cross-origin"

    @cached_property
    def _etag(self) -> str:
        return f'W/"{hashlib.sha256(self._content).hexdigest()[:32]}"'

    def respond(self, get: Get) -> Response:
        """Return the response to a request."""
        headers = get.headers
        if self._is_cached(headers):
            found = response(http.HTTPStatus.NOT_MODIFIED)
        elif coding := next((each for each in self._packed if accepts(headers, each)), None):
            found = response(http.HTTPStatus.OK, self._content_type, self._packed[coding])
            found.headers["Content-Encoding"] = coding
        else:
            found = response(http.HTTPStatus.OK, self._content_type, self._content)
        found.headers.update(self._headers, ETag=self._etag)
        return found

    def _is_cached(self, headers: Headers) -> bool:
        known = ",".join(headers.get_all("If-None-Match"))
        return any(tag.strip() in (self._etag, "*") for tag in known.split(","))


def packed(files: Mapping[str, bytes], path: str) -> dict[str, bytes]:
    """Return the content of a file in the codings that there are, by name, the best first."""
    names = {coding: path + suffix for coding, suffix in CODINGS.items()}
    return {coding: files[name] for coding, name in names.items() if name in files}


@cache
def built_files() -> Mapping[str, bytes]:
    """Return the files of the page; they are read once by each process."""
    return read_files(BUILT)


def read_files(folder: Traversable) -> dict[str, bytes]:
    """Return the files in a folder and those below it, by their paths; none without a folder.

    Hidden files are left out: the build keeps one that a browser does not need.
    """
    if not folder.is_dir():
        return {}
    files: dict[str, bytes] = {}
    for child in folder.iterdir():
        if child.name.startswith("."):
            continue
        if child.is_dir():
            files |= {f"{child.name}/{path}": found for path, found in read_files(child).items()}
        else:
            files[child.name] = child.read_bytes()
    return files


def node_name(path: str) -> str | None:
    """Return the global node name in the query of a URL, as in ``/?node=/talker``.

    Raises:
        InvalidName: it cannot be a name: it is private, empty, or not UTF-8, or has whitespace.
    """
    query = path.partition("?")[2]
    values = parse_qs(query, keep_blank_values=True, errors="surrogateescape").get("node")
    if not values:
        return None
    if values[0].startswith("~"):
        raise InvalidName(values[0], "a node's own name cannot be private")
    return names.resolve_any(values[0])


def response(
    status: http.HTTPStatus, content_type: str | None = None, body: bytes = b""
) -> Response:
    """Return a response, which ends its connection; a browser may not guess the content's type.

    Args:
        content_type: of the body, such as ``text/plain``; None if the status allows no body.
    """
    headers = Headers(
        {
            "Date": email.utils.formatdate(usegmt=True),
            "Connection": "close",
            "X-Content-Type-Options": "nosniff",
        }
    )
    if content_type is not None:
        text = content_type.startswith("text/") or content_type == "application/json"
        text = text and "charset" not in content_type
        headers["Content-Type"] = f"{content_type}; charset=utf-8" if text else content_type
        headers["Content-Length"] = str(len(body))
    return Response(status.value, status.phrase, headers, body)


def text_response(status: http.HTTPStatus, text: str) -> Response:
    """Return a response of one sentence, which is given without its full stop."""
    return response(status, "text/plain", f"{text}.\n".encode())


def _respond_without_upgrade() -> Response:
    """Respond to a WebSocket's handshake that a proxy has made a plain request."""
    fault = (
        "This WebSocket handshake has no header Upgrade; a proxy before the hub must pass on "
        "the headers Upgrade and Connection"
    )
    found = text_response(http.HTTPStatus.UPGRADE_REQUIRED, fault)
    found.headers["Upgrade"] = "websocket"
    return found


def _respond_not_built(get: Get) -> Response:
    found = response(http.HTTPStatus.SERVICE_UNAVAILABLE, "text/html", NOT_BUILT.encode())
    found.headers["Cache-Control"] = "no-store"
    found.headers["Content-Security-Policy"] = CONTENT_SECURITY_POLICY
    return found


def accepts(headers: Headers, coding: str) -> bool:
    """Return whether Accept-Encoding names a coding, not with the weight 0, which forbids it."""
    for each in ",".join(headers.get_all("Accept-Encoding")).lower().split(","):
        name, _, weight = "".join(each.split()).partition(";")
        if name == coding:
            # Of weights, only 0 has no other digit: q=0, q=0.000.
            return not weight or weight.strip("q=0.") != ""
    return False
