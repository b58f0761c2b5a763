"""Sessions of the hub's page: what a browser's cookie stands for, in place of a token.

A cookie goes to all ports of its host, and may be stolen with a browser's profile. So it holds
random text that is of use to this hub alone, until the log-out or for `LIFETIME`; and of pages only
to the one that has logged in, whose origin the browser names.
"""

from __future__ import annotations

import secrets
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass

from fibws.access.rights import Principal
from fibws.errors import AuthenticationError
from fibws.origins import WebOrigin

LIFETIME = 86400.0
"""Seconds since its last use after which a session ends."""
MOST_OF_ONE = 50
"""Sessions of one principal; another ends the one that was not used for longest."""
MOST = 10_000
"""Sessions of all principals: an issuer of tokens may name any number."""


@dataclass(slots=True, eq=False)
class LoginSession:
    """The login of one browser.

    Attributes:
        owner: the principal's title.
        check: returns the principal of the token of the login; raises `AuthenticationError`.
        origin: of the page that has logged in; None if the browser did not name it.
        used: when it was used last.
    """

    owner: str
    check: Callable[[], Principal]
    origin: WebOrigin | None
    used: float
    has_ended: bool = False

    def principal(self) -> Principal:
        """Return who has logged in; raise `AuthenticationError` if the login has ended."""
        if self.has_ended:
            raise AuthenticationError("the session has ended")
        return self.check()


class Sessions:
    """The sessions of one hub, which end with it.

    Args:
        now: returns the seconds of a clock that is never set back.
    """

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now
        self._sessions: OrderedDict[str, LoginSession] = OrderedDict()
        """By their ids; the one that was not used for longest comes first."""

    def __len__(self) -> int:
        return len(self._sessions)

    def open(self, check: Callable[[], Principal], origin: str | None) -> str:
        """Return the id of a new session.

        Args:
            check: as in `LoginSession`.
            origin: of the page that logs in, if it is known.
        """
        self._forget_old()
        owner = check().title
        own = [id_ for id_, each in self._sessions.items() if each.owner == owner]
        if len(own) >= MOST_OF_ONE:
            self.close(own[0])
        elif len(self._sessions) >= MOST:
            self.close(next(iter(self._sessions)))
        id_ = secrets.token_urlsafe(32)
        page = WebOrigin.parse(origin) if origin is not None else None
        self._sessions[id_] = LoginSession(owner, check, page, self._now())
        return id_

    def find(self, id_: str, origin: str | None, host: str) -> LoginSession | None:
        """Return a session for a request; None if it has none, or one of another page.

        Args:
            origin: the request's ``Origin`` header. A browser sends one with each WebSocket, and
                with requests of other origins whose response a script could read.
            host: its ``Host`` header.
        """
        self._forget_old()
        session = self._sessions.get(id_)
        if session is None or (origin is not None and not _is_own(session, origin, host)):
            return None
        session.used = self._now()
        self._sessions.move_to_end(id_)
        return session

    def close(self, id_: str) -> bool:
        """End a session; return whether there was one."""
        session = self._sessions.pop(id_, None)
        if session is None:
            return False
        session.has_ended = True
        return True

    def _forget_old(self) -> None:
        """Forget the sessions that are over; connections that they have opened stay."""
        while self._sessions:
            id_, oldest = next(iter(self._sessions.items()))
            if self._now() - oldest.used < LIFETIME:
                return
            del self._sessions[id_]


def _is_own(session: LoginSession, origin: str, host: str) -> bool:
    page = WebOrigin.parse(origin)
    if page is None:
        return False
    return page == (session.origin or WebOrigin.of_host(page.scheme, host))
