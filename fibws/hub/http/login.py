"""The login of the hub's page: ``/login`` opens a session by a token, and ``/logout`` ends it.

A script of a page cannot set headers of a WebSocket, and a token in a URL ends up in logs and in
the browser's history. A cookie is sent by itself, and no script can read this one (HttpOnly). It
names a session (`fibws.hub.access.sessions`) and not the token, since other ports get it, too.

The token comes in the header ``Authorization``, which pages of other origins cannot send without a
permission (CORS) that the hub never gives. The cookie is sent with no request that another site
has caused (SameSite=Strict).
"""

from __future__ import annotations

import http
from collections.abc import Callable

from pydantic_core import to_json
from websockets.datastructures import Headers
from websockets.http11 import Response

from fibws.access.rights import Principal
from fibws.errors import AuthenticationError
from fibws.hub.access.authentication import COOKIE, Authentication
from fibws.hub.errors import TooManyAttempts
from fibws.hub.http.proxies import is_secure
from fibws.hub.http.requests import Get, HttpRequests, response, text_response
from fibws.origins import origin_of_url

ATTRIBUTES = "HttpOnly; SameSite=Strict"
"""The path is not among them: by default it is the folder of ``login``, also behind a proxy that
has the hub in a folder of its own."""
OWN_PAGE = ("same-origin", "none")
"""Values of Sec-Fetch-Site in requests of the page itself, and of the address bar."""


class LoginRoutes:
    """``/login`` and ``/logout``.

    Args:
        requests: what these resources are added to.
        authentication: the hub's; None if it lets in everybody.
        refused: takes the reason and the client's address whenever a token is refused.
        logged_out: called when a session has ended by a log-out.
    """

    def __init__(
        self,
        requests: HttpRequests,
        authentication: Authentication | None,
        refused: Callable[[str, str], object] = lambda reason, address: None,
        logged_out: Callable[[], object] = lambda: None,
    ) -> None:
        self._requests = requests
        self._authentication = authentication
        self._refused = refused
        self._logged_out = logged_out
        requests.add_route("/login", self._log_in)
        requests.add_route("/logout", self._log_out)

    def _log_in(self, get: Get) -> Response:
        """Open a session if a token is given; otherwise respond with the client's principal."""
        refusal = self._refusal(get)
        if refusal is not None:
            return refusal
        scheme, _, token = get.headers.get("Authorization", "").partition(" ")
        if scheme.lower() != "bearer" or self._authentication is None:
            return _not_stored(self._describe(get))
        try:
            login = self._authentication.log_in_by_token(token.strip(), get.address)
        except AuthenticationError as error:
            self._refused(f"login: {error}", get.address)
            status = http.HTTPStatus.UNAUTHORIZED
            if isinstance(error, TooManyAttempts):
                status = http.HTTPStatus.TOO_MANY_REQUESTS
            return _not_stored(text_response(status, str(error)))
        return _with_cookie(
            get.headers, self._authentication.open_session(login, _page(get.headers))
        )

    def _log_out(self, get: Get) -> Response:
        refusal = self._refusal(get)
        if refusal is not None:
            return refusal
        if self._authentication is not None and self._authentication.close_session(get.headers):
            self._logged_out()
        return _with_cookie(get.headers, "", "; Max-Age=0")

    def _refusal(self, get: Get) -> Response | None:
        """Refuse pages of other sites."""
        refusal = self._requests.host_refusal(get)
        if refusal is None and get.headers.get("Sec-Fetch-Site", "none") not in OWN_PAGE:
            refusal = "Only the hub's own page may log in and out"
        return None if refusal is None else text_response(http.HTTPStatus.FORBIDDEN, refusal)

    def _describe(self, get: Get) -> Response:
        """Respond with the principal of the client's cookie, or why there is none."""
        principal: Principal | None = None
        reason = ""
        if self._authentication is not None:
            reason = "missing token"
            try:
                login = self._authentication.log_in(
                    get.headers, "/", (), get.certificate, get.address
                )
                principal = None if login is None else login.principal
            except AuthenticationError as error:
                reason = str(error)
        body = {
            "required": self._authentication is not None,
            "name": principal and principal.name,
            "admin": principal is not None and principal.rights.admin,
            "reason": "" if principal is not None else reason,
        }
        return response(http.HTTPStatus.OK, "application/json", to_json(body))


def _with_cookie(headers: Headers, value: str, more: str = "") -> Response:
    found = _not_stored(response(http.HTTPStatus.NO_CONTENT))
    secure = "; Secure" if _is_encrypted(headers) else ""
    found.headers["Set-Cookie"] = f"{COOKIE}={value}; {ATTRIBUTES}{secure}{more}"
    return found


def _is_encrypted(headers: Headers) -> bool:
    """Return whether the page was loaded with TLS, be it the hub's or a proxy's.

    A proxy that is not trusted does not say so, but the page does.
    """
    page = _page(headers)
    return is_secure(headers) or (page is not None and page.startswith("https://"))


def _page(headers: Headers) -> str | None:
    """Return the origin of the page that sends a request, if the browser names it."""
    return headers.get("Origin") or origin_of_url(headers.get("Referer", ""))


def _not_stored(found: Response) -> Response:
    found.headers["Cache-Control"] = "no-store"
    return found
