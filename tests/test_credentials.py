"""Where a client's token comes from, and what is shown of it."""

from __future__ import annotations

import json
import logging
from base64 import urlsafe_b64encode
from pathlib import Path
from typing import Any

import pytest

from fibws.credentials import Credentials, expiry, handshake_log, headers
from fibws.errors import AccessError, HubLimitReached, MissingRight, NotAuthorized


def jwt(claims: Any) -> str:
    """Return a token of this form, with a signature that nobody could verify."""
    parts = ({"alg": "HS256"}, claims, "signature")
    return ".".join(
        urlsafe_b64encode(json.dumps(part).encode()).decode().rstrip("=") for part in parts
    )


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "token"
    path.write_text("in-file\n")
    return path


def test_first_source_counts(file: Path) -> None:
    environment = {
        "FIBWS_TOKEN": "in-variable",
        "FIBWS_TOKEN_FILE": str(file),
        "FIBWS_HUB": "ws://robot/?token=in-url",
    }

    def found(hub: str | None = None, **arguments: Any) -> str | None:
        return Credentials.find(hub, environment=environment, **arguments).read()

    assert found(token="in-argument") == "in-argument"
    assert found(token_file=file) == "in-file"
    assert found() == "in-url"
    assert found("ws://other") == "in-variable"
    assert found("ws://other/?token=in-other-url") == "in-other-url"
    del environment["FIBWS_HUB"]
    assert found() == "in-variable"
    environment["FIBWS_TOKEN"] = ""
    assert found() == "in-file"
    environment["FIBWS_TOKEN_FILE"] = ""
    assert found() is None


def test_only_one_argument_may_be_given(file: Path) -> None:
    with pytest.raises(ValueError, match="both"):
        Credentials.find(token="a", token_file=file)


def test_file_is_read_again(file: Path) -> None:
    credentials = Credentials(file=file)
    file.write_text("newer")
    assert credentials.replacement("older") == "newer"
    assert credentials.replacement("newer") is None
    file.unlink()
    assert credentials.replacement("newer") is None


def test_file_may_begin_with_a_byte_order_mark(file: Path) -> None:
    file.write_text("x" * 8000 + "\r\n", "utf-8-sig")
    assert Credentials(file=file).read() == "x" * 8000


@pytest.mark.parametrize(
    "content", ["", " \n", "two words", "two\nlines", "ü", "a\x00b", "x" * 8001, "x" * 100_000]
)
def test_invalid_token_is_an_error_that_names_its_source_and_does_not_show_it(
    file: Path, content: str
) -> None:
    file.write_text(content)
    with pytest.raises(AccessError) as caught:
        Credentials.find(environment={"FIBWS_TOKEN_FILE": str(file)})
    text = str(caught.value)
    assert "FIBWS_TOKEN_FILE" in text and str(file) in text
    assert not content.strip() or content.strip() not in text


def test_missing_file_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(AccessError, match="No such file"):
        Credentials.find(token_file=tmp_path / "missing", environment={})


def test_token_cannot_add_a_header() -> None:
    with pytest.raises(AccessError):
        Credentials("token\r\nX-Other: 1", source="FIBWS_TOKEN")


def test_token_is_not_shown() -> None:
    assert "secret" not in repr(Credentials("secret", source="FIBWS_TOKEN"))


@pytest.mark.parametrize("logged_as", ["websockets.client", ""])
def test_token_is_not_in_debug_logs(caplog: pytest.LogCaptureFixture, logged_as: str) -> None:
    caplog.set_level(logging.DEBUG, logged_as)
    log = handshake_log()
    assert handshake_log() is log
    for name, value in {"Host": "robot", **headers("secret")}.items():
        log.debug("> %s: %s", name, value)
    assert "Host: robot" in caplog.text and "Authorization" in caplog.text
    assert "secret" not in caplog.text


def test_started_programs_find_the_same_token(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    environment = {"FIBWS_TOKEN": "old", "FIBWS_HUB": "ws://robot/?token=in-url"}
    Credentials.find(environment=environment).set_in(environment)
    assert environment == {"FIBWS_TOKEN": "in-url", "FIBWS_HUB": "ws://robot/"}
    monkeypatch.chdir(file.parent)
    Credentials.find(token_file=file.name, environment={}).set_in(environment)
    assert environment == {"FIBWS_TOKEN_FILE": str(file), "FIBWS_HUB": "ws://robot/"}
    Credentials().set_in(environment)
    assert environment == {"FIBWS_TOKEN_FILE": str(file), "FIBWS_HUB": "ws://robot/"}


@pytest.mark.parametrize(
    ("url", "warns"),
    [
        ("ws://robot:9090", True),
        ("ws://10.0.0.1:9090", True),
        ("wss://robot", False),
        ("ws://127.0.0.1:9090", False),
        ("ws://[::1]:9090", False),
        ("ws://localhost", False),
    ],
)
def test_warning_about_a_network_without_encryption(url: str, warns: bool) -> None:
    warning = Credentials("secret", source="x").warning(url)
    assert (warning is not None) == warns
    assert warning is None or ("wss://" in warning and "secret" not in warning)
    assert Credentials().warning(url) is None


@pytest.mark.parametrize(
    ("code", "kind"), [(4401, NotAuthorized), (4403, MissingRight), (4429, HubLimitReached)]
)
def test_close_codes_have_errors(code: int, kind: type[Exception]) -> None:
    error = Credentials().refusal(
        "ws://robot", code, "the hub's reason", sent=True, redirected_from=""
    )
    assert type(error) is kind
    assert "ws://robot" in str(error) and "the hub's reason" in str(error)


def test_other_close_codes_are_not_final() -> None:
    for code in (None, 1000, 1001, 1012, 4001):
        assert Credentials().refusal("ws://robot", code, "", sent=True, redirected_from="") is None


def test_remedy_names_the_source_of_the_token(file: Path) -> None:
    def text(credentials: Credentials, *, sent: bool = True, first: str = "ws://robot") -> str:
        return str(credentials.refusal("ws://robot", 4401, "no", sent=sent, redirected_from=first))

    assert "FIBWS_TOKEN" in text(Credentials(), sent=False)
    assert "the hub's URL" in text(Credentials("a", source="the hub's URL"))
    assert str(file) in text(Credentials(file=file, source="FIBWS_TOKEN_FILE"))
    for reason, remedy in (
        ("the certificate expired", "robot.pem"),
        ("missing token", "FIBWS_TOKEN"),
    ):
        error = Credentials().refusal(
            "wss://robot", 4401, reason, sent=False, redirected_from="", certificate="robot.pem"
        )
        assert remedy in str(error)
    redirect = text(Credentials("a", source="x"), sent=False, first="ws://first")
    assert "redirects" in redirect and "FIBWS_HUB=ws://robot" in redirect


def test_expiry_of_a_jwt_is_read() -> None:
    assert expiry(jwt({"exp": 1_900_000_000, "sub": "robot"})) == 1_900_000_000
    assert expiry(jwt({"exp": 1.5})) == 1.5


@pytest.mark.parametrize(
    "token",
    [
        "fibws_abc",
        "a.b.c",
        "..",
        "a.!.c",
        jwt({}),
        jwt([]),
        jwt({"exp": "soon"}),
        jwt({"exp": True}),
        jwt({"exp": -1}),
        jwt({"exp": 1e300}),
        jwt({"exp": float("nan")}),
        f"a.{urlsafe_b64encode(b'[' * 6000).decode()}.c",
    ],
)
def test_other_tokens_have_no_known_expiry(token: str) -> None:
    assert expiry(token) is None
