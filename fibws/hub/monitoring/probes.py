"""The resources that watch a hub: /livez, /readyz, /healthz and /metrics, and who may read them.

Anybody may ask whether the hub lives and is ready: load balancers and Kubernetes do. Names of
nodes and topics, addresses and numbers are for those with the right ``admin``; on a hub without
authentication, for this machine. ``--public-metrics`` opens them to all.
"""

from __future__ import annotations

import http
import ipaddress
from collections.abc import Callable, Mapping
from typing import NamedTuple

from pydantic_core import to_json
from websockets.http11 import Response

from fibws import __version__
from fibws.errors import AuthenticationError
from fibws.hub.access.authentication import Authentication
from fibws.hub.http.proxies import FOR, FORWARDED
from fibws.hub.http.requests import Get, HttpRequests, response, text_response
from fibws.hub.log.audit import Audit, Reason
from fibws.hub.monitoring.loop_lag import LoopLag
from fibws.hub.settings import Settings

LONGEST_LAG = 1.0
"""Seconds by which the event loop of a hub that lives may be late."""
PROXIED = (FOR, FORWARDED, "X-Real-IP", "Via")
"""Headers that a proxy adds: the client is not the machine that the request comes from."""
JSON = "application/json"


class ProbeRefusal(NamedTuple):
    """Why a request may not read something.

    Attributes:
        text: a sentence without its full stop.
        principal: who has sent the request, if that is known.
    """

    reason: Reason
    text: str
    principal: str = ""


class Watchers:
    """Decides who may read what is not for everybody.

    Args:
        authentication: None on a hub without authentication.
        host_refusal: returns why a request is refused that reached the hub by a name which is not
            known to be its own; None for others.
    """

    def __init__(
        self,
        settings: Settings,
        authentication: Authentication | None,
        audit: Audit,
        host_refusal: Callable[[Get], str | None],
    ) -> None:
        self._is_public = settings.public_metrics
        self._authentication = authentication
        self._audit = audit
        self._host_refusal = host_refusal

    def refusal(self, get: Get) -> ProbeRefusal | None:
        """Return why a request may not read this; None if it may."""
        if self._is_public:
            return None
        if self._authentication is not None:
            return _refusal_of_others(get, self._authentication)
        if not _is_of_this_machine(get):
            return ProbeRefusal(
                "right",
                "a hub without authentication shows this to its own machine only; "
                "start it with --tokens, or with --public-metrics",
            )
        # A web page on this machine may have given the hub's address a name of its own.
        text = self._host_refusal(get)
        return ProbeRefusal("origin", text) if text is not None else None

    def refuse(self, get: Get, refusal: ProbeRefusal) -> Response:
        """Return the response to a refused request, and record the refusal."""
        reason, text, principal = refusal
        path = get.path.partition("?")[0]
        self._audit.refused(reason, f"{path}: {text}", principal=principal, ip=get.address)
        if reason != "authentication":
            return text_response(http.HTTPStatus.FORBIDDEN, f"{path}: {text}")
        found = text_response(http.HTTPStatus.UNAUTHORIZED, f"{path}: {text}")
        found.headers["WWW-Authenticate"] = "Bearer"
        return found


def _refusal_of_others(get: Get, authentication: Authentication) -> ProbeRefusal | None:
    """Refuse everybody who does not prove to be an admin."""
    try:
        login = authentication.log_in(get.headers, "/", (), get.certificate, get.address)
    except AuthenticationError as error:
        return ProbeRefusal("authentication", str(error))
    if login is None:
        return ProbeRefusal("authentication", "missing token")
    if not login.principal.rights.admin:
        return ProbeRefusal("right", 'missing right "admin"', login.principal.title)
    return None


class Probes:
    """Responds to /livez, /readyz and /healthz.

    Args:
        health: returns all of ``/healthz``.
    """

    def __init__(
        self,
        lag: LoopLag,
        watchers: Watchers,
        health: Callable[[], dict[str, object]],
        *,
        shows_version: bool,
    ) -> None:
        self.is_draining = False
        """Whether the hub is about to end, so that clients should go elsewhere."""
        self._lag = lag
        self._watchers = watchers
        self._health = health
        self._shows_version = shows_version

    def add_to(self, requests: HttpRequests) -> None:
        """Add the resources."""
        requests.add_route("/livez", self.live)
        requests.add_route("/readyz", self.ready)
        requests.add_route("/healthz", self.healthy)

    def live(self, get: Get) -> Response:
        """Respond with 503 if the event loop is too late, which a restart may cure."""
        lag = self._lag.current
        is_live = lag < LONGEST_LAG
        fields = {"status": "ok" if is_live else "late", "lag_seconds": round(lag, 3)}
        return _respond(fields, is_good=is_live)

    def ready(self, get: Get) -> Response:
        """Respond with 503 if no new clients should come."""
        return _respond(
            {"status": "draining" if self.is_draining else "ready"}, is_good=not self.is_draining
        )

    def healthy(self, get: Get) -> Response:
        """Respond with counts and slow clients, or only the status to those who may not see them.

        The status is 200 in both cases, so that load balancers can ask for it.
        """
        status = "draining" if self.is_draining else "ok"
        if self._watchers.refusal(get) is None:
            return _respond({"status": status, **self._health()})
        # Where everybody may enter, everybody may know which version it is.
        return _respond(
            {"status": status} | ({"version": __version__} if self._shows_version else {})
        )


def _is_of_this_machine(get: Get) -> bool:
    try:
        is_loopback = ipaddress.ip_address(get.address).is_loopback
    except ValueError:
        return False
    return is_loopback and not any(name in get.headers for name in PROXIED)


def _respond(fields: Mapping[str, object], *, is_good: bool = True) -> Response:
    status = http.HTTPStatus.OK if is_good else http.HTTPStatus.SERVICE_UNAVAILABLE
    found = response(status, JSON, to_json(fields))
    found.headers["Cache-Control"] = "no-store"
    return found
