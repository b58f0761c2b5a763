"""The file of tokens: the principals that a hub accepts, and their rights.

It is TOML, and holds digests only: a token is shown once, when it is made. A token has 256 random
bits, so that a plain SHA-256 of it cannot be reversed, as that of a password could.

    [tokens.teleop]
    sha256 = "6b86b273ff34fce19d6b804eff5a3f5747ada4eaa22f1d49c01e52ddb7875b4b"
    expires = 2027-01-01T00:00:00Z

    [tokens.teleop.allow]
    publish = ["/cmd_vel"]
    subscribe = ["/**"]

    [tokens.teleop.limits]
    connections = 3
    messages_per_second = 200

    [certificates.robot1]
    allow = {publish = ["/robot1/**"], node = ["/robot1/**"]}

    [anonymous]
    allow = {subscribe = ["/map"]}

    [ros1]
    allow = {publish = ["/**"], node = ["/**"]}
"""

from __future__ import annotations

import hashlib
import hmac
import re
import secrets
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, date, datetime, time
from pathlib import Path
from typing import Any, Self

from fibws.access.limits import Limits
from fibws.access.rights import (
    KEYS,
    RIGHTS,
    Principal,
    Proof,
    Right,
    Rights,
    check_keys,
    check_name,
)
from fibws.errors import AccessError
from fibws.files import locked, replace_file
from fibws.suggestions import suggestion, suggestion_or_known

PREFIX = "fibws_"
"""How tokens begin, so that programs that look for published secrets find them."""
ANONYMOUS = "anonymous"
"""The principal of clients without a token."""
NETWORKS = ("ros1", "ros2", "zenoh", "join")
"""The principals of what joins without a token of the hub: nodes of ROS 1 and of ROS 2, the hubs on
a zenoh network, and the hubs that this one joins."""
_DIGEST = re.compile(r"[0-9a-f]{64}")
_SECTIONS = ("tokens", "certificates", ANONYMOUS, *NETWORKS)
_EVERYTHING: dict[Right, tuple[str, ...]] = {right: ("/**",) for right in RIGHTS}
_UNLIMITED = {
    name: Principal(name, Rights(_EVERYTHING, name=name), proof="network") for name in NETWORKS
}
"""The same principals where no section limits what they may do."""
_KEYS = ("expires", *KEYS, "limits")


@dataclass(frozen=True)
class Tokens:
    """The principals of a file.

    Attributes:
        tokens: by the digests of their tokens.
        certificates: by the common names of their certificates.
        anonymous: the principal of clients without a token; None if these may not connect.
        networks: the principals of `NETWORKS`.
    """

    tokens: Mapping[str, Principal]
    certificates: Mapping[str, Principal]
    anonymous: Principal | None
    networks: Mapping[str, Principal] = field(default_factory=_UNLIMITED.copy)

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read a file; raise `AccessError` if it cannot be read or is invalid."""
        return cls.parse(_read(path), str(path))

    @classmethod
    def parse(cls, text: str, source: str) -> Self:
        """Return the principals of a text; ``source`` names it in errors."""
        try:
            return cls._parse(tomllib.loads(text))
        except (AccessError, tomllib.TOMLDecodeError) as error:
            raise AccessError(f"{source}: {error}") from None

    @classmethod
    def _parse(cls, document: dict[str, Any]) -> Self:
        for section in document:
            if section not in _SECTIONS:
                known = suggestion_or_known(section, _SECTIONS)
                raise AccessError(f"unknown section {section}{known}")
        tokens: dict[str, Principal] = {}
        for name, table in _tables(document, "tokens"):
            where = f"tokens.{name}"
            digest = table.get("sha256")
            if not isinstance(digest, str) or not _DIGEST.fullmatch(digest):
                fault = "must be the 64 lower-case hexadecimal digits of a token's SHA-256"
                raise AccessError(f"{where}.sha256 {fault}")
            if digest in tokens:
                raise AccessError(f"{where} has the same token as {tokens[digest].name}")
            tokens[digest] = _principal(name, table, where, "token")
        certificates = {
            name: _principal(name, table, f"certificates.{name}", "certificate")
            for name, table in _tables(document, "certificates")
        }
        anonymous = None
        if ANONYMOUS in document:
            table = _table(document, ANONYMOUS)
            anonymous = _principal(ANONYMOUS, table, ANONYMOUS, "anonymous")
        networks = {
            name: _principal(name, _table(document, name), name, "network")
            for name in NETWORKS
            if name in document
        }
        return cls(tokens, certificates, anonymous, {**_UNLIMITED, **networks})

    def changes(self, old: Self) -> list[str]:
        """Return what differs from an older content, as in ``token teleop revoked``."""
        return [
            *_differences("token", _by_name(old.tokens), _by_name(self.tokens), gone="revoked"),
            *_differences("certificate", old.certificates, self.certificates),
            *_differences("section", old._sections(), self._sections()),
        ]

    def _sections(self) -> dict[str, Principal]:
        found = {name: each for name, each in self.networks.items() if each != _UNLIMITED[name]}
        return found if self.anonymous is None else {ANONYMOUS: self.anonymous, **found}

    def find(self, token: str) -> Principal | None:
        """Return the principal of a token, which may have expired; None if it is unknown."""
        digest = digest_of(token)
        found = None
        # Every one is compared, in a time that does not depend on where two digests differ.
        for known, principal in self.tokens.items():
            if hmac.compare_digest(known, digest):
                found = principal
        return found


class TokenFile:
    """Editor of a file of tokens, which keeps its comments and the rest of it.

    Several programs may edit the file at once. It keeps its owner and its permissions; a new one is
    readable by its owner only.

    Args:
        path: of the file, which need not exist yet.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    def add(self, name: str, rights: Rights, expires: datetime | None = None) -> str:
        """Add a principal and return its new token, which is not kept.

        Raises:
            AccessError: the name is taken or invalid, or the file is invalid or cannot be written.
        """
        import tomlkit

        check_name(name)
        token = PREFIX + secrets.token_urlsafe(32)
        table: dict[str, Any] = {"sha256": digest_of(token)}
        if expires is not None:
            table["expires"] = expires.astimezone(UTC).replace(microsecond=0)
        with self._edit() as (document, names):
            if name in names:
                raise AccessError(f"{self._path} has a token {name} already; revoke it first")
            if "tokens" not in document:
                document["tokens"] = tomlkit.table(is_super_table=True)
            document["tokens"][name] = tomlkit.item({**table, **rights.table()})
        return token

    def revoke(self, name: str) -> None:
        """Remove a principal's token.

        Raises:
            AccessError: the token is unknown, or the file is invalid or cannot be written.
        """
        with self._edit() as (document, names):
            if name not in names:
                raise AccessError(f"{self._path} has no token {name}{suggestion(name, names)}")
            del document["tokens"][name]

    @contextmanager
    def _edit(self) -> Iterator[tuple[Any, list[str]]]:
        """Yield the document and the names of its tokens, then write the document."""
        import tomlkit  # Only the commands that edit the file need it.

        try:
            with locked(self._path):
                text = _read(self._path) if self._path.exists() else ""
                tokens = Tokens.parse(text, str(self._path)).tokens
                document: Any = tomlkit.parse(text)
                yield document, [each.name for each in tokens.values()]
                text = document.as_string()
                Tokens.parse(text, str(self._path))
                replace_file(self._path, text.encode(), 0o600, keep=True)
        except OSError as error:
            raise AccessError(f"cannot write {self._path}: {error.strerror}") from None


def digest_of(token: str) -> str:
    """Return the digest by which the file knows a token."""
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).hexdigest()


def _by_name(tokens: Mapping[str, Principal]) -> dict[str, tuple[str, Principal]]:
    return {each.name: (digest, each) for digest, each in tokens.items()}


def _differences(
    kind: str, old: Mapping[str, object], new: Mapping[str, object], gone: str = "removed"
) -> Iterator[str]:
    for name in {**old, **new}:
        if old.get(name) != new.get(name):
            did = "added" if name not in old else gone if name not in new else "changed"
            yield f"{kind} {name} {did}"


def _read(path: Path) -> str:
    try:
        return path.read_text("utf-8-sig")
    except UnicodeDecodeError:
        raise AccessError(f"{path} is not UTF-8") from None
    except OSError as error:
        raise AccessError(f"cannot read {path}: {error.strerror}") from None


def _tables(document: dict[str, Any], section: str) -> list[tuple[str, dict[str, Any]]]:
    found = _table(document, section) if section in document else {}
    if ANONYMOUS in found:
        raise AccessError(f"{section}.{ANONYMOUS}: this name is for clients without a token")
    return [(check_name(name), _table(found, name, f"{section}.{name}")) for name in found]


def _table(above: dict[str, Any], key: str, where: str | None = None) -> dict[str, Any]:
    found = above[key]
    if not isinstance(found, dict):
        raise AccessError(f"{where or key} must be a table")
    return found


def _principal(name: str, table: dict[str, Any], where: str, proof: Proof) -> Principal:
    check_keys(table, ("sha256", *_KEYS) if proof == "token" else _KEYS, where)
    rights = Rights.parse(table, name=name, where=where)
    expires = _seconds(table.get("expires"), f"{where}.expires")
    limits = Limits.parse(table.get("limits", {}), f"{where}.limits")
    return Principal(name, rights, expires, limits, proof)


def _seconds(value: object, where: str) -> float | None:
    """Return seconds since 1970 of a date or a date-time, which is UTC if it names no zone."""
    if value is None:
        return None
    if isinstance(value, date) and not isinstance(value, datetime):
        value = datetime.combine(value, time())
    if not isinstance(value, datetime):
        raise AccessError(f"{where} must be a date, such as 2027-01-01T00:00:00Z, got {value!r}")
    return (value if value.tzinfo else value.replace(tzinfo=UTC)).timestamp()
