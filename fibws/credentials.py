"""The token with which a client enters its hub: where it comes from, and what a refusal means.

A token is sent as ``Authorization: Bearer TOKEN``. It must not be shown: not in logs, not in
errors, not in URLs, which are printed and logged everywhere.
"""

from __future__ import annotations

import json
import logging
import os
import re
from base64 import urlsafe_b64decode
from codecs import BOM_UTF8
from collections.abc import Mapping, MutableMapping
from pathlib import Path
from typing import Self
from urllib.parse import urlsplit

from fibws import hub_address
from fibws.errors import AccessDenied, AccessError, HubLimitReached, MissingRight, NotAuthorized
from fibws.protocol.websocket import (
    FORBIDDEN,
    LIMITED,
    LONGEST_TOKEN,
    MISSING_TOKEN,
    UNAUTHENTICATED,
)

TOKEN = "FIBWS_TOKEN"
TOKEN_FILE = "FIBWS_TOKEN_FILE"
VARIABLES = (hub_address.ENVIRONMENT, TOKEN, TOKEN_FILE)
"""The variables that may hold a token or name its file."""
HEADER = "Authorization"
REFUSALS: Mapping[int, type[AccessDenied]] = {
    UNAUTHENTICATED: NotAuthorized,
    FORBIDDEN: MissingRight,
    LIMITED: HubLimitReached,
}
"""The errors for the codes with which a hub closes a connection for good."""
RENEWAL = 60.0
"""Seconds before a token's expiry from which on its file is read again and again."""
LONGEST_CHECK = 5.0
"""Most seconds between two reads of the file."""
SHORTEST_CHECK = 0.05
"""Least seconds between two reads of the file."""
# RFC 6750, section 2.1.
_TOKEN = re.compile(r"[A-Za-z0-9\-._~+/]+=*")


class Credentials:
    """A client's token, or the file that holds it.

    Args:
        token: the token; None if there is none, or if it is in a file.
        file: the file, which is read again for each connection.
        source: where the token or the file's name was found, for error texts.

    Raises:
        AccessError: the token is invalid, or the file cannot be read.
    """

    def __init__(
        self, token: str | None = None, file: Path | None = None, source: str = ""
    ) -> None:
        self._token = None if token is None else _check(token, source)
        self._file = file
        self._source = source
        self.read()

    def __repr__(self) -> str:
        return f"<Credentials from {self.source}>" if self else "<no Credentials>"

    def __bool__(self) -> bool:
        return self._token is not None or self._file is not None

    @classmethod
    def find(
        cls,
        hub: str | None = None,
        *,
        token: str | None = None,
        token_file: str | os.PathLike[str] | None = None,
        environment: Mapping[str, str] = os.environ,
    ) -> Self:
        """Return the credentials for a hub.

        The first of these counts: the arguments, a token in the hub's URL, $FIBWS_TOKEN,
        $FIBWS_TOKEN_FILE.

        Args:
            hub: the hub's address as the user wrote it; default $FIBWS_HUB.
            token: the token.
            token_file: a file that holds the token and nothing else.

        Raises:
            ValueError: both a token and a file are given.
            AccessError: the token is invalid, or the file cannot be read.
        """
        if token is not None and token_file is not None:
            raise ValueError("expected either a token or a token file, got both")
        if token is not None:
            return cls(token, source="the argument token")
        if token_file is not None:
            return cls(file=Path(token_file), source="the argument token_file")
        address = hub or environment.get(hub_address.ENVIRONMENT) or ""
        if (found := hub_address.token_in(address)) is not None:
            return cls(found, source="the hub's URL")
        if variable := environment.get(TOKEN, "").strip():
            return cls(variable, source=TOKEN)
        if file := environment.get(TOKEN_FILE):
            return cls(file=Path(file), source=TOKEN_FILE)
        return cls()

    @property
    def source(self) -> str:
        """Where the token is from."""
        return f"{self._source} ({self._file})" if self._file is not None else self._source

    def read(self) -> str | None:
        """Return the token, or None if there is none; a file is read again.

        Raises:
            AccessError: the file cannot be read, or does not hold a token.
        """
        if self._file is None:
            return self._token
        try:
            with self._file.open("rb") as file:
                # An editor on Windows may begin the file with a byte order mark.
                text = (
                    file.read(LONGEST_TOKEN + 5).removeprefix(BOM_UTF8).decode("ascii", "replace")
                )
        except OSError as error:
            raise AccessError(f"cannot read {self.source}: {error.strerror}") from None
        return _check(text.strip(), self.source)

    def replacement(self, token: str | None) -> str | None:
        """Return the token in the file if it is another one than that in use, else None."""
        try:
            found = self.read()
        except AccessError:
            return None  # It is reported if the hub refuses the old one.
        return found if found != token else None

    def next_check(self, token: str | None, now: float) -> float | None:
        """Return the seconds until the file is to be read again, since the token will expire.

        Args:
            token: the one in use, or None.
            now: the seconds since 1970.

        Returns:
            None if it need not be read: the token is in no file, or is not a JWT that expires.
        """
        expires = expiry(token) if token is not None and self._file is not None else None
        if expires is None:
            return None
        left = expires - now
        pause = left - RENEWAL if left > 2 * RENEWAL else left / 10
        return min(max(pause, SHORTEST_CHECK), LONGEST_CHECK)

    def set_in(self, environment: MutableMapping[str, str]) -> None:
        """Set the variables by which the programs that this one starts find the same token."""
        if hub := environment.get(hub_address.ENVIRONMENT):
            environment[hub_address.ENVIRONMENT] = hub_address.without_token(hub)
        if not self:
            return
        environment.pop(TOKEN, None)
        environment.pop(TOKEN_FILE, None)
        if self._file is not None:
            environment[TOKEN_FILE] = str(self._file.absolute())
        elif self._token is not None:
            environment[TOKEN] = self._token

    def warning(self, url: str) -> str | None:
        """Return a warning if the token is sent to a hub without encryption."""
        parts = urlsplit(url)
        if not self or parts.scheme != "ws" or hub_address.is_loopback(parts.hostname or ""):
            return None
        return f"The token is sent to {url} without encryption: others may read it. Use wss://"

    def refusal(
        self,
        url: str,
        code: int | None,
        reason: str,
        *,
        sent: bool,
        redirected_from: str,
        certificate: str | None = None,
    ) -> AccessDenied | None:
        """Return the error for a connection that the hub has closed for good; None for others.

        Args:
            url: the hub's.
            code: the WebSocket's close code.
            reason: the hub's reason.
            sent: whether the token was sent.
            redirected_from: another address that redirected to ``url``, which must not get the
                token.
            certificate: the file of the certificate that the hub was given, if any.
        """
        kind = REFUSALS.get(code or 0)
        if kind is None:
            return None
        if kind is NotAuthorized and not sent and certificate and reason != MISSING_TOKEN.reason:
            return NotAuthorized(url, reason, f"Check the certificate in {certificate}")
        if kind is NotAuthorized and not sent:
            return self.missing(url, redirected_from, reason)
        remedy = f"Check the token in {self.source}" if kind is NotAuthorized else ""
        return kind(url, reason or f"close code {code}", remedy)

    def missing(self, url: str, redirected_from: str, reason: str = "") -> NotAuthorized:
        """Return the error for a hub that requires a token but got none; see `refusal`."""
        remedy = ""
        if self:
            remedy = (
                f"The token was not sent because {redirected_from} redirects there. "
                f"To send it, set {hub_address.ENVIRONMENT}={url}"
            )
        return NotAuthorized(url, reason or "missing token", remedy)


def headers(token: str | None) -> dict[str, str]:
    """Return the handshake's headers for a token."""
    return {} if token is None else {HEADER: f"Bearer {token}"}


def expiry(token: str) -> float | None:
    """Return when a JWT expires, in seconds since 1970; None without ``exp``, or if not a JWT.

    Nothing is verified: only the hub can do that.
    """
    parts = token.split(".")
    if len(parts) != 3:
        return None
    try:
        claims = json.loads(urlsafe_b64decode(parts[1] + "=" * (-len(parts[1]) % 4)))
    except (ValueError, RecursionError):
        return None
    expires = claims.get("exp") if isinstance(claims, dict) else None
    if isinstance(expires, bool) or not isinstance(expires, int | float):
        return None
    return float(expires) if 0 <= expires < 1e15 else None


def handshake_log() -> logging.Logger:
    """Return the logger for a handshake, which hides the token from the library's debug lines."""
    log = logging.getLogger("websockets.client.fibws")
    log.addFilter(_hide_token)  # Does nothing when called again.
    return log


def _hide_token(record: logging.LogRecord) -> bool:
    arguments = record.args
    if isinstance(arguments, tuple) and len(arguments) == 2 and arguments[0] == HEADER:
        record.args = (HEADER, "[hidden]")
    return True


def _check(token: str, source: str) -> str:
    """Return a token; raise `AccessError` if a header must not hold it."""
    if not isinstance(token, str):
        raise TypeError(f"{source} must be a string, got {token!r}")
    if not token:
        raise AccessError(f"{source} is empty, expected a token")
    if len(token) > LONGEST_TOKEN:
        raise AccessError(f"{source}: the token is too long (limit {LONGEST_TOKEN} characters)")
    if not _TOKEN.fullmatch(token):
        raise AccessError(
            f"{source}: invalid token, expected one word of letters, digits and -._~+/="
        )
    return token
