"""Certificates for tests of TLS, by an authority of their own."""

from __future__ import annotations

import ssl
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
import trustme
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID


class Authority:
    """An authority, and the files of its certificates."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._ca = trustme.CA()
        self.file = folder / "ca.pem"
        """The authority's own certificate."""
        self._ca.cert_pem.write_to_path(self.file)

    def issue(
        self,
        *names: str,
        common_name: str = "hub",
        file: str = "hub",
        expires: datetime | None = None,
    ) -> tuple[Path, Path]:
        """Write a certificate and its key into files, and return their paths.

        Args:
            names: host names and IP addresses; by default 127.0.0.1.
        """
        made = self._ca.issue_cert(
            *(names or ("127.0.0.1",)), common_name=common_name, not_after=expires
        )
        certificate, key = self._folder / f"{file}.pem", self._folder / f"{file}.key"
        certificate.write_bytes(b"".join(each.bytes() for each in made.cert_chain_pems))
        made.private_key_pem.write_to_path(key)
        return certificate, key

    def issue_for_servers(self, common_name: str) -> tuple[Path, Path]:
        """Write a certificate that must not be used by clients, and its key; return their paths."""
        names = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, common_name)])
        now, key = datetime.now(UTC), ec.generate_private_key(ec.SECP256R1())
        usage = x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH])
        issuer = x509.load_pem_x509_certificate(self.file.read_bytes())
        made = (
            x509.CertificateBuilder(issuer.subject, names, key.public_key())
            .serial_number(x509.random_serial_number())
            .not_valid_before(now - timedelta(days=1))
            .not_valid_after(now + timedelta(days=1))
            .add_extension(usage, critical=False)
            .sign(self._key(), hashes.SHA256())
        )
        certificate = self._folder / f"{common_name}.pem"
        certificate.write_bytes(made.public_bytes(serialization.Encoding.PEM))
        file = certificate.with_suffix(".key")
        file.write_bytes(_private(key, serialization.NoEncryption()))
        return certificate, file

    def revocations(self, certificate: Path) -> bytes:
        """Return a list of revoked certificates (CRL) with one, in PEM."""
        revoked = x509.load_pem_x509_certificate(certificate.read_bytes())
        now = datetime.now(UTC)
        entry = x509.RevokedCertificateBuilder(revoked.serial_number, now).build()
        builder = x509.CertificateRevocationListBuilder(revoked.issuer, now, now + timedelta(1))
        made = builder.add_revoked_certificate(entry).sign(self._key(), hashes.SHA256())
        return made.public_bytes(serialization.Encoding.PEM)

    def _key(self) -> ec.EllipticCurvePrivateKey:
        key = serialization.load_pem_private_key(self._ca.private_key_pem.bytes(), None)
        assert isinstance(key, ec.EllipticCurvePrivateKey)
        return key

    def client(self, certificate: tuple[Path, Path] | None = None) -> ssl.SSLContext:
        """Return the context of a client that trusts the authority, and may have a certificate.

        It is not for `websockets.sync`: that reads and writes at once, in two threads, which
        OpenSSL does not allow: now and then a handshake gets no response.
        """
        context = ssl.create_default_context(cafile=self.file)
        if certificate is not None:
            context.load_cert_chain(*certificate)
        return context


def add_password(key: Path) -> None:
    """Encrypt a private key, in its file."""
    plain = serialization.load_pem_private_key(key.read_bytes(), None)
    assert isinstance(plain, ec.EllipticCurvePrivateKey)
    key.write_bytes(_private(plain, serialization.BestAvailableEncryption(b"secret")))


def _private(
    key: ec.EllipticCurvePrivateKey, encryption: serialization.KeySerializationEncryption
) -> bytes:
    return key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, encryption
    )


@pytest.fixture
def authority(tmp_path: Path) -> Authority:
    """An authority with no certificates yet."""
    return Authority(tmp_path)
