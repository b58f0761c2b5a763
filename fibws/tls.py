"""The certificates that programs trust or present, and why TLS failed."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Self, TypeAlias

from fibws.errors import AccessError, HubUnreachable

if TYPE_CHECKING:
    import ssl

CA = "FIBWS_CA"
CLIENT_CERT = "FIBWS_CLIENT_CERT"
CLIENT_KEY = "FIBWS_CLIENT_KEY"
VARIABLES = (CA, CLIENT_CERT, CLIENT_KEY)

File: TypeAlias = str | os.PathLike[str]

# The codes of OpenSSL's x509_vfy.h.
_UNKNOWN_ISSUER = (2, 18, 19, 20, 21)
_NOT_YET_VALID, _EXPIRED = 9, 10
_OTHER_NAME = (62, 64)

_NO_TLS = ("WRONG_VERSION_NUMBER", "RECORD_LAYER_FAILURE", "UNEXPECTED_EOF_WHILE_READING")
"""OpenSSL's reasons for an answer that is not TLS."""
_OTHER_KEY = ("KEY_VALUES_MISMATCH", "KEY_TYPE_MISMATCH", "NO_CERTIFICATE_ASSIGNED")
"""OpenSSL's reasons for a key that is not the certificate's, be it of another kind, such as RSA."""
_CERTIFICATE_ALERTS = {
    "TLSV13_ALERT_CERTIFICATE_REQUIRED": "it requires one",
    "TLSV1_ALERT_UNKNOWN_CA": "its issuer is unknown to the server",
    "SSLV3_ALERT_BAD_CERTIFICATE": "it is invalid",
    "SSLV3_ALERT_CERTIFICATE_EXPIRED": "it has expired",
    "SSLV3_ALERT_CERTIFICATE_REVOKED": "it has been revoked",
    "SSLV3_ALERT_CERTIFICATE_UNKNOWN": "it is not accepted",
    "SSLV3_ALERT_UNSUPPORTED_CERTIFICATE": "its extended key usage is not that of a client",
}
"""Explanations of TLS alerts with which a server refuses a client's certificate."""


class Pair(NamedTuple):
    """The names by which a user gives a certificate and its private key, such as options."""

    certificate: str
    key: str


CLIENT = Pair(CLIENT_CERT, CLIENT_KEY)


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
        """Return the given files, or by default the files of the environment variables."""
        given = zip((ca, client_cert, client_key), VARIABLES, strict=True)
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
        try:
            if self.ca is not None:
                load_authorities(context, CA, self.ca)
            if self.client_cert is not None:
                load_pair(context, CLIENT, self.client_cert, self.client_key)
        except AccessError as error:
            raise HubUnreachable(url, str(error)) from None
        return context


def load_authorities(context: ssl.SSLContext, name: str, file: File) -> None:
    """Trust the certificates in a PEM file.

    Args:
        name: how the user has given the file, such as an option, for the error.

    Raises:
        AccessError: the file cannot be used.
    """
    _read(name, file)
    try:
        context.load_verify_locations(file)
    except OSError:  # It includes those of ssl.
        raise AccessError(f"{name}: {file} holds no certificate in PEM format") from None


def load_pair(context: ssl.SSLContext, names: Pair, certificate: File, key: File | None) -> None:
    """Present the certificate in a PEM file.

    Args:
        names: how the user has given the files, for the error.
        key: the file of its private key; None if that is in the same file.

    Raises:
        AccessError: a file cannot be used, or the key has a password.
    """
    content = _read(names.certificate, certificate)
    private = content if key is None else _read(names.key, key)

    def refuse_password() -> str:
        # Otherwise OpenSSL asks on the terminal.
        name = names.certificate if key is None else names.key
        raise AccessError(
            f"{name}: the key has a password; remove it with: openssl pkey -in OLD -out NEW"
        )

    try:
        context.load_cert_chain(certificate, key, password=refuse_password)
    except OSError as error:
        text = _pair_fault(error, names, certificate, key, content, private)
        raise AccessError(text) from None


def _pair_fault(
    error: OSError,
    names: Pair,
    certificate: File,
    key: File | None,
    content: bytes,
    private: bytes,
) -> str:
    """Return why a certificate and its key, which have these contents, cannot be used."""
    if b"-----BEGIN CERTIFICATE-----" not in content:
        return f"{names.certificate}: {certificate} holds no certificate in PEM format"
    if b"PRIVATE KEY-----" not in private:
        if key is None:
            return (
                f"{names.certificate}: {certificate} holds no private key; "
                f"set {names.key} to the file that holds it"
            )
        return f"{names.key}: {key} holds no private key in PEM format"
    reason = getattr(error, "reason", None)
    if reason in _OTHER_KEY:
        return f"{names.key}: {key} is not the key of the first certificate in {certificate}"
    files = certificate if key is None else f"{certificate} with {key}"
    return f"{names.certificate}, {names.key}: cannot use {files}: {_words(reason or str(error))}"


def _read(name: str, file: File) -> bytes:
    try:
        with open(file, "rb") as opened:
            return opened.read()
    except OSError as error:
        raise AccessError(f"{name}: cannot read {file}: {error.strerror}") from None


def _words(reason: str) -> str:
    return reason.lower().replace("_", " ")


def fault(error: BaseException | None) -> str | None:
    """Return why TLS failed, and what to do; None for other errors.

    Args:
        error: the error, or one that it has caused.
    """
    error = _tls_error(error)
    if error is None:
        return None
    text, code = getattr(error, "verify_message", ""), getattr(error, "verify_code", 0)
    if text:
        return f"invalid certificate: {text.rstrip('.')}{_advice(code)}"
    reason = _reason(error)
    if reason in _NO_TLS:
        return "the server does not support TLS; use ws://"
    if alert := _CERTIFICATE_ALERTS.get(reason):
        return f"the server refuses this client's certificate: {alert}; see {CLIENT_CERT}"
    return f"TLS failed: {_words(reason)}"


def end_of(certificate: Mapping[str, Any]) -> float:
    """Return when a certificate ends, in seconds since 1970.

    Args:
        certificate: as the ssl module decodes it.
    """
    import ssl  # Only connections with TLS need it.

    return ssl.cert_time_to_seconds(certificate["notAfter"])


def expects_tls(error: BaseException) -> str | None:
    """Return what to do if a server has answered a request without TLS as one that expects TLS.

    Args:
        error: that of websockets; an alert has 7 bytes, after which the server ends. Caddy,
            Traefik and other programs in Go send a line of HTTP/1.0.
    """
    fault: BaseException | None = error
    while fault is not None:
        if "after 7 bytes" in str(fault) or "HTTP/1.0 400" in str(fault):
            return "the server expects TLS; use wss://"
        fault = fault.__cause__
    return None


def refuses_certificate(error: BaseException) -> bool:
    """Return whether the server has refused this client's certificate.

    Args:
        error: as of `fault`.
    """
    found = _tls_error(error)
    return found is not None and _reason(found) in _CERTIFICATE_ALERTS


def _tls_error(error: BaseException | None) -> BaseException | None:
    while error is not None and type(error).__module__ != "ssl":  # This avoids importing ssl.
        error = error.__cause__ or error.__context__
    return error


def _reason(error: BaseException) -> str:
    return getattr(error, "reason", None) or str(error)


def _advice(code: int) -> str:
    if code in _UNKNOWN_ISSUER:
        return f"; to trust it, set {CA}=FILE (PEM) or use --ca FILE, the hub's or its authority's"
    if code in _OTHER_NAME:
        return "; connect by a name that is in it"
    if code == _EXPIRED:
        return "; renew it at the hub, or set this machine's clock"
    return "; set this machine's clock" if code == _NOT_YET_VALID else ""


def _path(file: File | None) -> str | None:
    return None if file is None else os.fspath(file)
