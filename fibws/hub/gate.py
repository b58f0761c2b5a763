"""The gate: who may come in, and what is answered to those who only speak HTTP.

A web page may speak to the hub only if its origin names a host that the hub is known by: its own
``Host`` header is no proof, since a page of a stranger's can give its name this machine's address
(DNS rebinding). Programs other than browsers send no origin and may come in.
"""

from __future__ import annotations

import http
import ipaddress
from collections.abc import Callable
from urllib.parse import parse_qs, urlsplit

from pydantic_core import to_json
from websockets.datastructures import Headers, MultipleValuesError
from websockets.http11 import Request, Response

from fibws import names
from fibws.errors import InvalidName
from fibws.hub.pages import Pages
from fibws.hub.response import respond, respond_text
from fibws.hub.rosapi.nodes import OWN_NODES
from fibws.hub.settings import Settings

Health = Callable[[], dict[str, object]]


class Gate:
    """Answers the requests that reach the hub's port.

    Args:
        pages: what a browser may fetch.
        health: gives what ``/healthz`` shows.
    """

    def __init__(self, settings: Settings, pages: Pages, health: Health) -> None:
        self._origins = frozenset(origin.rstrip("/").lower() for origin in settings.allow_origin)
        self._host = settings.host.lower()
        self._pages = pages
        self._health = health

    def answer(self, request: Request) -> Response | None:
        """The response to a plain or refused request; None if a WebSocket may open."""
        try:
            if request.headers.get("Upgrade", "").lower() != "websocket":
                return self._resource(request)
            refusal = self._refusal(request.headers)
            if refusal is not None:
                return respond_text(http.HTTPStatus.FORBIDDEN, refusal)
            if node_name(request.path) in OWN_NODES:
                fault = "that name is the hub's own; choose another"
                return respond_text(http.HTTPStatus.BAD_REQUEST, f"The query's node: {fault}")
        except MultipleValuesError as error:
            return respond_text(http.HTTPStatus.BAD_REQUEST, f"More than one header {error}")
        except InvalidName as error:
            return respond_text(http.HTTPStatus.BAD_REQUEST, f"The query's node: {error}")
        return None

    def _resource(self, request: Request) -> Response:
        if request.method not in ("GET", "HEAD"):
            fault = "Only GET and HEAD are answered"
            response = respond_text(http.HTTPStatus.METHOD_NOT_ALLOWED, fault)
            response.headers["Allow"] = "GET, HEAD"
            return response
        path = request.path.partition("?")[0]
        if path == "/healthz":
            response = self._health_response(request.headers)
        else:
            nothing = f"Nothing is at {path}; see /"
            response = self._pages.answer(path, request.headers) or respond_text(
                http.HTTPStatus.NOT_FOUND, nothing
            )
        if request.method == "HEAD":
            response.body = b""
        return response

    def _health_response(self, headers: Headers) -> Response:
        """What the hub does is not for pages that gave its address a name of their own."""
        host = headers.get("Host", "localhost")
        here = _host_of(f"//{host}")
        allowed = "*" in self._origins or f"http://{host}".lower() in self._origins
        if not allowed and (here is None or not self._known(here, here)):
            fault = f"{host} is not known to be this hub's name"
            return respond_text(
                http.HTTPStatus.FORBIDDEN, f"{fault}. Start it with --allow-origin http://{host}"
            )
        return respond(http.HTTPStatus.OK, "application/json", to_json(self._health()))

    def _refusal(self, headers: Headers) -> str | None:
        origin = headers.get("Origin")
        if origin is None or "*" in self._origins or origin.lower() in self._origins:
            return None
        page, here = _host_of(origin), _host_of(f"//{headers.get('Host', '')}")
        if page is None or not self._known(page, here):
            fault = f"Pages of origin {origin} may not connect"
        elif here is None or not self._known(here, here):
            fault = f"Pages may not connect by the name {here}, which is not known to be the hub's"
        else:
            return None
        return f"{fault}. Start the hub with --allow-origin {origin} to let them in"

    def _known(self, host: str, dialled: str | None) -> bool:
        """Whether a name is the hub's; an address that was dialled cannot be a rebound name."""
        if host in ("localhost", self._host) or host.endswith(".localhost"):
            return True
        try:
            address = ipaddress.ip_address(host)
        except ValueError:
            return False
        return address.is_loopback or host == dialled


def node_name(path: str) -> str | None:
    """The global node name in the query of a URL, as in ``/?node=/talker``.

    Raises:
        InvalidName: it is not a legal graph name.
    """
    values = parse_qs(path.partition("?")[2], keep_blank_values=True).get("node")
    if not values:
        return None
    if values[0].startswith("~"):
        raise InvalidName(values[0], "a node's own name cannot be private")
    return names.resolve(values[0])


def _host_of(origin: str) -> str | None:
    try:
        return urlsplit(origin).hostname
    except ValueError:
        return None
