"""The certificate that a machine makes for itself."""

from __future__ import annotations

import os
import ssl
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub
from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import (
    BestAvailableEncryption,
    Encoding,
    NoEncryption,
    PrivateFormat,
)
from hub_reload import reloaded
from websockets.asyncio.client import connect

import fibws
from fibws.errors import HubError
from fibws.hub import Settings
from fibws.hub.announcement import announcement
from fibws.hub.tls import self_signed
from fibws.hub.tls.self_signed import Files, ensure_certificate

LAN = "192.168.1.20"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder that the certificate is kept in."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setattr("socket.gethostname", lambda: "Robot-7")
    return tmp_path


def contents(files: Files) -> tuple[bytes, bytes]:
    return files.certificate.read_bytes(), files.authority.read_bytes()


def names(files: Files) -> set[str]:
    certificate = x509.load_pem_x509_certificate(files.certificate.read_bytes())
    found = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    addresses = map(str, found.get_values_for_type(x509.IPAddress))
    return {*found.get_values_for_type(x509.DNSName), *addresses}


def set_clock(monkeypatch: pytest.MonkeyPatch, ahead: timedelta) -> None:
    class Clock(datetime):
        @classmethod
        def now(cls, tz: Any = None) -> Any:
            return datetime.now(tz) + ahead

    monkeypatch.setattr(self_signed, "datetime", Clock)


def test_certificate_holds_all_names_and_addresses() -> None:
    own = {"localhost", "robot-7", "robot-7.local", "127.0.0.1", "::1"}
    assert names(ensure_certificate([LAN, "2001:db8::5"])) == own | {LAN, "2001:db8::5"}


def test_certificate_is_valid_for_about_a_year_and_its_key_is_private() -> None:
    files = ensure_certificate([])
    certificate = x509.load_pem_x509_certificate(files.certificate.read_bytes())
    left = certificate.not_valid_after_utc - datetime.now(UTC)
    assert timedelta(days=365) < left < timedelta(days=398)
    keys = [path for path in files.certificate.parent.iterdir() if b"PRIVATE" in path.read_bytes()]
    assert len(keys) == 2 and all(path.stat().st_mode & 0o777 == 0o600 for path in keys)


def test_hubs_that_start_at_once_have_one_authority() -> None:
    """A hub whose authority another one has replaced would not be trusted."""
    together = threading.Barrier(4)

    def start() -> bytes:
        together.wait()
        return ensure_certificate([]).authority.read_bytes()

    with ThreadPoolExecutor(4) as threads:
        assert len({each.result() for each in [threads.submit(start) for _ in range(4)]}) == 1


def test_folder_of_the_keys_is_private_whatever_the_umask() -> None:
    old = os.umask(0)
    try:
        folder = ensure_certificate([]).certificate.parent
    finally:
        os.umask(old)
    for each in (folder, folder.parent):
        assert each.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("addresses", [[LAN], []])
def test_certificate_is_kept(addresses: list[str]) -> None:
    before = contents(ensure_certificate([LAN]))
    assert contents(ensure_certificate(addresses)) == before


def test_new_address_is_added_and_the_authority_stays() -> None:
    certificate, authority = contents(ensure_certificate([LAN]))
    files = ensure_certificate(["10.0.0.7"])
    assert contents(files)[0] != certificate
    assert contents(files)[1] == authority
    assert names(files) >= {LAN, "10.0.0.7"}


def test_addresses_of_earlier_networks_do_not_pile_up() -> None:
    for number in range(80):
        files = ensure_certificate([f"10.0.0.{number}"])
    assert "10.0.0.79" in names(files)
    assert len(names(files)) < 70


def test_certificate_that_expires_soon_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    certificate, authority = contents(ensure_certificate([]))
    set_clock(monkeypatch, timedelta(days=300))
    assert contents(ensure_certificate([])) == (certificate, authority)
    set_clock(monkeypatch, timedelta(days=380))
    files = ensure_certificate([])
    assert contents(files)[0] != certificate and contents(files)[1] == authority


def test_renamed_machine_gets_a_new_authority(monkeypatch: pytest.MonkeyPatch) -> None:
    before = contents(ensure_certificate([]))
    monkeypatch.setattr("socket.gethostname", lambda: "arm")
    files = ensure_certificate([])
    assert contents(files)[1] != before[1]
    assert "arm.local" in names(files)


@pytest.mark.parametrize("name", ["", "my_robot!", "ä"])
def test_odd_name_of_a_machine_is_left_out(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("socket.gethostname", lambda: name)
    assert names(ensure_certificate([])) == {"localhost", "127.0.0.1", "::1"}


@pytest.mark.parametrize("file", ["hub.pem", "ca.key.pem"])
@pytest.mark.parametrize("content", ["", "nonsense"])
def test_broken_file_is_replaced(folder: Path, file: str, content: str) -> None:
    ensure_certificate([])
    (folder / "fibws" / "self-signed" / file).write_text(content)
    files = ensure_certificate([])
    context = ssl.create_default_context(cafile=files.authority)
    context.load_cert_chain(files.certificate)


def odd_certificate(*, password: bytes | None = None, own_key: bool = True) -> bytes:
    """Return a certificate without any extension, and a key."""
    key, other = (ec.generate_private_key(ec.SECP256R1()) for _ in range(2))
    name = x509.Name([])
    now = datetime.now(UTC)
    made = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(1)
        .not_valid_before(now)
        .not_valid_after(now + timedelta(days=365))
        .sign(key, hashes.SHA256())
    )
    encryption = NoEncryption() if password is None else BestAvailableEncryption(password)
    pem = (key if own_key else other).private_bytes(Encoding.PEM, PrivateFormat.PKCS8, encryption)
    return made.public_bytes(Encoding.PEM) + pem


@pytest.mark.parametrize("file", ["hub.pem", "ca.key.pem"])
@pytest.mark.parametrize(
    "options",
    [{}, {"password": b"secret"}, {"own_key": False}],
    ids=["no extensions", "password", "key of another certificate"],
)
def test_certificate_of_another_program_is_replaced(
    folder: Path, file: str, options: dict[str, Any]
) -> None:
    ensure_certificate([])
    (folder / "fibws" / "self-signed" / file).write_bytes(odd_certificate(**options))
    files = ensure_certificate([])
    context = ssl.create_default_context(cafile=files.authority)
    context.load_cert_chain(files.certificate)
    assert "robot-7" in names(files)


def test_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cryptography", None)
    with pytest.raises(HubError, match=r"fibws\[auth\]"):
        ensure_certificate([])


def test_folder_that_cannot_be_written_is_named(folder: Path) -> None:
    (folder / "fibws").write_text("a file")
    with pytest.raises(HubError, match=r"self_signed=.*: cannot write .*fibws"):
        ensure_certificate([])


async def test_nodes_trust_the_authority(start_hub: StartHub) -> None:
    hub = await start_hub(self_signed=True)
    async with fibws.Node("node", hub=hub.url, ca=self_signed.files().authority) as node:
        assert "/node" in await node.graph.nodes()


async def test_reload_adds_new_addresses(
    start_hub: StartHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    hub = await start_hub(self_signed=True)
    monkeypatch.setattr("fibws.hub.server.machine_addresses", lambda: ["203.0.113.9"])
    await reloaded(hub)
    context = ssl.create_default_context(cafile=self_signed.files().authority)
    async with connect(hub.url, ssl=context) as client:
        certificate = client.transport.get_extra_info("ssl_object").getpeercert()
        assert ("IP Address", "203.0.113.9") in certificate["subjectAltName"]


@pytest.mark.parametrize(
    ("host", "fact"), [("0.0.0.0", f"https://{LAN}:9090/"), ("127.0.0.1", "--host")]
)
def test_announcement_says_what_to_open_on_a_phone(
    host: str, fact: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.hub.announcement.machine_addresses", lambda: [LAN])
    text = announcement(Settings(self_signed=True, host=host), "wss://127.0.0.1:9090")
    assert any("hone" in line and fact in line for line in text.splitlines())
    assert f"FIBWS_CA={self_signed.files().authority}" in text
    assert "http://" not in text and "ws://" not in text
