"""HTTP requests: which WebSockets may open, and the resources."""

from __future__ import annotations

import json
from typing import Any
from urllib.parse import urljoin

import pytest
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from fibws.errors import HubError, InvalidName
from fibws.hub.http.requests import HttpRequests, node_name
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
    files = {"index.html": PAGE, "roslib.js": b"var ROSLIB = {};", "roslib.mjs": b"export {};"}
    return requests(files, **settings).respond(Request(path, Headers(headers or {}), method))


def requests(files: dict[str, bytes], **settings: Any) -> HttpRequests:
    """Return the HTTP handler of the hub's port: these files, and /healthz."""
    http = HttpRequests(Settings(**settings), files, reserved=["/rosapi"])
    http.add("/healthz", lambda: b'{"status":"ok","clients":2}', "application/json")
    return http


def connect(
    path: str = "/", *, origin: str | None, dialled: str | None = HERE, **settings: Any
) -> int:
    """Return the status of the response to a WebSocket request; 101 if it may open."""
    headers = {"Upgrade": "websocket", "Origin": origin, "Host": dialled}
    response = ask(path, {name: value for name, value in headers.items() if value}, **settings)
    return response.status_code if response else 101


def get(path: str, method: str = "GET", **headers: str) -> Response:
    response = ask(path, headers, method)
    assert response is not None
    return response


@pytest.mark.parametrize("host", [HERE, LAN, "evil.example", None])
def test_programs_without_an_origin_may_connect(host: str | None) -> None:
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
def test_pages_of_this_machine_may_connect(origin: str, host: str) -> None:
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
def test_pages_of_other_origins_are_refused(origin: str) -> None:
    assert connect(origin=origin) == 403


@pytest.mark.parametrize(
    ("origin", "host"),
    [
        ("http://evil.example", "evil.example"),
        ("http://evil.example:9090", "evil.example:9090"),
        ("http://localhost", "evil.example"),
        ("http://localhost", None),
    ],
)
def test_unknown_host_names_for_this_machine_are_refused(origin: str, host: str | None) -> None:
    assert connect(origin=origin, dialled=host) == 403


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.5"])
def test_page_of_the_dialled_address_may_connect(host: str) -> None:
    assert connect(origin="http://192.168.1.5:8000", dialled=LAN, host=host) == 101


@pytest.mark.parametrize("origin", ["http://192.168.1.6", "http://10.0.0.1:9090"])
def test_page_of_another_machine_in_the_network_is_refused(origin: str) -> None:
    assert connect(origin=origin, dialled=LAN) == 403


def test_host_setting_is_a_name_of_the_hub() -> None:
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
def test_allowed_origins_may_connect(allowed: str, origin: str, status: int, host: str) -> None:
    assert connect(origin=origin, dialled=host, allow_origin=(allowed,)) == status


def test_several_origins_may_be_allowed() -> None:
    both = ("https://a.example", "https://b.example")
    assert [connect(origin=origin, allow_origin=both) for origin in both] == [101, 101]


def test_refusal_names_the_option_that_allows_the_origin() -> None:
    response = ask("/", {"Upgrade": "websocket", "Origin": "http://a.example", "Host": HERE})
    assert response is not None
    assert b"Start the hub with --allow-origin http://a.example to let them in" in response.body


@pytest.mark.parametrize("name", ["Origin", "Host", "Upgrade"])
def test_duplicate_header_is_refused(name: str) -> None:
    headers = Headers({"Upgrade": "websocket", "Origin": "http://localhost", "Host": HERE})
    headers[name] = "localhost"
    response = ask("/", headers)
    assert response is not None
    assert response.status_code == 400


@pytest.mark.parametrize("path", ["/", "/robot/1?token=x", "/?node=/talker", "/?node=a&node=1"])
def test_websocket_may_open_at_any_path(path: str) -> None:
    assert connect(path, origin=None) == 101


@pytest.mark.parametrize("path", ["/?node=", "/?node=~a", "/?node=a%20b", "/?node=%FF"])
def test_invalid_node_name_is_refused(path: str) -> None:
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
        ("/?node=my-node", "/my-node"),
        ("/?node=1", "/1"),
        ("/?node=/a//%C3%BC", "/a/\u00fc"),
    ],
)
def test_node_name_is_read_from_the_query(path: str, name: str | None) -> None:
    assert node_name(path) == name


@pytest.mark.parametrize("path", ["/?node=", "/?node=~private", "/?node=a%20b", "/?node=%FF"])
def test_invalid_node_name_raises(path: str) -> None:
    with pytest.raises(InvalidName):
        node_name(path)


@pytest.mark.parametrize("path", ["/", "/?node=talker"])
def test_page_is_at_the_root(path: str) -> None:
    response = get(path)
    assert (response.status_code, response.body) == (200, PAGE)
    assert response.headers["Content-Type"] == "text/html; charset=utf-8"
    assert response.headers["Content-Length"] == str(len(PAGE))


@pytest.mark.parametrize("host", ["localhost", "evil.example", "rebound.example:9090"])
def test_roslib_is_served_to_pages_of_any_host(host: str) -> None:
    for path, body in (("/roslib.js", b"var ROSLIB = {};"), ("/roslib.mjs", b"export {};")):
        response = get(path, Host=host, Origin=f"http://{host}")
        assert (response.status_code, response.body) == (200, body)
        assert response.headers["Content-Type"] == "text/javascript; charset=utf-8"
        assert response.headers["Access-Control-Allow-Origin"] == "*"


def test_health_is_json() -> None:
    response = get("/healthz")
    assert (response.status_code, json.loads(response.body)) == (
        200,
        {"status": "ok", "clients": 2},
    )
    assert response.headers["Content-Type"] == "application/json; charset=utf-8"


def test_unknown_paths_are_404() -> None:
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
def test_health_is_served_without_the_built_page(path: str, status: int) -> None:
    http = requests({})
    for method in ("GET", "HEAD"):
        response = http.respond(Request(path, Headers(), method))
        assert response is not None
        assert response.status_code == status
        assert (response.body == b"") is (method == "HEAD")
        assert int(response.headers["Content-Length"]) > 0


def test_missing_page_says_how_to_build_it() -> None:
    response = requests({}).respond(Request("/", Headers(), "GET"))
    assert response is not None and response.body is not None
    assert b"FIBWS_SKIP_PAGE" in response.body and b"pip install" in response.body


@pytest.mark.parametrize(
    "path",
    ["/", "/?node=x", "/roslib.js", "/roslib.js?v=2", "/healthz", "/healthz?x", "/nothing?x"],
)
def test_head_has_no_body_but_the_content_length(path: str) -> None:
    response, whole = get(path, "HEAD"), get(path)
    assert (response.status_code, response.body) == (whole.status_code, b"")
    assert response.headers["Content-Length"] == str(len(whole.body))


def test_post_is_refused() -> None:
    response = get("/", "POST")
    assert (response.status_code, response.headers["Allow"]) == (405, "GET, HEAD")


@pytest.mark.parametrize("path", ["/", "/healthz", "/nothing"])
def test_responses_forbid_content_sniffing(path: str) -> None:
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
        ("[", (), 400),
    ],
)
def test_health_is_served_only_under_the_hubs_own_names(
    host: str, allowed: tuple[str, ...], status: int
) -> None:
    http = requests({}, allow_origin=allowed)
    response = http.respond(Request("/healthz", Headers({"Host": host})))
    assert response is not None
    assert response.status_code == status


@pytest.mark.parametrize("content_type", ["application/json", "text/plain", "image/png"])
def test_added_resource_is_served(content_type: str) -> None:
    bodies = iter((b"first", b"second"))
    http = requests({})
    http.add("/graph", lambda: next(bodies), content_type)
    for body in (b"first", b"second"):
        response = http.respond(Request("/graph?x=1", Headers()))
        assert response is not None
        assert (response.status_code, response.body) == (200, body)
        assert response.headers["Content-Type"].startswith(content_type)
        assert response.headers["Content-Length"] == str(len(body))


@pytest.mark.parametrize(
    ("host", "allowed", "status"),
    [
        ("localhost:9090", (), 200),
        ("rebound.example:9090", (), 403),
        ("rebound.example:9090", ("http://rebound.example:9090",), 200),
    ],
)
def test_added_resource_is_only_for_the_hubs_own_names(
    host: str, allowed: tuple[str, ...], status: int
) -> None:
    http = requests({}, allow_origin=allowed)
    http.add("/graph", lambda: b"the graph", "text/plain")
    response = http.respond(Request("/graph", Headers({"Host": host})))
    assert response is not None
    assert response.status_code == status
    assert (b"the graph" in response.body) is (status == 200)


def test_head_of_an_added_resource_has_no_body() -> None:
    http = requests({})
    http.add("/graph", lambda: b"the graph", "text/plain")
    response = http.respond(Request("/graph", Headers(), "HEAD"))
    assert response is not None
    assert (response.status_code, response.body) == (200, b"")


@pytest.mark.parametrize("name", ["/rosapi", "rosapi"])
def test_reserved_node_names_are_refused(name: str) -> None:
    assert connect(f"/?node={name}", origin=None) == 400


class TestOriginsWithTls:
    """The browser has verified a certificate of the name in the header Host."""

    @pytest.mark.parametrize("origin", ["https://robot.example", "https://robot.example:8443"])
    @pytest.mark.parametrize("host", ["robot.example", "robot.example:8443", "ROBOT.example:1"])
    def test_page_under_the_name_may_connect(self, origin: str, host: str) -> None:
        assert connect_securely(origin, host) == 101

    @pytest.mark.parametrize(
        "origin",
        ["https://evil.example", "http://robot.example", "https://sub.robot.example", "null"],
    )
    def test_other_pages_may_not_connect(self, origin: str) -> None:
        assert connect_securely(origin, "robot.example") == 403

    def test_without_tls_the_name_proves_nothing(self) -> None:
        assert connect(origin="https://robot.example", dialled="robot.example") == 403

    def test_name_may_read_the_state(self) -> None:
        secure = {"Host": "robot.example", "X-Forwarded-Proto": "https"}
        plain = {"Host": "robot.example", "X-Forwarded-Proto": "http"}
        assert [status("/healthz", each) for each in (secure, plain)] == [200, 403]


def connect_securely(origin: str, host: str) -> int:
    return status(
        "/",
        {"Upgrade": "websocket", "Origin": origin, "Host": host, "X-Forwarded-Proto": "https"},
    )


def status(path: str, headers: dict[str, str], **settings: Any) -> int:
    response = ask(path, headers, **settings)
    return response.status_code if response else 101


class TestUrlPath:
    @pytest.mark.parametrize("url_path", ["/robot", "/robot/"])
    @pytest.mark.parametrize("path", ["/", "/?x=1", "/healthz", "/origin", "/roslib.js"])
    def test_everything_is_below_the_path(self, url_path: str, path: str) -> None:
        assert status(f"/robot{path}", {"Host": HERE}, url_path=url_path) == 200
        assert status(path, {"Host": HERE}, url_path=url_path) == 404

    @pytest.mark.parametrize("path", ["/robots/", "/robo", "/robot2", "//robot/", "/x/robot/"])
    def test_other_paths_are_not_found(self, path: str) -> None:
        response = ask(path, {"Host": HERE}, url_path="/robot")
        assert response is not None and response.status_code == 404
        assert b"/robot/" in response.body

    @pytest.mark.parametrize("query", ["", "?token=x&node=/a"])
    def test_page_without_the_last_slash_is_redirected(self, query: str) -> None:
        response = ask(f"/lab/robot{query}", {"Host": HERE}, url_path="/lab/robot")
        assert response is not None and response.status_code == 307
        base = "https://proxy.example/more/lab/robot"
        assert urljoin(base, response.headers["Location"]) == f"{base}/{query}"

    @pytest.mark.parametrize("path", ["/robot", "/robot/", "/robot?node=/a", "/robot/x?node=/a"])
    def test_websocket_opens_below_the_path(self, path: str) -> None:
        headers = {"Upgrade": "websocket", "Host": HERE}
        assert status(path, headers, url_path="/robot") == 101
        assert status(path.removeprefix("/robot") or "/", headers, url_path="/robot") == 404

    def test_name_of_a_node_is_found(self) -> None:
        headers = {"Upgrade": "websocket", "Host": HERE}
        assert status("/robot?node=/rosapi", headers, url_path="/robot") == 400

    @pytest.mark.parametrize("url_path", ["robot", "/robot?x", "/a b", "//", "/robot#x", "/\n"])
    def test_invalid_path_is_refused(self, url_path: str) -> None:
        with pytest.raises(HubError, match="url_path"):
            Settings(url_path=url_path)


@pytest.mark.parametrize(
    ("headers", "counts"),
    [
        ({"Upgrade": "websocket"}, True),
        ({"Upgrade": "WebSocket", "Origin": f"http://{HERE}"}, True),
        ({"Upgrade": "websocket", "Origin": "https://evil.example"}, False),
        ({"Authorization": "Bearer x"}, True),
        ({}, False),
        ({"Origin": "https://evil.example"}, False),
        ({"Cookie": "fibws_session=x", "Sec-Fetch-Site": "cross-site"}, False),
    ],
)
def test_requests_that_any_page_can_send_do_not_count(
    headers: dict[str, str], counts: bool
) -> None:
    assert requests({}).is_deliberate(Headers({"Host": HERE, **headers})) is counts
