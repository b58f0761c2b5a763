"""Who may come in."""

from __future__ import annotations

import json
from typing import Any

import pytest
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from fibws.errors import InvalidName
from fibws.hub.gate import Gate, node_name
from fibws.hub.pages import Pages
from fibws.hub.settings import Settings

PAGE = "<!doctype html><title>ä</title>".encode()
HERE = "localhost:9090"
LAN = "192.168.1.5:9090"


def ask(
    path: str = "/",
    headers: dict[str, str] | Headers | None = None,
    method: str = "GET",
    **settings: Any,
) -> Response | None:
    pages = Pages({"index.html": PAGE, "roslib.js": b"var ROSLIB = {};"})
    gate = Gate(Settings(**settings), pages, lambda: {"status": "ok", "clients": 2})
    return gate.answer(Request(path, Headers(headers or {}), method))


def connect(
    path: str = "/", *, origin: str | None, dialled: str | None = HERE, **settings: Any
) -> int:
    """The status of the answer to a WebSocket's request; 101 if it may open."""
    headers = {"Upgrade": "websocket", "Origin": origin, "Host": dialled}
    response = ask(path, {name: value for name, value in headers.items() if value}, **settings)
    return response.status_code if response else 101


def get(path: str, method: str = "GET", **headers: str) -> Response:
    response = ask(path, headers, method)
    assert response is not None
    return response


@pytest.mark.parametrize("host", [HERE, LAN, "evil.example", None])
def test_programs_send_no_origin_and_may_come_in(host: str | None) -> None:
    assert connect(origin=None, dialled=host) == 101


@pytest.mark.parametrize(
    "origin",
    [
        "http://localhost",
        "http://localhost:3000",
        "https://LocalHost:9090",
        "http://robot.localhost:5173",
        "http://127.0.0.1:8000",
        "http://127.1.2.3",
        "http://[::1]:8000",
    ],
)
@pytest.mark.parametrize("host", [HERE, "127.0.0.1:9090", "[::1]:9090", "LOCALHOST", LAN])
def test_this_machines_own_pages_may_come_in(origin: str, host: str) -> None:
    assert connect(origin=origin, dialled=host) == 101


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "http://localhost.evil.example",
        "http://notlocalhost",
        "http://127.0.0.1.evil.example",
        "http://192.168.1.5",
        "null",
        "file://",
        "http://[",
        "localhost",
    ],
)
def test_other_pages_may_not(origin: str) -> None:
    assert connect(origin=origin) == 403


@pytest.mark.parametrize(
    ("origin", "host"),
    [
        ("http://evil.example", "evil.example"),
        ("http://evil.example:9090", "evil.example:9090"),
        ("http://localhost", "evil.example"),
        ("http://localhost", None),
        ("http://localhost", "["),
    ],
)
def test_a_strangers_name_for_this_machine_is_no_proof(origin: str, host: str | None) -> None:
    assert connect(origin=origin, dialled=host) == 403


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.5"])
def test_a_page_of_the_address_that_was_dialled_may_come_in(host: str) -> None:
    assert connect(origin="http://192.168.1.5:8000", dialled=LAN, host=host) == 101


@pytest.mark.parametrize("origin", ["http://192.168.1.6", "http://10.0.0.1:9090"])
def test_a_page_of_another_machine_in_the_network_may_not(origin: str) -> None:
    assert connect(origin=origin, dialled=LAN) == 403


def test_the_name_that_the_hub_listens_by_is_its_own() -> None:
    assert connect(origin="http://robot.lan", dialled="robot.lan:9090") == 403
    assert connect(origin="http://Robot.LAN", dialled="robot.lan:9090", host="ROBOT.lan") == 101


@pytest.mark.parametrize(
    ("allowed", "origin", "status"),
    [
        ("https://lab.example", "https://lab.example", 101),
        ("https://Lab.example/", "https://LAB.example", 101),
        ("https://lab.example", "http://lab.example", 403),
        ("https://lab.example", "https://lab.example:8443", 403),
        ("https://lab.example", "https://other.example", 403),
        ("https://lab.example", "null", 403),
        ("null", "null", 101),
        ("null", "http://evil.example", 403),
        ("*", "http://evil.example", 101),
        ("*", "null", 101),
    ],
)
@pytest.mark.parametrize("host", [HERE, "lab.example"])
def test_an_operator_may_let_origins_in(allowed: str, origin: str, status: int, host: str) -> None:
    assert connect(origin=origin, dialled=host, allow_origin=(allowed,)) == status


def test_several_origins_may_be_let_in() -> None:
    both = ("https://a.example", "https://b.example")
    assert [connect(origin=origin, allow_origin=both) for origin in both] == [101, 101]


def test_a_refusal_says_how_to_be_let_in() -> None:
    response = ask("/", {"Upgrade": "websocket", "Origin": "http://a.example", "Host": HERE})
    assert response is not None
    assert b"Start the hub with --allow-origin http://a.example to let them in" in response.body


@pytest.mark.parametrize("name", ["Origin", "Host", "Upgrade"])
def test_a_header_that_came_twice_is_refused(name: str) -> None:
    headers = Headers({"Upgrade": "websocket", "Origin": "http://localhost", "Host": HERE})
    headers[name] = "localhost"
    response = ask("/", headers)
    assert response is not None
    assert response.status_code == 400


@pytest.mark.parametrize("path", ["/", "/robot/1?token=x", "/?node=/talker", "/?node=a&node=1"])
def test_a_websocket_may_open_at_any_path(path: str) -> None:
    assert connect(path, origin=None) == 101


@pytest.mark.parametrize("path", ["/?node=", "/?node=~a", "/?node=a%20b", "/?node=1"])
def test_a_node_whose_name_is_not_legal_may_not_come_in(path: str) -> None:
    assert connect(path, origin=None) == 400


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("/", None),
        ("/talker", None),
        ("/?token=x", None),
        ("/?node=/talker", "/talker"),
        ("/?node=talker", "/talker"),
        ("/any/path?token=x&node=robot/arm", "/robot/arm"),
        ("/?node=%2Frobot%2Farm", "/robot/arm"),
        ("//[?node=talker", "/talker"),
    ],
)
def test_a_node_says_its_name_in_the_query(path: str, name: str | None) -> None:
    assert node_name(path) == name


@pytest.mark.parametrize("path", ["/?node=", "/?node=~private", "/?node=a%20b", "/?node=%FF"])
def test_a_node_needs_a_legal_name(path: str) -> None:
    with pytest.raises(InvalidName):
        node_name(path)


@pytest.mark.parametrize("path", ["/", "/?node=talker"])
def test_the_page_is_at_the_root(path: str) -> None:
    response = get(path)
    assert (response.status_code, response.body) == (200, PAGE)
    assert response.headers["Content-Type"] == "text/html; charset=utf-8"
    assert response.headers["Content-Length"] == str(len(PAGE))


@pytest.mark.parametrize("host", ["localhost", "evil.example", "rebound.example:9090"])
def test_roslib_is_for_the_pages_of_any_host(host: str) -> None:
    response = get("/roslib.js", Host=host, Origin=f"http://{host}")
    assert (response.status_code, response.body) == (200, b"var ROSLIB = {};")


def test_health_is_told_as_json() -> None:
    response = get("/healthz")
    assert (response.status_code, json.loads(response.body)) == (
        200,
        {"status": "ok", "clients": 2},
    )
    assert response.headers["Content-Type"] == "application/json; charset=utf-8"


def test_nothing_is_anywhere_else() -> None:
    assert get("/favicon.ico").status_code == 404


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("/", 503),
        ("/?node=x", 503),
        ("/roslib.js?v=2", 404),
        ("/healthz?x", 200),
        ("/nothing", 404),
    ],
)
def test_without_its_page_a_hub_tells_its_health_all_the_same(path: str, status: int) -> None:
    gate = Gate(Settings(), Pages({}), dict)
    for method in ("GET", "HEAD"):
        response = gate.answer(Request(path, Headers(), method))
        assert response is not None
        assert response.status_code == status
        assert (response.body == b"") is (method == "HEAD")
        assert int(response.headers["Content-Length"]) > 0


@pytest.mark.parametrize(
    "path",
    ["/", "/?node=x", "/roslib.js", "/roslib.js?v=2", "/healthz", "/healthz?x", "/nothing?x"],
)
def test_a_head_has_no_body_but_its_length(path: str) -> None:
    response, whole = get(path, "HEAD"), get(path)
    assert (response.status_code, response.body) == (whole.status_code, b"")
    assert response.headers["Content-Length"] == str(len(whole.body))


def test_nothing_can_be_changed() -> None:
    response = get("/", "POST")
    assert (response.status_code, response.headers["Allow"]) == (405, "GET, HEAD")


@pytest.mark.parametrize("path", ["/", "/healthz", "/nothing"])
def test_a_browser_may_not_guess_what_an_answer_is(path: str) -> None:
    response = get(path)
    assert response.headers["X-Content-Type-Options"] == "nosniff"
    assert response.headers["Connection"] == "close"


@pytest.mark.parametrize(
    ("host", "allowed", "status"),
    [
        ("localhost:9090", (), 200),
        ("127.0.0.1:9090", (), 200),
        ("192.168.1.5:9090", (), 200),
        ("rebound.example:9090", (), 403),
        ("rebound.example:9090", ("http://rebound.example:9090",), 200),
        ("rebound.example:9090", ("*",), 200),
        ("[", (), 403),
    ],
)
def test_the_hubs_health_is_told_by_names_of_its_own(
    host: str, allowed: tuple[str, ...], status: int
) -> None:
    gate = Gate(Settings(allow_origin=allowed), Pages({}), dict)
    response = gate.answer(Request("/healthz", Headers({"Host": host})))
    assert response is not None
    assert response.status_code == status
