"""The page's login: a token becomes a cookie."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from fibws.access.rights import Rights
from fibws.access.token_file import TokenFile, digest_of
from fibws.hub.access.authentication import MOST_WRONG, Authentication
from fibws.hub.access.sessions import LIFETIME
from fibws.hub.http.login import LoginRoutes
from fibws.hub.http.requests import HttpRequests
from fibws.hub.settings import Settings

HOST = "localhost:9090"


class Page:
    """A browser's page at the hub, with its cookie."""

    def __init__(self, tokens: Path | None) -> None:
        settings = Settings(tokens=tokens)
        self._requests = HttpRequests(settings, {})
        self.time = 0.0
        self.authentication: Authentication | None = None
        if tokens is not None:
            self.authentication = Authentication(settings, lambda: 0.0, lambda: self.time)
        self.refusals: list[tuple[str, str]] = []
        self.ended = 0
        """Sessions that have ended by a log-out."""

        def end() -> None:
            self.ended += 1

        refused = self.refusals
        LoginRoutes(self._requests, self.authentication, lambda *each: refused.append(each), end)
        self.cookie = ""

    def get(self, path: str, **headers: str) -> Response:
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        if self.cookie:
            named["Cookie"] = self.cookie
        request = Request(path, Headers({"Host": HOST} | named))
        found = self._requests.respond(request, "192.0.2.1")
        assert found is not None
        assert found.status_code == 403 or found.headers["Cache-Control"] == "no-store"
        if "Set-Cookie" in found.headers:
            self.cookie = found.headers["Set-Cookie"].partition(";")[0]
        return found

    def who(self) -> dict[str, object]:
        answer: dict[str, object] = json.loads(bytes(self.get("/login").body))
        return answer


@pytest.fixture
def file(tmp_path: Path) -> TokenFile:
    path = tmp_path / "tokens.toml"
    path.touch()
    return TokenFile(path)


@pytest.fixture
def token(file: TokenFile) -> str:
    return file.add("teleop", Rights({"publish": ("/cmd_vel",)}))


@pytest.fixture
def page(tmp_path: Path, token: str) -> Page:
    return Page(tmp_path / "tokens.toml")


def test_token_becomes_a_cookie_that_scripts_cannot_read(page: Page, token: str) -> None:
    found = page.get("/login", Authorization=f"Bearer {token}")
    assert found.status_code == 204 and not found.body
    cookie = found.headers["Set-Cookie"]
    assert re.fullmatch(r"fibws_session=[\w-]{43}; HttpOnly; SameSite=Strict", cookie)
    assert token not in cookie
    assert page.who() == {"required": True, "name": "teleop", "admin": False, "reason": ""}


@pytest.mark.parametrize(
    ("headers", "secure"),
    [
        ({"Referer": "https://lab.example/robot/"}, True),
        ({"Origin": "https://localhost:9090"}, True),
        ({"X_Forwarded_Proto": "https"}, True),
        ({"Referer": "http://localhost:9090/"}, False),
        ({}, False),
    ],
)
def test_cookie_of_an_encrypted_page_is_secure(
    page: Page, token: str, headers: dict[str, str], secure: bool
) -> None:
    found = page.get("/login", Authorization=f"Bearer {token}", **headers)
    assert ("; Secure" in found.headers["Set-Cookie"]) == secure


def test_logout_ends_the_session(page: Page, token: str) -> None:
    page.get("/login", Authorization=f"Bearer {token}")
    cookie = page.cookie
    found = page.get("/logout")
    assert found.status_code == 204
    assert found.headers["Set-Cookie"].startswith("fibws_session=;")
    assert "Max-Age=0" in found.headers["Set-Cookie"]
    assert page.ended == 1
    page.cookie = cookie
    assert page.who()["reason"] == "missing token"  # It is of no use to whoever has kept it.
    page.get("/logout")
    assert page.ended == 1


@pytest.mark.parametrize("wrong", ["fibws_wrong", "", "x" * 10_000])
def test_wrong_token_is_refused_with_a_reason(page: Page, wrong: str) -> None:
    found = page.get("/login", Authorization=f"Bearer {wrong}")
    assert found.status_code == 401 and b"token" in bytes(found.body)
    assert "Set-Cookie" not in found.headers
    [(reason, address)] = page.refusals
    assert "token" in reason and address == "192.0.2.1"
    assert not wrong or wrong not in reason
    assert page.who() == {
        "required": True,
        "name": None,
        "admin": False,
        "reason": "missing token",
    }


def test_guessing_is_slowed_down(page: Page, token: str) -> None:
    codes = [
        page.get("/login", Authorization=f"Bearer wrong{number}").status_code
        for number in range(MOST_WRONG + 1)
    ]
    assert codes == [401] * MOST_WRONG + [429]
    assert page.get("/login", Authorization="Bearer wrong again").status_code == 429
    assert page.get("/login", Authorization=f"Bearer {token}").status_code == 204


def test_revoked_cookie_has_a_reason(page: Page, token: str, file: TokenFile) -> None:
    page.get("/login", Authorization=f"Bearer {token}")
    file.revoke("teleop")
    assert page.authentication is not None
    page.authentication.reload()
    assert page.who()["name"] is None and page.who()["reason"] == "unknown token"


def test_anonymous_page_has_a_name(tmp_path: Path) -> None:
    path = tmp_path / "tokens.toml"
    path.write_text("[anonymous]\nallow = {subscribe = ['/map']}\n")
    assert Page(path).who()["name"] == "anonymous"


def test_open_hub_needs_no_login() -> None:
    page = Page(None)
    assert page.who() == {"required": False, "name": None, "admin": False, "reason": ""}
    assert page.get("/login", Authorization="Bearer x").status_code == 200


@pytest.mark.parametrize("path", ["/login", "/logout"])
@pytest.mark.parametrize(
    "headers",
    [
        {"Sec_Fetch_Site": "cross-site"},
        {"Sec_Fetch_Site": "same-site"},
        {"Host": "evil.example"},
    ],
)
def test_pages_of_other_sites_are_refused(
    page: Page, token: str, path: str, headers: dict[str, str]
) -> None:
    found = page.get(path, Authorization=f"Bearer {token}", **headers)
    assert found.status_code == 403 and "Set-Cookie" not in found.headers


def test_token_may_have_characters_that_no_cookie_has(tmp_path: Path) -> None:
    path = tmp_path / "tokens.toml"
    path.write_text(f'[tokens.a]\nsha256 = "{digest_of("a; Path=/")}"\nadmin = true\n')
    page = Page(path)
    assert page.get("/login", Authorization="Bearer a; Path=/").status_code == 204
    assert page.who()["name"] == "a"


def test_session_ends_when_it_is_not_used(page: Page, token: str) -> None:
    page.get("/login", Authorization=f"Bearer {token}")
    for _ in range(3):
        page.time += LIFETIME - 1
        assert page.who()["name"] == "teleop"
    page.time += LIFETIME
    assert page.who() == {"required": True, "name": None, "admin": False, "reason": "missing token"}


def test_sessions_are_bounded(page: Page, token: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fibws.hub.access.sessions.MOST_OF_ONE", 3)
    cookies = []
    for _ in range(5):
        page.get("/login", Authorization=f"Bearer {token}")
        cookies.append(page.cookie)
    names = []
    for page.cookie in cookies:
        names.append(page.who()["name"])
    assert names == [None, None, "teleop", "teleop", "teleop"]


@pytest.mark.parametrize(
    ("origin", "name"),
    [
        ("https://lab.example", "teleop"),
        ("https://lab.example:8000", None),
        ("http://lab.example", None),
        ("http://localhost:9090", None),
        ("null", None),
    ],
)
def test_session_is_of_the_page_that_has_logged_in(
    page: Page, token: str, origin: str, name: str | None
) -> None:
    """Behind a proxy the hub does not know its own origin; the browser does."""
    page.get("/login", Authorization=f"Bearer {token}", Referer="https://lab.example/robot/")
    headers = Headers({"Host": HOST, "Cookie": page.cookie, "Origin": origin})
    assert page.authentication is not None
    login = page.authentication.log_in(headers, "/", (), None, "192.0.2.1")
    assert (login.principal.name if login is not None else None) == name


def test_login_with_another_scheme_is_ignored(page: Page) -> None:
    assert page.get("/login", Authorization="Basic eDp5").status_code == 200
