"""A certificate made by this machine, for development: ``fibws hub --self-signed``.

Phones offer sensors, cameras and gamepads to pages with TLS only. The certificate holds all names
and addresses of this machine; it is kept, so that a phone need accept it once only. An authority
that is made with it signs its successors: nodes that trust the authority trust them, too. The
authority can only vouch for IP addresses and for names of this machine, so that its key, if stolen,
forges no web site.
"""

from __future__ import annotations

import ipaddress
import re
import socket
from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from fibws.errors import SettingError
from fibws.files import locked, make_private, replace_file, state_folder

if TYPE_CHECKING:
    from cryptography import x509
    from cryptography.hazmat.primitives.asymmetric.ec import EllipticCurvePrivateKey

    _Extension = TypeVar("_Extension", bound=x509.ExtensionType)

CERTIFICATE_DAYS = 397
"""Browsers accept no certificates that are valid for longer."""
AUTHORITY_DAYS = 3650
RENEWAL_DAYS = 30
"""A certificate is replaced if it is not valid for as many days."""
MOST_ADDRESSES = 64
"""Addresses in a certificate; those of earlier networks are kept up to this number."""
_NAME = re.compile(r"[a-z0-9]([a-z0-9-]*[a-z0-9])?(\.[a-z0-9]([a-z0-9-]*[a-z0-9])?)*")


class Files(NamedTuple):
    """Where the certificates are.

    Attributes:
        certificate: the hub's certificate and its key.
        authority: the authority's certificate, for clients to trust.
    """

    certificate: Path
    authority: Path


def files() -> Files:
    """Return the files' paths, in `state_folder`."""
    folder = state_folder() / "self-signed"
    return Files(folder / "hub.pem", folder / "ca.pem")


def ensure_certificate(addresses: Iterable[str]) -> Files:
    """Make the certificate if it is missing, expires soon, or lacks a name or an address.

    Args:
        addresses: this machine's IP addresses, besides those of the loopback interface.

    Raises:
        HubError: the package cryptography is not installed, or a file cannot be written.
    """
    if find_spec("cryptography") is None:
        raise SettingError(
            "--self-signed requires the package cryptography: python -m pip install 'fibws[auth]'"
        ) from None
    found = files()
    try:
        make_private(found.certificate.parent)
        found.certificate.parent.chmod(0o700)  # Whoever may write to it could replace the keys.
        with locked(found.certificate):  # Several hubs may start at once.
            _Maker(found, _names(), {"127.0.0.1", "::1", *addresses}).ensure()
    except OSError as error:
        raise SettingError(
            f"--self-signed: cannot write {error.filename or found.certificate}: {error.strerror}"
        ) from None
    return found


def _names() -> list[str]:
    """Return the names by which this machine is reached."""
    name = socket.gethostname().lower()
    names = {"localhost", name, f"{name.partition('.')[0]}.local"}
    return sorted(each for each in names if _NAME.fullmatch(each))


class _Maker:
    """Makes the certificates for names and addresses."""

    def __init__(self, paths: Files, names: list[str], addresses: set[str]) -> None:
        self._paths = paths
        self._names = names
        self._addresses = addresses
        self._now = datetime.now(UTC)
        self._authority_file = paths.authority.with_suffix(".key.pem")

    def ensure(self) -> None:
        """Write the files that have to be written."""
        authority = _read(self._authority_file)
        if authority is None or not self._is_authority_fit(authority[0]):
            authority = self._make_authority()
        certificate, key = authority
        replace_file(self._paths.authority, _pem(certificate), 0o644)
        found = _read(self._paths.certificate)
        if found is None or not self._is_fit(found[0], certificate):
            self._make(certificate, key, None if found is None else found[0])

    def _is_authority_fit(self, authority: x509.Certificate) -> bool:
        from cryptography import x509

        constraints = _extension(authority, x509.NameConstraints)
        subtrees = () if constraints is None else constraints.permitted_subtrees or ()
        allowed = {str(each.value) for each in subtrees}
        return self._lasts(authority) and allowed.issuperset(self._names)

    def _is_fit(self, certificate: x509.Certificate, authority: x509.Certificate) -> bool:
        names, addresses = _subject(certificate)
        try:
            certificate.verify_directly_issued_by(authority)
        except Exception:  # InvalidSignature, ValueError, TypeError: another authority's.
            return False
        has_all = names.issuperset(self._names) and addresses.issuperset(self._addresses)
        return has_all and self._lasts(certificate)

    def _lasts(self, certificate: x509.Certificate) -> bool:
        return certificate.not_valid_after_utc - self._now > timedelta(days=RENEWAL_DAYS)

    def _make_authority(self) -> tuple[x509.Certificate, EllipticCurvePrivateKey]:
        from cryptography import x509
        from cryptography.hazmat.primitives import hashes
        from cryptography.hazmat.primitives.asymmetric import ec

        key = ec.generate_private_key(ec.SECP256R1())
        name = _distinguished(f"fibws on {socket.gethostname()}"[:64])
        anything = (ipaddress.ip_network("0.0.0.0/0"), ipaddress.ip_network("::/0"))
        permitted: list[x509.GeneralName] = [x509.DNSName(each) for each in self._names]
        permitted += [x509.IPAddress(each) for each in anything]
        identifier = x509.SubjectKeyIdentifier.from_public_key(key.public_key())
        made = (
            self._builder(AUTHORITY_DAYS)
            .subject_name(name)
            .issuer_name(name)
            .public_key(key.public_key())
            .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
            .add_extension(_key_usage(key_cert_sign=True, crl_sign=True), critical=True)
            .add_extension(x509.NameConstraints(permitted, None), critical=True)
            .add_extension(identifier, critical=False)
            .sign(key, hashes.SHA256())
        )
        replace_file(self._authority_file, _pem(made) + _pem_of_key(key), 0o600)
        return made, key

    def _make(
        self,
        authority: x509.Certificate,
        authority_key: EllipticCurvePrivateKey,
        old: x509.Certificate | None,
    ) -> None:
        from cryptography import x509
        from cryptography.hazmat.primitives import hashes
        from cryptography.hazmat.primitives.asymmetric import ec
        from cryptography.x509.oid import ExtendedKeyUsageOID

        key = ec.generate_private_key(ec.SECP256R1())
        addresses = set(self._addresses)
        if old is not None:
            earlier = _subject(old)[1] - addresses
            addresses |= set(sorted(earlier)[: max(0, MOST_ADDRESSES - len(addresses))])
        subjects: list[x509.GeneralName] = [x509.DNSName(each) for each in self._names]
        subjects += [x509.IPAddress(ipaddress.ip_address(each)) for each in sorted(addresses)]
        issuer_key = authority_key.public_key()
        made = (
            self._builder(CERTIFICATE_DAYS)
            .subject_name(_distinguished(socket.gethostname()[:64] or "hub"))
            .issuer_name(authority.subject)
            .public_key(key.public_key())
            .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
            .add_extension(_key_usage(digital_signature=True), critical=True)
            .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
            .add_extension(x509.SubjectAlternativeName(subjects), critical=False)
            .add_extension(
                x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False
            )
            .add_extension(
                x509.AuthorityKeyIdentifier.from_issuer_public_key(issuer_key), critical=False
            )
            .sign(authority_key, hashes.SHA256())
        )
        replace_file(self._paths.certificate, _pem(made) + _pem_of_key(key), 0o600)

    def _builder(self, days: int) -> x509.CertificateBuilder:
        from cryptography import x509

        # Clocks of phones may be late.
        begin = self._now - timedelta(days=1)
        return (
            x509.CertificateBuilder()
            .serial_number(x509.random_serial_number())
            .not_valid_before(begin)
            .not_valid_after(begin + timedelta(days=days))
        )


def _key_usage(**uses: bool) -> x509.KeyUsage:
    from cryptography import x509

    names = (
        *("digital_signature", "content_commitment", "key_encipherment", "data_encipherment"),
        *("key_agreement", "key_cert_sign", "crl_sign", "encipher_only", "decipher_only"),
    )
    return x509.KeyUsage(**{name: uses.get(name, False) for name in names})


def _distinguished(name: str) -> x509.Name:
    from cryptography import x509
    from cryptography.x509.oid import NameOID

    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])


def _subject(certificate: x509.Certificate) -> tuple[set[str], set[str]]:
    """Return the names and the addresses in a certificate."""
    from cryptography import x509

    found = _extension(certificate, x509.SubjectAlternativeName)
    if found is None:
        return set(), set()
    addresses = found.get_values_for_type(x509.IPAddress)
    return set(found.get_values_for_type(x509.DNSName)), {str(each) for each in addresses}


def _extension(certificate: x509.Certificate, kind: type[_Extension]) -> _Extension | None:
    """Return an extension of a certificate; None if it is missing or invalid."""
    from cryptography import x509

    try:
        return certificate.extensions.get_extension_for_class(kind).value
    except (
        x509.ExtensionNotFound,
        x509.DuplicateExtension,
        x509.UnsupportedGeneralNameType,
        ValueError,
    ):
        return None


def _pem(certificate: x509.Certificate) -> bytes:
    from cryptography.hazmat.primitives.serialization import Encoding

    return certificate.public_bytes(Encoding.PEM)


def _pem_of_key(key: EllipticCurvePrivateKey) -> bytes:
    from cryptography.hazmat.primitives import serialization

    return key.private_bytes(
        serialization.Encoding.PEM,
        serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    )


def _read(path: Path) -> tuple[x509.Certificate, EllipticCurvePrivateKey] | None:
    """Return a certificate and its key; None if the file does not hold both."""
    from cryptography import x509
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.asymmetric.ec import EllipticCurvePrivateKey
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    try:
        text = path.read_bytes()
        certificate, key = x509.load_pem_x509_certificate(text), load_pem_private_key(text, None)
        is_its_key = certificate.public_key() == key.public_key()
    except (FileNotFoundError, ValueError, TypeError, UnsupportedAlgorithm):
        return None  # TypeError: the key has a password.
    return (certificate, key) if is_its_key and isinstance(key, EllipticCurvePrivateKey) else None
