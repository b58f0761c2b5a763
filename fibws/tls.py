"""TLS of nodes and tools: the certificates that they trust or present, and why TLS failed."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self, TypeAlias

from fibws.errors import HubUnreachable

if TYPE_CHECKING:
    import ssl

CA = "FIBWS_CA"
CLIENT_CERT = "FIBWS_CLIENT_CERT"
CLIENT_KEY = "FIBWS_CLIENT_KEY"

File: TypeAlias = str | os.PathLike[str]

# The codes of OpenSSL's x509_vfy.h.
_UNKNOWN_ISSUER = (2, 18, 19, 20, 21)
_NOT_YET_VALID, _EXPIRED = 9, 10
_OTHER_NAME = (62, 64)

_NO_TLS = ("WRONG_VERSION_NUMBER", "RECORD_LAYER_FAILURE", "UNEXPECTED_EOF_WHILE_READING")
"""OpenSSL's reasons for an answer that is not TLS."""
_CERTIFICATE_ALERTS = {
    "TLSV13_ALERT_CERTIFICATE_REQUIRED": "it requires one",
    "TLSV1_ALERT_UNKNOWN_CA": "its issuer is unknown to the server",
    "SSLV3_ALERT_BAD_CERTIFICATE": "it is invalid",
    "SSLV3_ALERT_CERTIFICATE_EXPIRED": "it has expired",
    "SSLV3_ALERT_CERTIFICATE_REVOKED": "it has been revoked",
    "SSLV3_ALERT_CERTIFICATE_UNKNOWN": "it is not accepted",
}
"""Explanations of TLS alerts with which a server refuses a client's certificate."""


@dataclass(frozen=True, slots=True)
class TlsFiles:
    """The PEM files of a node or a tool.

    Attributes:
        ca: certificates to trust besides the system's.
        client_cert: the certificate that identifies it to the hub, if any.
        client_key: the private key of that; by default it is in the same file.
    """

    ca: str | None
    client_cert: str | None
    client_key: str | None

    @classmethod
    def choose(
        cls,
        ca: File | None = None,
        client_cert: File | None = None,
        client_key: File | None = None,
    ) -> Self:
        """Return the files that are given, or else those of the environment variables."""
        given = ((ca, CA), (client_cert, CLIENT_CERT), (client_key, CLIENT_KEY))
        return cls(*(_path(file) or os.environ.get(name) or None for file, name in given))

    def context(self, url: str) -> ssl.SSLContext:
        """Read the files and return the context of a connection.

        Besides the certificates of `ca`, those of the system are trusted, or of $SSL_CERT_FILE.

        Args:
            url: the hub's, for the error.

        Raises:
            HubUnreachable: a file cannot be used.
        """
        import ssl  # It takes 20 ms, and few tools need it.

        context = ssl.create_default_context()
        if self.ca is not None:
            try:
                context.load_verify_locations(self.ca)
            except OSError as error:
                raise HubUnreachable(url, _unusable(CA, self.ca, error)) from None
        if self.client_cert is not None:
            try:
                context.load_cert_chain(self.client_cert, self.client_key)
            except OSError as error:
                files = " and ".join(filter(None, (self.client_cert, self.client_key)))
                raise HubUnreachable(url, _unusable(CLIENT_CERT, files, error)) from None
        return context


def fault(error: BaseException | None) -> str | None:
    """Return why TLS failed, and what to do; None for other errors.

    Args:
        error: the error, or one that it has caused.
    """
    while error is not None and type(error).__module__ != "ssl":  # This avoids importing ssl.
        error = error.__cause__ or error.__context__
    if error is None:
        return None
    text, code = getattr(error, "verify_message", ""), getattr(error, "verify_code", 0)
    if text:
        return f"invalid certificate: {text}{_advice(code)}"
    reason = getattr(error, "reason", None) or str(error)
    if reason in _NO_TLS:
        return "the server does not support TLS; use ws://"
    if alert := _CERTIFICATE_ALERTS.get(reason):
        return f"the server refuses this client's certificate: {alert}; see {CLIENT_CERT}"
    return f"TLS failed: {reason.lower().replace('_', ' ')}"


def _advice(code: int) -> str:
    if code in _UNKNOWN_ISSUER:
        return f"; to trust it, set {CA}=FILE (PEM) or use --ca FILE"
    if code in _OTHER_NAME:
        return "; connect by a name that is in it"
    if code == _EXPIRED:
        return "; renew it at the hub, or set this machine's clock"
    return "; set this machine's clock" if code == _NOT_YET_VALID else ""


def _path(file: File | None) -> str | None:
    return None if file is None else os.fspath(file)


def _unusable(name: str, file: str, error: OSError) -> str:
    if type(error).__module__ != "ssl":
        return f"{name}: cannot read {file}: {error.strerror}"
    reason = (getattr(error, "reason", None) or "unknown format").lower().replace("_", " ")
    return f"{name}: cannot use {file}, expected PEM format: {reason}"
