"""Attempts to enter a hub without a right token, or to keep rights that a token no longer gives."""

from __future__ import annotations

import base64
import hmac
import json
import logging
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jwt
import pytest
from conftest import StartHub
from hub_reload import reloaded
from websockets.asyncio.client import connect
from websockets.datastructures import Headers

from fibws.access.token_file import Tokens, digest_of
from fibws.access.web_tokens import WebTokens
from fibws.errors import AuthenticationError
from fibws.hub.access import sessions
from fibws.hub.access.authentication import MOST_WRONG, Authentication
from fibws.hub.server import HubServer
from fibws.hub.settings import Settings

from .raw_client import Gone, connected, dialled, handshake, longest_turn, nodes, until
from .token_clients import closing, entering, entry

SECRET = b"0123456789abcdef0123456789abcdef"
FILE = "\n".join(
    (
        entry("ann", 'allow = {publish = ["/x"], node = ["/ann*"]}'),
        entry("bob", 'allow = {publish = ["/y"]}'),
        entry("boss", "admin = true"),
        entry("old", "expires = 2020-01-01T00:00:00Z"),
        '[anonymous]\nallow = {subscribe = ["/map"]}',
    )
)
MEGABYTE = 2**20


@pytest.fixture
def tokens(tmp_path: Path) -> Path:
    """The hub's file of tokens."""
    path = tmp_path / "tokens.toml"
    path.write_text(FILE, "utf-8")
    return path


def rewrite(path: Path, text: str) -> None:
    path.write_text(text, "utf-8")


@pytest.fixture
async def hub(start_hub: StartHub, tokens: Path, tmp_path: Path) -> HubServer:
    """A hub that takes tokens of its file and JSON web tokens; others may enter as anonymous."""
    key = tmp_path / "key"
    key.write_bytes(SECRET)
    return await start_hub(tokens=tokens, jwt_key=key)


def encoded(value: object) -> str:
    data = value if isinstance(value, bytes) else json.dumps(value).encode()
    return base64.urlsafe_b64encode(data).rstrip(b"=").decode()


def web_token(header: object, claims: object, key: bytes | None = SECRET) -> str:
    """Return a JSON web token that may be wrong in any way; without a key it is not signed."""
    begin = f"{encoded(header)}.{encoded(claims)}"
    signature = b"" if key is None else hmac.digest(key, begin.encode(), "sha256")
    return f"{begin}.{encoded(signature)}"


HS256 = {"alg": "HS256", "typ": "JWT"}
ANN = {"sub": "ann"}
RIGHT = web_token(HS256, ANN)
WRONG = {
    "unknown": "fibws_wrong",
    "empty": "",
    "expired": "old",
    "digest": digest_of("ann"),
    "another case": "ANN",
    "a character less": "an",
    "name of a section": "anonymous",
    "alg none": web_token({"alg": "none"}, ANN, None),
    "alg None": web_token({"alg": "None"}, ANN, None),
    "alg NONE signed": web_token({"alg": "NONE"}, ANN),
    "no alg": web_token({}, ANN),
    "alg of another kind": web_token({"alg": ["HS256"]}, ANN),
    "another algorithm": jwt.encode(ANN, SECRET * 2, "HS512"),
    "no signature": web_token(HS256, ANN, None),
    "another key": web_token(HS256, ANN, b"x" * 32),
    "empty key": web_token(HS256, ANN, b""),
    "key in the header": web_token({**HS256, "jwk": {"kty": "oct", "k": "eA"}}, ANN, b"x"),
    "address of a key": web_token({**HS256, "jku": "http://127.0.0.1/x"}, ANN, b"x"),
    "file of a key": web_token({**HS256, "kid": "../../../../dev/null"}, ANN, b""),
    "claims of another": f"{encoded(HS256)}.{encoded({'sub': 'boss'})}.{RIGHT.split('.')[2]}",
    "expired web token": web_token(HS256, {**ANN, "exp": 1_000_000_000}),
    "not yet valid": web_token(HS256, {**ANN, "nbf": 4_000_000_000}),
    "no subject": web_token(HS256, {}),
    "subject of another kind": web_token(HS256, {"sub": ["ann"]}),
    "subject anonymous": web_token(HS256, {"sub": "anonymous"}),
    "claims of another kind": web_token(HS256, ["ann"]),
    "header of another kind": web_token(["HS256"], ANN),
    "not JSON": web_token(b"\xff\x00", b"{"),
    "nested header": web_token(b"[" * 5000, ANN),
    "nested claims": web_token(HS256, b'{"a":' * 700),
    "expiry without end": web_token(HS256, b'{"sub": "ann", "exp": Infinity}'),
    "expiry that is not a number": web_token(HS256, b'{"sub": "ann", "exp": NaN}'),
    "dots": "..",
    "long": "a" * 7000,
}
WAYS: dict[str, Callable[[str], dict[str, Any]]] = {
    "header": lambda token: {"Authorization": f"Bearer {token}"},
    "query": lambda token: {"path": f"/?token={quote(token)}"},
    "subprotocol": lambda token: {"Sec_WebSocket_Protocol": f"fibws.token.{token}"},
}
"""The ways in, in the handshake."""


@pytest.mark.parametrize("way", WAYS)
async def test_right_token_enters(hub: HubServer, way: str) -> None:
    """Otherwise the other tests would show nothing."""
    for token in ("ann", RIGHT):
        async with connected(hub.port, **WAYS[way](token)) as client:
            await client.is_processed()
            assert [each.principal.name for each in hub._connections if each.principal] == ["ann"]


@pytest.mark.parametrize("token", WRONG.values(), ids=WRONG)
async def test_wrong_token_is_refused(
    hub: HubServer, token: str, caplog: pytest.LogCaptureFixture
) -> None:
    """By every way, and though anonymous clients may enter."""
    for way in WAYS.values():
        async with connected(hub.port, **way(token)) as client:
            code, reason = await client.is_closed()
        assert code == 4401
        assert not token or token not in reason
    async with connected(hub.port) as client:
        await client.send_operation("auth", token=token, id="a")
        answer = await client.receive()
        assert (answer["op"], answer["level"], answer["id"]) == ("status", "error", "a")
    assert len(token) < 10 or token not in caplog.text


def test_expiry_in_a_text_is_refused_or_read(tokens: Path, tmp_path: Path) -> None:
    """PyJWT reads it."""
    key = tmp_path / "key"
    key.write_bytes(SECRET)
    authentication = Authentication(Settings(tokens=tokens, jwt_key=key), lambda: 2e9)
    token = web_token(HS256, {**ANN, "exp": "4000000000"})
    with suppress(AuthenticationError):
        assert authentication.log_in_by_token(token, "127.0.0.1").principal.expires == 4e9 + 10


@pytest.mark.parametrize("way", WAYS)
async def test_token_of_a_megabyte_is_refused(hub: HubServer, way: str) -> None:
    fields = WAYS[way]("a" * MEGABYTE)
    async with dialled(hub.port) as client, longest_turn() as longest:
        with suppress(OSError):  # The hub has closed before it has read everything.
            await client.send(handshake(fields.pop("path", "/"), **fields))
            assert b" 101 " not in await client.to_the_end()
    assert longest() < 0.5
    assert not nodes(hub)


async def test_operation_with_a_token_of_a_megabyte_is_refused(hub: HubServer) -> None:
    token = ".".join(("a" * MEGABYTE, "b" * MEGABYTE, "c" * MEGABYTE))
    async with connected(hub.port) as client, longest_turn() as longest:
        await client.send_operation("auth", token=token)
        answer = await client.receive()
        assert (answer["level"], len(answer["msg"]) < 500) == ("error", True)
    assert longest() < 0.5


@pytest.mark.parametrize(
    ("fields", "name"),
    [
        ({"Authorization": "Bearer wrong", "path": "/?token=ann"}, None),
        ({"Authorization": "Bearer ", "path": "/?token=ann"}, None),
        ({"path": "/?token=wrong&token=ann"}, None),
        ({"path": "/?token=%61nn"}, "ann"),
        ({"path": "/?token=ann%00"}, None),
        ({"path": "/?TOKEN=ann"}, "anonymous"),
        ({"path": "/token=ann"}, "anonymous"),
        ({"Authorization": "Basic YW5uOmFubg=="}, "anonymous"),
        ({"Authorization": "ann"}, "anonymous"),
        ({"Cookie": "fibws_session=ann"}, "anonymous"),
        ({"Sec_WebSocket_Protocol": "fibws.token.wrong, fibws.token.ann"}, None),
        ({"Sec_WebSocket_Protocol": "fibws.token.wrong", "path": "/?token=ann"}, "ann"),
    ],
)
async def test_first_token_of_a_request_counts(
    hub: HubServer, fields: dict[str, Any], name: str | None
) -> None:
    """Whether it is right or wrong, so that no wrong one is tried for free."""
    async with connected(hub.port, **fields) as client:
        if name is None:
            assert (await client.is_closed())[0] == 4401
        else:
            await client.is_processed()
            (connection,) = hub._connections
            assert connection.principal is not None
            assert connection.principal.name == name


def test_two_authorization_headers_are_refused(tokens: Path) -> None:
    headers = Headers([("Authorization", "Bearer ann"), ("Authorization", "Bearer ann")])
    authentication = Authentication(Settings(tokens=tokens), lambda: 2e9)
    with pytest.raises(AuthenticationError):
        authentication.log_in(headers, "/", [], None, "127.0.0.1")


async def session(hub: HubServer, token: str) -> str:
    """Log in as the hub's page does, and return the cookie."""
    async with dialled(hub.port) as page:
        host = f"127.0.0.1:{hub.port}"
        fields = {"Host": host, "Referer": f"http://{host}/", "Authorization": f"Bearer {token}"}
        await page.send(handshake("/login", Upgrade="none", **fields))
        status, headers, _ = await page.response()
    assert status == 204
    cookie: str = headers["set-cookie"].partition(";")[0]
    assert token not in cookie
    return cookie


# Guessing.


@pytest.fixture
def unforgiving(monkeypatch: pytest.MonkeyPatch) -> None:
    """Forgive no wrong token, however slow the machine is."""
    monkeypatch.setattr("fibws.hub.access.authentication.FORGIVEN_PER_SECOND", 1e-6)


@pytest.mark.usefixtures("unforgiving")
async def test_requests_that_any_page_can_send_count_against_nobody(hub: HubServer) -> None:
    """``<img src="http://127.0.0.1:9090/metrics?token=x">``, on a page that the operator reads."""
    foreign = {"Upgrade": "none", "Sec_Fetch_Site": "cross-site", "Sec_Fetch_Mode": "no-cors"}
    asset = "/assets/package/a/b.png?token=x"
    for path in ("/metrics?token=x", "/healthz?token=x", "/login?token=x", asset):
        for more in ({}, {"Cookie": "fibws_session=x"}, {"Referer": "https://evil.example/"}):
            for _ in range(MOST_WRONG):
                async with dialled(hub.port) as browser:
                    await browser.send(handshake(path, **foreign, **more))
                    assert (await browser.response())[0] in (200, 401, 403, 404)
    async with connected(hub.port, **WAYS["header"]("wrong")) as client:
        assert (await client.is_closed())[0] == 4401


@pytest.mark.usefixtures("unforgiving")
@pytest.mark.parametrize("path", ["/metrics", "/login", "/assets/package/a/b.png"])
async def test_wrong_tokens_in_the_header_count_and_a_right_one_passes(
    hub: HubServer, path: str
) -> None:
    statuses = []
    for token in ["wrong"] * (MOST_WRONG + 1) + ["boss"]:
        async with dialled(hub.port) as program:
            fields = {"Upgrade": "none", "Authorization": f"Bearer {token}"}
            await program.send(handshake(path, **fields))
            statuses.append((await program.response())[0])
    assert statuses[:MOST_WRONG] == [401] * MOST_WRONG
    assert statuses[-1] in (200, 204, 404)
    async with connected(hub.port, **WAYS["header"]("wrong")) as client:
        assert (await client.is_closed())[0] == 4429


@pytest.mark.usefixtures("unforgiving")
async def test_guessing_is_slowed_and_logged(
    hub: HubServer, caplog: pytest.LogCaptureFixture
) -> None:
    codes = []
    for number in range(MOST_WRONG + 10):
        # A header that names another address each time counts only from a trusted proxy.
        forged: Any = {"X_Forwarded_For": f"192.0.2.{number}"}
        async with connected(hub.port, **WAYS["query"](f"guess-{number}"), **forged) as client:
            codes.append((await client.is_closed())[0])
    assert codes[:MOST_WRONG] == [4401] * MOST_WRONG
    assert codes[MOST_WRONG + 1 :] == [4429] * 9
    # Another address is not slowed.
    async with connect(
        hub.url, local_addr=("127.0.0.2", 0), additional_headers={"Authorization": "Bearer ann"}
    ):
        assert nodes(hub)
    warnings = [each.message for each in caplog.records if each.levelno >= logging.WARNING]
    assert any("127.0.0.1" in line and "oken" in line for line in warnings)
    assert "guess" not in caplog.text


@pytest.mark.usefixtures("unforgiving")
async def test_guessing_by_operations_is_slowed(hub: HubServer) -> None:
    """Though the client has entered as anonymous."""
    async with connected(hub.port) as client:
        texts = []
        for number in range(MOST_WRONG + 10):
            await client.send_operation("auth", token=f"guess-{number}")
            texts.append((await client.receive())["msg"])
    assert "unknown token" in texts[0]
    assert not any("unknown token" in text for text in texts[MOST_WRONG + 1 :])


def test_tokens_are_compared_in_constant_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every digest is compared, by hmac, whichever token it is."""
    compared: list[tuple[str, str]] = []
    compare_digest = hmac.compare_digest

    def compare(known: str, given: str) -> bool:
        compared.append((known, given))
        return compare_digest(known, given)

    monkeypatch.setattr("fibws.access.token_file.hmac.compare_digest", compare)
    known = [digest_of(str(number)) for number in range(50)]
    file = "\n".join(f'[tokens.n{number}]\nsha256 = "{each}"' for number, each in enumerate(known))
    tokens = Tokens.parse(file, "file")
    for token, name in (("0", "n0"), ("49", "n49"), ("wrong", None), ("", None)):
        compared.clear()
        found = tokens.find(token)
        assert (found.name if found is not None else None) == name
        assert compared == [(each, digest_of(token)) for each in known]


# What is kept.


async def test_refused_token_does_not_outlive_the_right_one(hub: HubServer) -> None:
    """A client that holds a second token, which may not be its node, keeps no revoked rights."""
    async with connected(hub.port, "/?node=/ann", Authorization="Bearer ann") as client:
        await client.send_operation("auth", token="bob")
        assert "node" in (await client.receive())["msg"]
        assert (await client.is_closed())[0] == 4403


async def test_will_does_not_outlive_the_right_to_publish(hub: HubServer, tokens: Path) -> None:
    async with connected(hub.port, Authorization="Bearer boss") as listener:
        await listener.subscribes("/x")
        async with connected(hub.port, "/?node=/ann", Authorization="Bearer ann") as client:
            await client.send_operation("set_will", topic="/x", msg={"data": 1})
            await client.is_processed()
            rewrite(tokens, FILE.replace('publish = ["/x"]', 'publish = ["/z"]'))
            await reloaded(hub)
            assert "publish" in (await client.receive())["msg"]
        await until(lambda: "/ann" not in nodes(hub))
        await listener.is_processed()


async def test_log_holds_no_token(hub: HubServer, caplog: pytest.LogCaptureFixture) -> None:
    """However the request is refused."""
    caplog.set_level(logging.DEBUG)
    token = "fibws_secret"
    for path, more in (
        ("/?token=TOKEN", {}),
        ("/?token=TOKEN&node=~", {}),
        ("/?node=/rosapi&token=TOKEN", {}),
        ("/?node=/x#&token=TOKEN", {}),
        ("/none?token=TOKEN", {"Upgrade": "none"}),
        ("/healthz?token=TOKEN", {"Upgrade": "none", "Host": "evil.example"}),
        ("/?token=TOKEN", {"Origin": "https://evil.example"}),
        ("/?token=TOKEN", {"Host": "evil.example:x"}),
        ("/?token=TOKEN", {"Sec_WebSocket_Version": "12"}),
        ("/?token=TOKEN", {"Sec_WebSocket_Key": "x"}),
        ("/?token=TOKEN\x01", {}),
        ("/?token=TOKEN", {"Authorization": "Bearer TOKEN", "Cookie": "fibws_session=TOKEN"}),
        ("/", {"Authorization": "Bearer TOKEN\x01"}),
        ("/", {"Sec_WebSocket_Protocol": "fibws.token.TOKEN, ,"}),
    ):
        request = handshake(path, **more).replace(b"TOKEN", token.encode())
        async with dialled(hub.port) as client:
            await client.send(request)
            with suppress(Gone, TimeoutError):
                status, _, body = await client.response()
                assert token.encode() not in body, (status, path)
    assert token not in caplog.text


# Pages of other sites, and plain requests.


@pytest.mark.parametrize(
    "origin",
    [
        "https://evil.example",
        "null",
        "http://localhost.evil.example",
        "file://",
        "http://2130706433",
    ],
)
async def test_page_of_another_site_does_not_enter_with_the_cookie(
    hub: HubServer, origin: str
) -> None:
    cookie = await session(hub, "ann")
    async with dialled(hub.port) as client:
        host = f"127.0.0.1:{hub.port}"
        await client.send(handshake(Host=host, Origin=origin, Cookie=cookie))
        assert (await client.response())[0] == 403
    assert not nodes(hub)


@pytest.mark.parametrize(
    "origin", ["http://127.0.0.1:1", "http://localhost:PORT", "http://[::1]:9", "http://127.0.0.1"]
)
async def test_page_of_another_port_does_not_enter_with_the_cookie(
    hub: HubServer, origin: str
) -> None:
    """It may connect, but as anonymous: a browser sends a cookie to all ports of its host."""
    cookie = await session(hub, "ann")
    host = f"127.0.0.1:{hub.port}"
    fields: Any = {"Host": host, "Cookie": cookie}
    for page, name in (
        (origin.replace("PORT", str(hub.port)), "anonymous"),
        (f"http://{host}", "ann"),
    ):
        async with connected(hub.port, Origin=page, **fields) as client:
            await client.is_processed()
            (connection,) = hub._connections
            assert connection.principal is not None
            assert connection.principal.name == name


async def test_connections_of_the_oldest_session_end_with_it(
    hub: HubServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sessions, "MOST_OF_ONE", 2)
    first, second = await session(hub, "ann"), await session(hub, "ann")
    async with (
        connected(hub.port, Cookie=first) as tab,
        connected(hub.port, Cookie=second) as other,
    ):
        await tab.is_processed()
        await other.is_processed()
        await session(hub, "ann")
        code, reason = await tab.is_closed()
        assert code == 4401
        assert "the session has ended" in reason
        await other.is_processed()


async def test_logout_ends_the_connections_of_the_session_alone(hub: HubServer) -> None:
    first, second = await session(hub, "ann"), await session(hub, "ann")
    async with (
        connected(hub.port, Cookie=first) as tab,
        connected(hub.port, Cookie=second) as other,
    ):
        await tab.is_processed()
        async with dialled(hub.port) as page:
            await page.send(handshake("/logout", Upgrade="none", Cookie=first))
            assert (await page.response())[0] == 204
        assert await tab.is_closed() == (4401, "after a log-out: the session has ended")
        await other.is_processed()
    async with connected(hub.port, Cookie=first) as client:
        await client.is_processed()
        assert [each.principal.name for each in hub._connections if each.principal] == ["anonymous"]


async def test_logout_verifies_no_token_again(
    hub: HubServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It would take long with many clients, and any page can log out as often as it wants."""
    cookie = await session(hub, "ann")
    async with connected(hub.port, Authorization=f"Bearer {RIGHT}") as client:
        await client.is_processed()
        verified: list[str] = []
        monkeypatch.setattr(WebTokens, "principal", lambda self, token: verified.append(token))
        async with dialled(hub.port) as page:
            await page.send(handshake("/logout", Upgrade="none", Cookie=cookie))
            assert (await page.response())[0] == 204
        await client.is_processed()
    assert verified == []


async def test_revoked_token_ends_its_sessions(hub: HubServer, tokens: Path) -> None:
    cookie = await session(hub, "ann")
    async with connected(hub.port, Cookie=cookie) as tab:
        await tab.is_processed()
        rewrite(tokens, entry("bob", ""))
        await reloaded(hub)
        assert (await tab.is_closed())[0] == 4401
    async with connected(hub.port, Cookie=cookie) as tab:
        assert await tab.is_closed() == (4401, "unknown token")


async def test_health_shows_no_client_to_whoever_has_no_token(hub: HubServer) -> None:
    async with connected(hub.port, "/?node=/ann", receive_buffer=4096, Authorization="Bearer ann"):
        (connection,) = hub._connections
        connection.queue.dropped = 1  # As of one that reads too slowly.
        async with dialled(hub.port) as stranger:
            await stranger.send(handshake("/healthz", Upgrade="none"))
            _, _, body = await stranger.response()
    assert b"/ann" not in body
    assert b"127.0.0.1" not in body


@pytest.mark.parametrize("name", ["ann", "boss"])
async def test_web_token_with_the_name_of_a_token_does_not_get_its_nodes(
    hub: HubServer, name: str
) -> None:
    """Users of the issuer may choose their names."""
    forged = jwt.encode({"sub": name, "fibws": {"allow": {"node": ["/**"]}}}, SECRET, "HS256")
    async with entering(hub, name, "/ann_1"):
        node = hub.graph.nodes["/ann_1"]
        async with entering(hub, forged, "/ann_1") as thief:
            assert await closing(thief) == (4403, "/ann_1 is a node of another principal")
        assert hub.graph.nodes["/ann_1"] is node
