"""What a browser may fetch from the hub: the page at ``/``, its parts, and ``/roslib.js``.

The package's build makes these files. They are read once, at the hub's start, and what a client
asks for is looked up among them: its paths never reach the file system.
"""

from __future__ import annotations

import gzip
import hashlib
import http
from collections.abc import Mapping
from functools import cached_property
from importlib import resources
from importlib.resources.abc import Traversable

from websockets.datastructures import Headers
from websockets.http11 import Response

from fibws.hub.response import respond

BUILT = resources.files("fibws").joinpath("web", "dist")

# The system's own table of types, which the module mimetypes reads, may be anything.
CONTENT_TYPES = {
    "css": "text/css",
    "html": "text/html",
    "ico": "image/vnd.microsoft.icon",
    "js": "text/javascript",
    "json": "application/json",
    "png": "image/png",
    "svg": "image/svg+xml",
    "txt": "text/plain",
    "woff2": "font/woff2",
}
COMPRESSED = {"png", "woff2"}
"""Kinds of files that gzip cannot make smaller."""

POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' data:",
        "connect-src 'self' ws: wss:",
        "worker-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
        "require-trusted-types-for 'script'",
        "trusted-types fibws",
    )
)
"""What the page may do: nothing is loaded from elsewhere, and no text becomes markup or script.

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
<p>Nodes and other clients can connect. The page that shows the graph has not been built in this
checkout. Build it there, and start the hub again:</p>
<pre>python -m pip install -e .</pre>
<p>How the hub is doing is at <a href="healthz">healthz</a>.</p>
"""


class Pages:
    """The files that the build has made, by the path of their URL.

    Args:
        files: their contents by their path, as `read` gives them. Without ``index.html``, ``/``
            tells how to build the page.
    """

    def __init__(self, files: Mapping[str, bytes]) -> None:
        self._pages = {f"/{path}": Page(path, content) for path, content in files.items()}
        index = self._pages.pop("/index.html", None)
        if index is not None:
            self._pages["/"] = index

    def answer(self, path: str, headers: Headers) -> Response | None:
        """The response to a request for a path without its query; None if nothing is there."""
        page = self._pages.get(path)
        if page is not None:
            return page.answer(headers)
        if path == "/":
            response = respond(http.HTTPStatus.SERVICE_UNAVAILABLE, "text/html", NOT_BUILT.encode())
            response.headers["Cache-Control"] = "no-store"
            response.headers["Content-Security-Policy"] = POLICY
            return response
        return None


class Page:
    """One file and how it is sent.

    Args:
        path: relative to the built folder. What is in ``assets/`` has a digest of its content in
            its name, and may be kept for ever.
    """

    def __init__(self, path: str, content: bytes) -> None:
        self._content = content
        suffix = path.rpartition(".")[2]
        self._compressible = suffix not in COMPRESSED
        self._content_type = CONTENT_TYPES.get(suffix, "application/octet-stream")
        self._etag = f'W/"{hashlib.sha256(content).hexdigest()[:32]}"'
        forever = path.startswith("assets/")
        self._headers = {
            "Cache-Control": "public, max-age=31536000, immutable" if forever else "no-cache",
            "Content-Security-Policy": POLICY,
            "ETag": self._etag,
            "Referrer-Policy": "no-referrer",
            "Vary": "Accept-Encoding",
        }
        if path == "roslib.js":  # It is for the pages of others, too.
            self._headers["Access-Control-Allow-Origin"] = "*"
            self._headers["Cross-Origin-Resource-Policy"] = "cross-origin"

    def answer(self, headers: Headers) -> Response:
        """The response to a request that has these headers."""
        if self._is_known(headers):
            response = respond(http.HTTPStatus.NOT_MODIFIED)
        elif self._compressible and _accepts_gzip(headers):
            response = respond(http.HTTPStatus.OK, self._content_type, self._zipped)
            response.headers["Content-Encoding"] = "gzip"
        else:
            response = respond(http.HTTPStatus.OK, self._content_type, self._content)
        response.headers.update(self._headers)
        return response

    @cached_property
    def _zipped(self) -> bytes:
        return gzip.compress(self._content, 6, mtime=0)

    def _is_known(self, headers: Headers) -> bool:
        known = ",".join(headers.get_all("If-None-Match"))
        return any(tag.strip() in (self._etag, "*") for tag in known.split(","))


def read(folder: Traversable = BUILT) -> dict[str, bytes]:
    """The files in a folder and those below it, by their path; none if there is no such folder.

    Hidden files are left out: the build keeps one that is of no use to a browser.
    """
    if not folder.is_dir():
        return {}
    files: dict[str, bytes] = {}
    for child in folder.iterdir():
        if child.name.startswith("."):
            continue
        if child.is_dir():
            files |= {f"{child.name}/{path}": content for path, content in read(child).items()}
        else:
            files[child.name] = child.read_bytes()
    return files


def _accepts_gzip(headers: Headers) -> bool:
    """Whether Accept-Encoding names gzip, and not with the weight 0, which forbids it."""
    for coding in ",".join(headers.get_all("Accept-Encoding")).lower().split(","):
        name, _, weight = "".join(coding.split()).partition(";")
        if name == "gzip":
            # Of weights, only 0 has no other digit: q=0, q=0.000.
            return not weight or weight.strip("q=0.") != ""
    return False
