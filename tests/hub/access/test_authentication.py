"""Authentication: tokens of the file, JSON web tokens, and whoever tries wrong ones."""

from __future__ import annotations

import base64
import hmac
import json
import logging
from pathlib import Path
from typing import Any

import jwt
import pytest
from cryptography.hazmat.primitives import serialization
from cryptography.hazmat.primitives.asymmetric import ec, ed25519, rsa
from websockets.datastructures import Headers

from fibws.access.token_file import digest_of
from fibws.errors import AccessError, AuthenticationError, HubError
from fibws.hub.access.authentication import (
    MOST_WRONG,
    Authentication,
    AuthoritiesChanged,
    Certificate,
    WrongTokens,
    token_in,
)
from fibws.hub.errors import TooManyAttempts
from fibws.hub.settings import Settings

NOW = 1_800_000_000.0
ADDRESS = "192.0.2.1"
SECRET = b"0123456789abcdef0123456789abcdef"


class Clock:
    now = NOW

    def __call__(self) -> float:
        return self.now


def tokens(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "tokens.toml"
    path.write_text(text, "utf-8")
    return path


def entry(name: str, token: str, more: str = "") -> str:
    return f'[tokens.{name}]\nsha256 = "{digest_of(token)}"\n{more}\n'


# Where a token is.


@pytest.mark.parametrize(
    ("headers", "path", "offered", "token"),
    [
        ({}, "/", [], None),
        ({"Authorization": "Bearer abc"}, "/", [], "abc"),
        ({"Authorization": "bearer  abc "}, "/", [], "abc"),
        ({"Authorization": "Basic abc"}, "/", [], None),
        ({"Authorization": "Bearer"}, "/", [], ""),
        ({}, "/?token=abc", [], "abc"),
        ({}, "/?node=/x&token=a%2Bb", [], "a+b"),
        ({}, "/?token=", [], ""),
        ({}, "/", ["fibws.v1", "fibws.token.abc"], "abc"),
        ({"Cookie": "fibws_token=abc"}, "/", [], None),
        ({"Authorization": "Bearer abc"}, "/?token=y", ["fibws.token.z"], "abc"),
    ],
)
def test_token_is_found(
    headers: dict[str, str], path: str, offered: list[str], token: str | None
) -> None:
    assert token_in(Headers(headers), path, offered) == token


# The file of tokens.


def test_client_is_whom_its_token_names(tmp_path: Path) -> None:
    path = tokens(tmp_path, entry("ann", "one") + entry("bob", "two"))
    authentication = Authentication(Settings(tokens=path), Clock())
    for token, name in (("one", "ann"), ("two", "bob")):
        headers = Headers(Authorization=f"Bearer {token}")
        login = authentication.log_in(headers, "/", [], None, ADDRESS)
        assert login is not None
        assert login.principal.name == name
    assert authentication.log_in(Headers(), "/", [], None, ADDRESS) is None


@pytest.mark.parametrize("token", ["three", "", "One", "x" * 10_000, digest_of("one"), "a.b.c"])
def test_wrong_token_is_refused_even_where_anonymous_may_enter(tmp_path: Path, token: str) -> None:
    path = tokens(tmp_path, entry("ann", "one") + "[anonymous]")
    authentication = Authentication(Settings(tokens=path), Clock())
    with pytest.raises(AuthenticationError) as raised:
        authentication.log_in(Headers(Authorization=f"Bearer {token}"), "/", [], None, ADDRESS)
    assert not token or token not in str(raised.value)
    login = authentication.log_in(Headers(), "/", [], None, ADDRESS)
    assert login is not None
    assert login.principal.name == "anonymous"


def test_expired_token_is_refused(tmp_path: Path) -> None:
    path = tokens(tmp_path, entry("ann", "one", "expires = 2027-01-15T08:00:00Z"))
    clock = Clock()
    authentication = Authentication(Settings(tokens=path), clock)
    clock.now = NOW - 1
    login = authentication.log_in_by_token("one", ADDRESS)
    clock.now = NOW
    with pytest.raises(AuthenticationError, match="expired"):
        login.again()


def test_reload_changes_who_may_enter(tmp_path: Path) -> None:
    path = tokens(tmp_path, entry("ann", "one"))
    authentication = Authentication(Settings(tokens=path), Clock())
    login = authentication.log_in_by_token("one", ADDRESS)
    tokens(tmp_path, "[tokens")
    with pytest.raises(AccessError):
        authentication.reload()
    assert login.again().name == "ann"
    tokens(tmp_path, entry("bob", "two"))
    authentication.reload()
    with pytest.raises(AuthenticationError, match="unknown token"):
        login.again()
    assert authentication.log_in_by_token("two", ADDRESS).principal.name == "bob"


def test_missing_file_is_an_error_of_the_hub(tmp_path: Path) -> None:
    with pytest.raises(HubError, match=r"none\.toml"):
        Authentication(Settings(tokens=tmp_path / "none.toml"), Clock())


# Certificates.


def tls_files(folder: Path) -> dict[str, Any]:
    """Return the settings of TLS, with certificates of clients; nothing reads the files."""
    return {name: folder / f"{name}.pem" for name in ("cert", "key", "client_ca")}


def test_certificate_stands_for_a_token(tmp_path: Path) -> None:
    path = tokens(tmp_path, '[certificates.robot1]\nallow = {publish = ["/x"]}')
    settings = Settings(tokens=path, **tls_files(tmp_path))
    login = Authentication(settings, Clock()).log_in(
        Headers(), "/", [], Certificate("robot1"), ADDRESS
    )
    assert login is not None
    assert login.principal.rights.allows("publish", "/x")
    with pytest.raises(AuthenticationError, match="robot2"):
        Authentication(settings, Clock()).log_in(Headers(), "/", [], Certificate("robot2"), ADDRESS)


def test_without_a_file_each_certificate_has_all_rights_but_that_of_an_admin(
    tmp_path: Path,
) -> None:
    authentication = Authentication(Settings(**tls_files(tmp_path)), Clock())
    login = authentication.log_in(Headers(), "/", [], Certificate("robot1"), ADDRESS)
    assert login is not None
    assert login.principal.name == "robot1"
    assert login.principal.rights.allows("publish", "/x")
    assert not login.principal.rights.admin


def test_certificate_ends_with_its_validity(tmp_path: Path) -> None:
    clock = Clock()
    text = "[certificates.robot1]\nexpires = 2099-01-01\n[certificates.robot2]"
    authentication = Authentication(
        Settings(tokens=tokens(tmp_path, text), **tls_files(tmp_path)), clock
    )
    for name in ("robot1", "robot2"):
        certificate = Certificate(name, clock.now + 10)
        login = authentication.log_in(Headers(), "/", [], certificate, ADDRESS)
        assert login is not None
        assert login.principal.expires == clock.now + 10
    clock.now += 10
    assert login is not None
    with pytest.raises(AuthenticationError, match="the certificate expired"):
        login.again()


def test_new_authorities_verify_certificates_again(tmp_path: Path) -> None:
    files = tls_files(tmp_path)
    files["client_ca"].write_text("old")
    authentication = Authentication(Settings(**files), Clock())
    login = authentication.log_in(Headers(), "/", [], Certificate("robot1"), ADDRESS)
    assert login is not None
    authentication.reload()
    assert login.again() == login.principal
    files["client_ca"].write_text("new")
    authentication.reload()
    with pytest.raises(AuthoritiesChanged):
        login.again()
    assert authentication.log_in(Headers(), "/", [], Certificate("robot1"), ADDRESS)


@pytest.mark.parametrize("name", ["anonymous", "a\nb", ""])
def test_certificate_with_an_odd_name_is_refused(tmp_path: Path, name: str) -> None:
    authentication = Authentication(Settings(**tls_files(tmp_path)), Clock())
    with pytest.raises(AuthenticationError):
        authentication.log_in(Headers(), "/", [], Certificate(name), ADDRESS)


# JSON web tokens.


def web_tokens(tmp_path: Path, key: bytes, algorithm: str = "HS256", **settings: Any) -> Any:
    path = tmp_path / "key"
    path.write_bytes(key)
    clock = settings.pop("clock", Clock())
    return Authentication(Settings(jwt_key=path, jwt_algorithm=algorithm, **settings), clock)


def signed(claims: dict[str, Any], key: Any = SECRET, algorithm: str = "HS256", **more: Any) -> str:
    return jwt.encode({"sub": "ann", **claims}, key, algorithm, **more)


def test_web_token_names_the_principal_and_its_rights(tmp_path: Path) -> None:
    authentication = web_tokens(tmp_path, SECRET + b"\n")
    far = 4_000_000_000
    token = signed({"exp": far, "fibws": {"allow": {"publish": ["/%n/x"]}}})
    principal = authentication.log_in_by_token(token, ADDRESS).principal
    assert principal.name == "ann"
    assert principal.rights.allows("publish", "/ann/x")
    assert principal.expires == far + 10


def private_keys() -> dict[str, Any]:
    return {
        "EdDSA": ed25519.Ed25519PrivateKey.generate(),
        "ES256": ec.generate_private_key(ec.SECP256R1()),
        "RS256": rsa.generate_private_key(65537, 2048),
    }


def pem(key: Any) -> bytes:
    data: bytes = key.public_key().public_bytes(
        serialization.Encoding.PEM, serialization.PublicFormat.SubjectPublicKeyInfo
    )
    return data


def jwk(key: Any, algorithm: str) -> dict[str, Any]:
    to_jwk = jwt.get_algorithm_by_name(algorithm).to_jwk
    return {**to_jwk(key.public_key(), as_dict=True), "kid": "k", "alg": algorithm}


WEAK_KEY = rsa.generate_private_key(65537, 1024)
WEAK = pem(WEAK_KEY)


@pytest.mark.parametrize("form", ["PEM", "JWKS"])
def test_public_keys_check_web_tokens(tmp_path: Path, form: str) -> None:
    for algorithm, key in private_keys().items():
        data = pem(key)
        if form == "JWKS":
            data = json.dumps({"keys": [jwk(key, algorithm)]}).encode()
        authentication = web_tokens(tmp_path, data, algorithm)
        token = signed({}, key, algorithm, headers={"kid": "k"})
        assert authentication.log_in_by_token(token, ADDRESS).principal.name == "ann"
        unnamed = signed({}, key, algorithm)
        assert authentication.log_in_by_token(unnamed, ADDRESS).principal.name == "ann"
        if form == "JWKS":
            other = signed({}, key, algorithm, headers={"kid": "other"})
            with pytest.raises(AuthenticationError, match="kid"):
                authentication.log_in_by_token(other, ADDRESS)


def test_token_must_name_its_key_if_there_are_several(tmp_path: Path) -> None:
    keys = [ed25519.Ed25519PrivateKey.generate() for _ in range(2)]
    jwks = [{**jwk(key, "EdDSA"), "kid": str(number)} for number, key in enumerate(keys)]
    authentication = web_tokens(tmp_path, json.dumps({"keys": jwks}).encode(), "EdDSA")
    named = signed({}, keys[1], "EdDSA", headers={"kid": "1"})
    assert authentication.log_in_by_token(named, ADDRESS).principal.name == "ann"
    with pytest.raises(AuthenticationError, match="kid"):
        authentication.log_in_by_token(signed({}, keys[1], "EdDSA"), ADDRESS)


def test_misspelt_right_is_named_with_the_right_spelling(tmp_path: Path) -> None:
    token = signed({"fibws": {"Deny": {"publish": ["/x"]}}})
    with pytest.raises(AuthenticationError, match=r"unknown key fibws\.Deny; did you mean deny\?"):
        web_tokens(tmp_path, SECRET).log_in_by_token(token, ADDRESS)


def unsigned(claims: dict[str, Any], algorithm: str = "none") -> str:
    parts = ({"alg": algorithm, "typ": "JWT"}, claims)
    texts = (base64.urlsafe_b64encode(json.dumps(part).encode()).rstrip(b"=") for part in parts)
    return b".".join((*texts, b"")).decode()


WRONG: dict[str, str] = {
    "another key": signed({}, b"x" * 32),
    "no signature": unsigned({"sub": "ann"}),
    "another algorithm": signed({}, algorithm="HS512", key=SECRET * 2),
    "expired": signed({"exp": 1_000_000_000}),
    "not yet valid": signed({"nbf": 4_000_000_000}),
    "no subject": jwt.encode({"exp": 4_000_000_000}, SECRET, "HS256"),
    "anonymous": signed({"sub": "anonymous"}),
    "odd subject": signed({"sub": "a\nb"}),
    "empty subject": signed({"sub": ""}),
    "odd rights": signed({"fibws": {"allow": {"fly": ["/x"]}}}),
    "misspelt deny": signed(
        {"fibws": {"allow": {"publish": ["/**"]}, "Deny": {"publish": ["/x"]}}}
    ),
    "expiry among the rights": signed({"fibws": {"expires": "2027-01-01"}}),
    "expiry beyond numbers": signed({"exp": 10**400}),
    "odd expiry": signed({"exp": "soon"}),
    "odd issue": signed({"iat": "x"}),
    "issued later": signed({"iat": 4_000_000_000}),
    "no text for a subject": signed({"sub": 5}),
    "no JSON": "YQ.YQ.YQ",
    "odd claim": signed({"fibws": "admin"}),
    "somebody else's": signed({"aud": "other"}),
    "not a token": "a.b.c",
    "a megabyte": "a" * 500_000 + "." + "b" * 500_000 + ".c",
}


@pytest.mark.parametrize("token", WRONG.values(), ids=WRONG)
def test_wrong_web_token_is_refused(tmp_path: Path, token: str) -> None:
    authentication = web_tokens(tmp_path, SECRET)
    with pytest.raises(AuthenticationError) as raised:
        authentication.log_in_by_token(token, ADDRESS)
    assert len(str(raised.value)) < 500


@pytest.mark.parametrize(
    ("token", "fault"),
    [
        ("another key", "its signature is not by the hub's key"),
        ("no signature", "its algorithm (alg) must be HS256"),
        ("another algorithm", "its algorithm (alg) must be HS256"),
        ("expired", "the token expired"),
        ("not yet valid", "it is not valid yet (nbf)"),
        ("no subject", "missing sub"),
        ("odd expiry", "exp must be an integer"),
        ("expiry beyond numbers", "exp is too large"),
        ("odd issue", "iat must be an integer"),
        ("issued later", "it is not valid yet (iat)"),
        ("no text for a subject", "sub must be a string"),
        ("somebody else's", "its audience (aud) is not this hub"),
        ("not a token", "it is not a JSON web token"),
        ("no JSON", "it is not a JSON web token"),
    ],
)
def test_error_says_what_is_wrong_with_a_web_token(tmp_path: Path, token: str, fault: str) -> None:
    """In words of the hub, none of the library."""
    authentication = web_tokens(tmp_path, SECRET)
    with pytest.raises(AuthenticationError) as raised:
        authentication.log_in_by_token(WRONG[token], ADDRESS)
    assert str(raised.value).removeprefix("invalid token: ") == fault


def test_public_key_is_no_secret(tmp_path: Path) -> None:
    """A token that was signed by HS256 with the public key as the secret (RFC 8725, 2.1)."""
    key = private_keys()["RS256"]
    authentication = web_tokens(tmp_path, pem(key), "RS256")
    begin = unsigned({"sub": "ann"}, algorithm="HS256")
    signature = hmac.digest(pem(key), begin.rstrip(".").encode(), "sha256")
    token = begin + base64.urlsafe_b64encode(signature).rstrip(b"=").decode()
    with pytest.raises(AuthenticationError):
        authentication.log_in_by_token(token, ADDRESS)


def test_audience_must_be_the_hub(tmp_path: Path) -> None:
    authentication = web_tokens(tmp_path, SECRET, jwt_audience="robots")
    assert authentication.log_in_by_token(signed({"aud": "robots"}), ADDRESS)
    assert authentication.log_in_by_token(signed({"aud": ["x", "robots"]}), ADDRESS)
    for claims in ({}, {"aud": "x"}):
        with pytest.raises(AuthenticationError):
            authentication.log_in_by_token(signed(claims), ADDRESS)


@pytest.mark.parametrize(
    ("key", "algorithm", "fact"),
    [
        (b"short", "HS256", "32 bytes"),
        (pem(private_keys()["EdDSA"]), "HS256", r"jwt_algorithm=\.\.\.\) to EdDSA"),
        (b"", "HS256", "32 bytes"),
        (SECRET, "none", "HS256"),
        (SECRET, "HS512", "HS256"),
        (b"no key", "RS256", "PEM"),
        (b'{"keys": []}', "RS256", "JWKS"),
        (b'{"keys": 1}', "RS256", "JWKS.* list with valid public keys$"),
        (b'{"keys": [{"kty": "RSA", "n": "x"}]}', "RS256", "list with valid public keys$"),
        (b'{"keys": ', "RS256", r"invalid JSON \(line 1, column 10\)$"),
        (b"{" * 100_000, "RS256", "invalid JSON"),
        (json.dumps(jwk(private_keys()["RS256"], "RS256")).encode(), "RS256", "but one key"),
        (pem(private_keys()["EdDSA"]), "RS256", "PEM$"),
        (pem(ec.generate_private_key(ec.SECP384R1())), "ES256", "ES256"),
        (b"-----BEGIN CERTIFICATE-----", "RS256", "openssl x509"),
        (b"s" * 31, "HS256", "at least 32 bytes, got 31; .* openssl rand -hex 32"),
        (WEAK, "RS256", "at least 2048 bits, got 1024; .*rsa_keygen_bits:3072"),
        (json.dumps({"keys": [jwk(WEAK_KEY, "RS256")]}).encode(), "RS256", "2048 bits, got 1024"),
    ],
)
def test_invalid_key_is_an_error_of_the_hub(
    tmp_path: Path, key: bytes, algorithm: str, fact: str
) -> None:
    with pytest.raises(HubError, match=fact):
        web_tokens(tmp_path, key, algorithm)


def test_private_key_is_refused(tmp_path: Path) -> None:
    data = private_keys()["EdDSA"].private_bytes(
        serialization.Encoding.PEM,
        serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    )
    with pytest.raises(HubError, match="private key"):
        web_tokens(tmp_path, data, "EdDSA")


# Guessing.


def test_address_that_guesses_must_wait(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    clock = Clock()
    path = tokens(tmp_path, entry("ann", "one"))
    authentication = Authentication(Settings(tokens=path), lambda: 0.0, clock)
    for _ in range(MOST_WRONG):
        with pytest.raises(AuthenticationError, match="unknown"):
            authentication.log_in_by_token("guess", ADDRESS)
    with pytest.raises(TooManyAttempts) as raised:
        authentication.log_in_by_token("guess", ADDRESS)
    assert raised.value.seconds == 1
    # Others may be behind the same address.
    assert authentication.log_in_by_token("one", ADDRESS).principal.name == "ann"
    clock.now += raised.value.seconds
    with pytest.raises(AuthenticationError, match="unknown"):
        authentication.log_in_by_token("guess", ADDRESS)
    warnings = [line.message for line in caplog.records if line.levelno == logging.WARNING]
    assert any(ADDRESS in line for line in warnings)
    assert "guess" not in caplog.text


def test_network_of_ipv6_counts_as_one_address() -> None:
    wrong = WrongTokens(Clock())
    for number in range(MOST_WRONG):
        wrong.failed(f"2001:db8::{number:x}")
    with pytest.raises(TooManyAttempts):
        wrong.check("2001:db8::ffff")
    wrong.check("2001:db8:0:1::1")


def test_counted_addresses_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fibws.hub.access.authentication.MOST_ADDRESSES", 10)
    wrong = WrongTokens(Clock())
    for number in range(100):
        wrong.failed(f"192.0.2.{number}")
    assert len(wrong._wrong) == 10


def test_clock_that_is_set_back_forgives_nothing_and_locks_nobody_out() -> None:
    clock = Clock()
    wrong = WrongTokens(clock)
    for _ in range(MOST_WRONG):
        wrong.failed(ADDRESS)
    clock.now -= 1000
    with pytest.raises(TooManyAttempts) as raised:
        wrong.check(ADDRESS)
    assert raised.value.seconds <= 2
