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

    def revocations(self, certificate: Path) -> bytes:
        """Return a list of revoked certificates (CRL) with one, in PEM."""
        revoked = x509.load_pem_x509_certificate(certificate.read_bytes())
        now = datetime.now(UTC)
        entry = x509.RevokedCertificateBuilder(revoked.serial_number, now).build()
        key = serialization.load_pem_private_key(self._ca.private_key_pem.bytes(), None)
        assert isinstance(key, ec.EllipticCurvePrivateKey)
        builder = x509.CertificateRevocationListBuilder(revoked.issuer, now, now + timedelta(1))
        made = builder.add_revoked_certificate(entry).sign(key, hashes.SHA256())
        return made.public_bytes(serialization.Encoding.PEM)

    def client(self, certificate: tuple[Path, Path] | None = None) -> ssl.SSLContext:
        """Return the context of a client that trusts the authority, and may have a certificate.

        It is not for `websockets.sync`: that reads and writes at once, in two threads, which
        OpenSSL does not allow: now and then a handshake gets no response.
        """
        context = ssl.create_default_context(cafile=self.file)
        if certificate is not None:
            context.load_cert_chain(*certificate)
        return context


@pytest.fixture
def authority(tmp_path: Path) -> Authority:
    """An authority with no certificates yet."""
    return Authority(tmp_path)
