"""The hub's side of TLS: its certificate, which can be replaced while clients are connected.

The files are read into an SSL context when the hub starts, and into another one by each reload.
The event loop keeps one context, which gives each new connection the newest of these; a connection
that was accepted before a reload changes to it with the client's first message. Open connections
are not affected.
"""

from __future__ import annotations

import logging
import re
import ssl
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from fibws.errors import AccessError, SettingError
from fibws.hub.access.authentication import Certificate
from fibws.tls import Pair, load_authorities, load_pair

logger = logging.getLogger("fibws.hub")

_PLAIN = ("HTTP_REQUEST", "HTTPS_PROXY_REQUEST")
"""OpenSSL's reasons for refusing a client that speaks HTTP without TLS."""
_TARGET = re.compile(rb"([!-.0-~][!-~]*)? HTTP/1\.[01]\r\n")
"""The rest of a GET request's first line: OpenSSL has taken five bytes, "GET /". What follows the
first five bytes of another method begins with a slash."""
_HOST = re.compile(rb"\r\nHost:[ \t]*([\w.:\[\]-]+)[ \t]*\r\n", re.IGNORECASE)
_KINDS = ("DNS", "IP Address")
_NO_CHECK_TIME = 0x200000
"""OpenSSL's X509_V_FLAG_NO_CHECK_TIME: a certificate that has ended can be read, too."""
_UPGRADE = re.compile(rb"\r\nUpgrade:", re.IGNORECASE)


class ServerTls:
    """The certificate of a hub, and the authority of its clients' certificates.

    Args:
        certificate: a PEM file: the hub's certificate, followed by those between it and its
            authority.
        key: a PEM file of the certificate's private key, without a password.
        client_ca: a PEM file of the authorities whose certificates clients may present, with the
            lists of revoked ones (CRL) if there are any; without it, clients are not asked for one.

    Raises:
        HubError: a file cannot be used.
    """

    def __init__(self, certificate: Path, key: Path, client_ca: Path | None = None) -> None:
        self._files = (certificate, key, client_ca)
        self.files = list(dict.fromkeys(filter(None, self._files)))
        """The files that are read."""
        self.on_refused: Callable[[str], object] = lambda reason: None
        """Takes the reason whenever a client's certificate is refused."""
        self._newest: ssl.SSLContext
        self._names: list[str]
        self.end: float | None
        """When the certificate ends, in seconds since 1970; None if that is not known."""
        self._contents: list[bytes] = []
        """Of the files."""
        self.read()()
        self.context = _Listening(ssl.PROTOCOL_TLS_SERVER)
        """The context for the event loop."""
        self.context.newest = lambda: self._newest

    def name_for(self, address: str) -> str:
        """Return the name that clients of this machine must use for an address of the hub.

        It is the first one in the certificate, unless the certificate holds the address.
        """
        if address in self._names:
            return address
        return next((name for name in self._names if "*" not in name), address)

    def read(self) -> Callable[[], list[str]]:
        """Read the files again, and return a function that has new connections use them.

        That function returns what has changed, as in ``certificate replaced``. A certificate that
        clients will refuse, such as an expired one, is logged.

        Raises:
            HubError: a file cannot be used.
        """
        context = _context(*self._files)
        context.on_refused = lambda reason: self.on_refused(reason)
        contents = [each.read_bytes() for each in self._files if each is not None]
        names, end, fault = _inspect(context, self._files[0])
        last_day = (
            "" if end is None else f", valid until {datetime.fromtimestamp(end, UTC):%Y-%m-%d}"
        )
        if fault:
            logger.warning("Clients will refuse the certificate in %s: %s.", self._files[0], fault)

        def use() -> list[str]:
            old, self._contents = self._contents, contents
            self._newest, self._names, self.end = context, names, end
            context.sni_callback = self._select
            changes = []
            if old[:2] != contents[:2]:
                changes.append(f"certificate replaced{last_day}")
            if old[2:] != contents[2:]:
                changes.append("authorities of client certificates changed")
            return changes

        return use

    def _select(self, client: ssl.SSLObject, name: str | None, old: ssl.SSLContext) -> int | None:
        """Give a connection the newest context: OpenSSL calls it, also without a server name.

        The new context brings its certificate and authorities, but whether lists of revoked
        certificates are checked stays as it was: such a client must connect again.
        """
        if old.verify_flags != self._newest.verify_flags:
            return ssl.ALERT_DESCRIPTION_INTERNAL_ERROR
        client.context = self._newest
        return None


def certificate_of(tls: ssl.SSLObject | None) -> Certificate | None:
    """Return the certificate that a client has presented and that is verified.

    Args:
        tls: of the client's connection; None if it has no TLS.
    """
    found: dict[str, Any] = (tls.getpeercert() if tls is not None else None) or {}
    # ((("countryName", "DE"),), (("commonName", "robot"),))
    subject = found.get("subject", ())
    names = (value for part in subject for key, value in part if key == "commonName")
    name = next(names, None)
    return None if name is None else Certificate(name, ssl.cert_time_to_seconds(found["notAfter"]))


class _Listening(ssl.SSLContext):
    """A context that gives each new connection another one."""

    newest: Callable[[], ssl.SSLContext]

    def wrap_bio(self, *arguments: Any, **options: Any) -> ssl.SSLObject:
        return self.newest().wrap_bio(*arguments, **options)


class _Context(ssl.SSLContext):
    on_refused: Callable[[str], object]

    def wrap_bio(
        self,
        incoming: ssl.MemoryBIO,
        outgoing: ssl.MemoryBIO,
        server_side: bool = False,
        server_hostname: str | bytes | None = None,
        session: ssl.SSLSession | None = None,
    ) -> ssl.SSLObject:
        found = super().wrap_bio(incoming, outgoing, server_side, server_hostname, session)
        assert isinstance(found, _Handshake)
        found.incoming, found.outgoing = incoming, outgoing
        return found


class _Handshake(ssl.SSLObject):
    """A connection's TLS, which tells a client why its handshake failed.

    The event loop would discard the alert, and close the socket: after an error it sends nothing
    more. So the error is reported to it in two steps: the first one sends what there is to send.
    """

    incoming: ssl.MemoryBIO
    outgoing: ssl.MemoryBIO
    _error: ssl.SSLError | None = None

    def do_handshake(self) -> None:
        """Continue the handshake.

        Raises:
            SSLWantReadError: the client must send more; or the handshake has failed, and the client
                is to be told.
            SSLError: the handshake failed, and the client has been told.
        """
        if self._error is not None:
            raise self._error
        try:
            super().do_handshake()
        except (ssl.SSLWantReadError, ssl.SSLWantWriteError, ssl.SSLSyscallError):
            raise
        except ssl.SSLError as error:
            self._error = error
            if error.reason in _PLAIN:
                self.outgoing.write(_respond_to_plain(self.incoming.read()))
            elif isinstance(error, ssl.SSLCertVerificationError):
                assert isinstance(self.context, _Context)
                self.context.on_refused(f"invalid client certificate: {error.verify_message}")
            raise ssl.SSLWantReadError(str(error)) from error


def _respond_to_plain(rest: bytes) -> bytes:
    """Return the response to an HTTP request that came without TLS.

    A browser is redirected. Other clients are refused, so that their users notice: what they sent
    was readable on the way.

    Args:
        rest: the request, without the first bytes.
    """
    text = b"This port expects TLS; use https:// or wss://.\n"
    status, location = b"400 Bad Request", b""
    target, host = _TARGET.match(rest), _HOST.search(rest)
    if target is not None and host is not None and not _UPGRADE.search(rest):
        status = b"307 Temporary Redirect"
        location = b"Location: https://%b/%b\r\n" % (host[1], target[1] or b"")
    return (
        b"HTTP/1.1 %b\r\n%bContent-Type: text/plain; charset=utf-8\r\nContent-Length: %d\r\n"
        b"Connection: close\r\n\r\n%b" % (status, location, len(text), text)
    )


def _context(certificate: Path, key: Path, client_ca: Path | None) -> _Context:
    context = _Context(ssl.PROTOCOL_TLS_SERVER)
    context.sslobject_class = _Handshake
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        load_pair(context, Pair("--cert", "--key"), certificate, key)
        if client_ca is not None:
            load_authorities(context, "--client-ca", client_ca)
    except AccessError as error:
        raise SettingError(str(error)) from None
    if client_ca is not None:
        context.verify_mode = ssl.CERT_OPTIONAL
        if context.cert_store_stats()["crl"]:
            context.verify_flags |= ssl.VERIFY_CRL_CHECK_LEAF
        # A client that resumes a session would not be asked for its certificate again, which a
        # reload may have made invalid.
        context.options |= ssl.OP_NO_TICKET
        context.num_tickets = 0
    return context


def _inspect(context: ssl.SSLContext, certificate: Path) -> tuple[list[str], float | None, str]:
    """Return the names and addresses in a certificate, its end, and its fault.

    The fault is why clients will refuse it.
    """
    fault = ""
    try:
        found = _decoded(context, certificate)
    except ssl.SSLError as error:
        fault = getattr(error, "verify_message", "") or str(error)
        try:
            found = _decoded(context, certificate, _NO_CHECK_TIME)
        except ssl.SSLError:
            return [], None, fault
    names = [name for kind, name in found.get("subjectAltName", ()) if kind in _KINDS]
    end = ssl.cert_time_to_seconds(found["notAfter"])
    return names, end, fault or ("" if names else "it holds no names")


def _decoded(context: ssl.SSLContext, certificate: Path, flags: int = 0) -> dict[str, Any]:
    """Return what a certificate holds.

    Python's ssl has no function that decodes one, but a client knows its server's. This one trusts
    the certificate's issuer, and raises SSLError if the certificate is invalid nevertheless.

    Args:
        flags: of OpenSSL, besides those with which each certificate is verified.
    """
    trusting = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    trusting.check_hostname = False
    trusting.load_verify_locations(certificate)
    trusting.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN | flags
    to_client, to_server = ssl.MemoryBIO(), ssl.MemoryBIO()
    client = trusting.wrap_bio(to_client, to_server)
    server = context.wrap_bio(to_server, to_client, server_side=True)
    for side in (client, server, client):
        try:
            side.do_handshake()
        except ssl.SSLWantReadError:
            pass
    return client.getpeercert() or {}
