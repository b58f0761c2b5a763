"""Authentication: which principal a client is, by its token or its certificate.

A token comes in the handshake: in the header ``Authorization: Bearer TOKEN``, in the URL's query as
``token=TOKEN``, or as the WebSocket subprotocol ``fibws.token.TOKEN``. Or the client sends it soon
after, by the operation ``auth``. The hub's page has a cookie after a login, which names its session
(`sessions`); one that is unknown is no token, and is ignored.

A client with a wrong token is refused; neither another token of the same request nor anonymous
access takes its place: the user would wonder why so little is allowed.

Wrong tokens count against their address. So a plain request, which any web page can have a browser
send by an ``<img>``, must bring its token in the header ``Authorization``: such a page cannot.
"""

from __future__ import annotations

import logging
import math
import time
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import NamedTuple
from urllib.parse import parse_qs

from websockets.datastructures import Headers

from fibws.access.limits import network_of
from fibws.access.rights import RIGHTS, Principal, Rights, check_name
from fibws.access.token_file import ANONYMOUS, Tokens
from fibws.access.web_tokens import WebTokens
from fibws.errors import AccessError, AuthenticationError, SettingError
from fibws.hub.access.sessions import LoginSession, Sessions
from fibws.hub.errors import TooManyAttempts
from fibws.hub.log.text import is_power_of_ten
from fibws.hub.settings import Settings
from fibws.protocol.websocket import LONGEST_TOKEN, TOKEN_SUBPROTOCOL

logger = logging.getLogger("fibws.hub")

COOKIE = "fibws_session"
"""The name of the cookie that holds the id of a page's session."""
MOST_WRONG = 20
"""Wrong tokens of one address in a row after which it must wait."""
FORGIVEN_PER_SECOND = 1.0
"""Wrong tokens of an address that are forgotten in a second."""
MOST_ADDRESSES = 10_000
"""Addresses whose wrong tokens are counted; more forget the oldest."""
CERTIFICATE_RIGHTS = Rights({right: ("/**",) for right in RIGHTS})
"""The rights of certificates on a hub without a file of tokens, which could name their rights."""


class Certificate(NamedTuple):
    """A client's certificate, which TLS has verified.

    Attributes:
        name: its common name.
        expires: when it ends, in seconds since 1970.
    """

    name: str
    expires: float = math.inf


class AuthoritiesChanged(AuthenticationError):
    """A certificate must be verified again, by a new connection."""


@dataclass(frozen=True, slots=True)
class Login:
    """An accepted proof of a client.

    Attributes:
        principal: the client's principal.
        again: checks the proof again, after the tokens have changed; raises
            `AuthenticationError`.
        session: the page's, if its cookie is the proof.
    """

    principal: Principal
    again: Callable[[], Principal]
    session: LoginSession | None = None


class Authentication:
    """The principals of one hub, and the proofs that they give.

    Args:
        now: returns the seconds since 1970, for the expiry of tokens.
        ticks: returns the seconds of a clock that is never set back, for everything else.

    Raises:
        HubError: a file is not there, or invalid.
    """

    def __init__(
        self,
        settings: Settings,
        now: Callable[[], float],
        ticks: Callable[[], float] = time.monotonic,
    ) -> None:
        self._path = settings.tokens
        self._now = now
        self._authorities_file = settings.client_ca
        self._authorities = _read(self._authorities_file)
        """The authorities of clients' certificates, as TLS has read them."""
        self._tokens = Tokens({}, {}, None)
        self._web_tokens: WebTokens | None = None
        self._attempts = WrongTokens(ticks)
        self._sessions = Sessions(ticks)
        option = "--jwt-key"
        try:
            if settings.jwt_key is not None:
                self._web_tokens = WebTokens(
                    settings.jwt_key,
                    settings.jwt_algorithm,
                    settings.jwt_audience or None,
                    settings.jwt_leeway,
                )
            option = "--tokens"
            if self._path is not None:
                self._tokens = Tokens.load(self._path)
        except AccessError as error:
            raise SettingError(f"{option}: {error}") from None

    def reload(self) -> list[str]:
        """Read all files again, and return what has changed, as in ``token teleop revoked``.

        Raises:
            AccessError: a file is invalid; the old content is kept.
        """
        tokens = self._tokens if self._path is None else Tokens.load(self._path)
        changes = tokens.changes(self._tokens)
        if self._web_tokens is not None and self._web_tokens.reload():
            changes.append("key of JSON web tokens changed")
        self._tokens = tokens
        self._authorities = _read(self._authorities_file)
        return changes

    def network(self, name: str) -> Principal:
        """Return the principal of what joins without a token; see `token_file.NETWORKS`."""
        return self._tokens.networks[name]

    def known(self) -> Iterable[Principal]:
        """Return the principals of the file of tokens."""
        anonymous = self._tokens.anonymous
        yield from self._tokens.tokens.values()
        yield from self._tokens.certificates.values()
        if anonymous is not None:
            yield anonymous

    def log_in(
        self,
        headers: Headers,
        path: str,
        subprotocols: Sequence[str],
        certificate: Certificate | None,
        address: str,
    ) -> Login | None:
        """Return the principal of a request; None if credentials are missing.

        Args:
            path: the request's target; a token in its query counts.
            subprotocols: those that the client offers.
            certificate: the client's, if it has one.
            address: the client's IP address.

        Raises:
            AuthenticationError: the token is wrong or expired.
        """
        token = token_in(headers, path, subprotocols)
        if token is not None:
            return self.log_in_by_token(token, address)
        session = self._session(headers)
        if session is not None:
            return Login(session.principal(), session.principal, session)
        if certificate is not None and self._authorities_file is not None:
            return _logged_in(partial(self._certified, certificate, self._authorities))
        if self._tokens.anonymous is not None:
            return _logged_in(self._anonymous)
        return None

    def log_in_by_token(self, token: str, address: str) -> Login:
        """Return the principal of a token.

        A valid one counts even while its address must wait: there may be others behind the address.

        Raises:
            TooManyAttempts: the token is wrong, as were many before from this address.
            AuthenticationError: the token is wrong or expired.
        """
        try:
            return _logged_in(partial(self._of_token, token))
        except AuthenticationError:
            self._attempts.check(address)
            self._attempts.failed(address)
            raise

    def open_session(self, login: Login, origin: str | None) -> str:
        """Return the id of a new session of a page, which has just logged in.

        Args:
            origin: the page's, if it is known.
        """
        return self._sessions.open(login.again, origin)

    def close_session(self, headers: Headers) -> bool:
        """End the session of a request's cookie; return whether there was one."""
        return any([self._sessions.close(each) for each in _cookies(headers)])

    def _session(self, headers: Headers) -> LoginSession | None:
        origin, host = headers.get("Origin"), headers.get("Host", "")
        found = (self._sessions.find(each, origin, host) for each in _cookies(headers))
        return next((each for each in found if each is not None), None)

    def _of_token(self, token: str) -> Principal:
        if not token:
            raise AuthenticationError("missing token")
        if len(token) > LONGEST_TOKEN:
            raise AuthenticationError(f"the token is too long (limit is {LONGEST_TOKEN})")
        found = self._tokens.find(token)
        if found is None and self._web_tokens is not None and token.count(".") == 2:
            found = self._web_tokens.principal(token)
        if found is None:
            raise AuthenticationError("unknown token")
        return self._unexpired(found, "token")

    def _certified(self, certificate: Certificate, authorities: bytes) -> Principal:
        if authorities != self._authorities:
            raise AuthoritiesChanged("the authorities of client certificates have changed")
        name = certificate.name
        found = self._tokens.certificates.get(name)
        if found is None and self._path is None:
            if name == ANONYMOUS:
                raise AuthenticationError(f"the name {ANONYMOUS} is for clients without a token")
            try:
                found = Principal(check_name(name), CERTIFICATE_RIGHTS, proof="certificate")
            except AccessError as error:
                raise AuthenticationError(f"invalid certificate: {error}") from None
        if found is None:
            raise AuthenticationError(f"the file of tokens has no [certificates.{name}]")
        expires = min(certificate.expires, math.inf if found.expires is None else found.expires)
        return self._unexpired(replace(found, expires=expires), "certificate")

    def _anonymous(self) -> Principal:
        found = self._tokens.anonymous
        if found is None:
            raise AuthenticationError("missing token")
        return self._unexpired(found, "anonymous access")

    def _unexpired(self, principal: Principal, what: str) -> Principal:
        if principal.is_expired(self._now()):
            raise AuthenticationError(f"the {what} expired")
        return principal


class WrongTokens:
    """Counts the wrong tokens of each address, and slows down those that guess.

    A whole network of IPv6 counts as one address.

    Args:
        now: returns the seconds of a clock that is never set back.
    """

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now
        self._wrong: OrderedDict[str, tuple[float, float]] = OrderedDict()
        """By network: how many count, and as of when."""
        self._total = 0

    def check(self, address: str) -> None:
        """Raise `TooManyAttempts` if an address must wait before it may try a token."""
        count = self._count(network_of(address))
        if count >= MOST_WRONG:
            raise TooManyAttempts(math.ceil((count - MOST_WRONG + 1) / FORGIVEN_PER_SECOND))

    def failed(self, address: str) -> None:
        """Count a wrong token."""
        self._total += 1
        network = network_of(address)
        count = self._count(network) + 1
        self._wrong[network] = count, self._now()
        self._wrong.move_to_end(network)
        if len(self._wrong) > MOST_ADDRESSES:
            self._wrong.popitem(last=False)
        if count >= MOST_WRONG or is_power_of_ten(self._total):
            logger.warning("Wrong token from %s (wrong token %d in all).", address, self._total)

    def _count(self, network: str) -> float:
        count, since = self._wrong.get(network, (0.0, 0.0))
        return max(0.0, count - max(0.0, self._now() - since) * FORGIVEN_PER_SECOND)


def _read(path: Path | None) -> bytes:
    """Return a file's content; empty if it is missing: TLS reports that."""
    try:
        return path.read_bytes() if path is not None else b""
    except OSError:
        return b""


def _logged_in(check: Callable[[], Principal]) -> Login:
    return Login(check(), check)


def token_in(headers: Headers, path: str, subprotocols: Sequence[str]) -> str | None:
    """Return the token in a request; None without any.

    Raises:
        AuthenticationError: it is not clear which one counts.
    """
    given = headers.get_all("Authorization")
    if len(given) > 1:
        raise AuthenticationError("more than one header Authorization")
    scheme, _, token = "".join(given).partition(" ")
    if scheme.lower() == "bearer":
        return token.strip()
    values = parse_qs(path.partition("?")[2], keep_blank_values=True).get("token")
    if values:
        return values[0]
    for each in subprotocols:
        if each.startswith(TOKEN_SUBPROTOCOL):
            return each.removeprefix(TOKEN_SUBPROTOCOL)
    return None


def _cookies(headers: Headers) -> Iterator[str]:
    """Yield the ids of sessions in a request's cookies."""
    for header in headers.get_all("Cookie"):
        for pair in header.split(";"):
            name, _, value = pair.strip().partition("=")
            if name == COOKIE:
                yield value
