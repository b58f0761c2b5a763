"""Which pages may connect: origins and host names, and what the hub says about them."""

from __future__ import annotations

import json

import pytest
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from fibws.errors import HubError
from fibws.hub.http.requests import HttpRequests
from fibws.hub.settings import Settings
from fibws.origins import AllowedOrigins, OwnHosts, WebOrigin

HERE = "localhost:9090"


def may_connect(origin: str, *allowed: str, host: str = HERE, listens_on: str = "") -> bool:
    return AllowedOrigins(allowed, OwnHosts([listens_on])).refusal_of(origin, host) is None


def respond(path: str, headers: Headers, *allowed: str) -> Response:
    http = HttpRequests(Settings(allow_origin=allowed), {})
    http.add("/healthz", lambda: b"{}", "application/json")
    response = http.respond(Request(path, headers))
    assert response is not None
    return response


@pytest.mark.parametrize(
    ("text", "origin"),
    [
        ("https://lab.example", ("https", "lab.example", 443)),
        ("HTTPS://LAB.example:443", ("https", "lab.example", 443)),
        ("http://lab.example", ("http", "lab.example", 80)),
        ("http://lab.example:443", ("http", "lab.example", 443)),
        ("http://lab.example.", ("http", "lab.example.", 80)),
        ("http://my_robot:9090", ("http", "my_robot", 9090)),
        ("http://[0:0::1]:9090", ("http", "::1", 9090)),
        ("http://[FE80::1%eth0]", ("http", "fe80::1%eth0", 80)),
        ("app://robot", ("app", "robot", None)),
        ("file://", ("file", "", None)),
    ],
)
def test_origin_is_parsed(text: str, origin: tuple[str, str, int | None]) -> None:
    assert WebOrigin.parse(text) == origin


@pytest.mark.parametrize(
    "text",
    [
        "",
        "null",
        "localhost",
        "http:localhost",
        "http:/localhost",
        "http://",
        "//localhost",
        "http://localhost/",
        "http://localhost/page",
        "http://localhost?x",
        "http://localhost#x",
        "http://user@localhost",
        "http://localhost@evil.example",
        "http://localhost:pass@evil.example",
        "http://evil.example\\@localhost",
        "http://localhost:",
        "http://localhost:x",
        "http://localhost:0",
        "http://localhost:65536",
        "http://localhost:80:80",
        "http://localhost:-1",
        "http://localhost:٨٠",
        "http://localhost ",
        " http://localhost",
        "http://local host",
        "http://localhost\n",
        "http://localhost, http://evil.example",
        "http://löcalhost",
        "http://::1",
        "http://[::1",
        "http://[::g]",
        "http://[127.0.0.1]",
    ],
)
def test_text_that_is_not_exactly_an_origin_is_refused(text: str) -> None:
    assert WebOrigin.parse(text) is None
    assert not may_connect(text)
    assert not may_connect(text, "http://localhost")


@pytest.mark.parametrize(
    ("allowed", "origin"),
    [
        ("https://lab.example:443", "https://lab.example"),
        ("https://lab.example", "https://lab.example:443"),
        ("http://Lab.Example:80/", "http://lab.example"),
        ("http://[2001:DB8:0::5]:9090", "http://[2001:db8::5]:9090"),
        ("http://lab.example.", "http://lab.example."),
        ("file://", "file://"),
    ],
)
def test_spelling_of_an_allowed_origin_does_not_matter(allowed: str, origin: str) -> None:
    assert may_connect(origin, allowed)
    assert may_connect(origin, allowed, host="robot.local")


@pytest.mark.parametrize(
    "origin",
    [
        "http://lab.example",
        "https://lab.example:80",
        "https://lab.example:8443",
        "https://lab.example.",
        "https://www.lab.example",
        "https://lab.example.evil.example",
        "https://xlab.example",
        "wss://lab.example",
        "null",
        "file://",
    ],
)
def test_other_origin_than_the_allowed_one_is_refused(origin: str) -> None:
    assert not may_connect(origin, "https://lab.example")


@pytest.mark.parametrize(
    "host",
    [
        "localhost.",
        "robot.localhost.",
        "127.0.0.1.",
        "127.1",
        "0x7f000001",
        "2130706433",
        "localhost.evil.example",
        "evil.example:9090",
    ],
)
def test_unusual_spelling_of_this_machine_is_not_its_name(host: str) -> None:
    assert not may_connect("http://localhost:9090", host=host)
    assert not may_connect(f"http://{host}", host=host)
    assert not AllowedOrigins((), OwnHosts(["127.0.0.1"])).knows_host(host)


def test_address_is_compared_in_any_spelling_and_with_any_port() -> None:
    assert may_connect("http://[2001:db8::5]:3000", host="[2001:DB8:0::5]:9090")
    assert not may_connect("http://[2001:db8::6]", host="[2001:db8::5]:9090")
    assert may_connect("http://[::1]", host="[::1]:9090", listens_on="::1")


@pytest.mark.parametrize("host", ["lab.example", "LAB.example:443"])
def test_host_of_an_allowed_origin_behind_a_proxy_is_known(host: str) -> None:
    assert AllowedOrigins(("https://lab.example",), OwnHosts(["127.0.0.1"])).knows_host(host)


@pytest.mark.parametrize("host", ["lab.example:80", "lab.example:9090", "lab.example."])
def test_host_with_another_port_or_dot_is_not_known(host: str) -> None:
    assert not AllowedOrigins(("https://lab.example",), OwnHosts(["127.0.0.1"])).knows_host(host)


@pytest.mark.parametrize("upgrade", [True, False])
@pytest.mark.parametrize(
    "host",
    [
        "",
        "[",
        "user@localhost",
        "localhost/",
        "localhost:x",
        "localhost:99999",
        "a b",
        "localhost,a",
    ],
)
def test_invalid_host_header_is_a_bad_request(host: str, upgrade: bool) -> None:
    headers = Headers({"Host": host})
    if upgrade:
        headers["Upgrade"] = "websocket"
    assert respond("/healthz", headers).status_code == 400


@pytest.mark.parametrize("path", ["/", "/healthz", "/origin", "/nothing"])
def test_several_host_headers_are_a_bad_request(path: str) -> None:
    headers = Headers([("Host", "localhost"), ("Host", "localhost")])
    assert respond(path, headers).status_code == 400


@pytest.mark.parametrize(
    "origin",
    [
        "lab.example",
        "https://",
        "https://lab.example/page",
        "https://me@lab.example",
        "nothing",
        "",
    ],
)
def test_setting_that_no_page_can_match_is_refused(origin: str) -> None:
    with pytest.raises(HubError, match="allow_origin"):
        Settings(allow_origin=(origin,))


class TestDescription:
    """What ``/origin`` says."""

    def test_page_under_an_unknown_name_gets_the_option_that_lets_it_in(self) -> None:
        origin = "http://robot.local:9090"
        headers = Headers({"Host": "robot.local:9090", "Referer": f"{origin}/"})
        said = json.loads(respond("/origin", headers).body)
        assert (said["origin"], said["allowed"]) == (origin, False)
        assert said["option"] == f"--allow-origin {origin}"
        assert said["option"] in said["reason"]
        assert json.loads(respond("/origin", headers, origin).body)["allowed"] is True

    def test_page_behind_a_proxy_gets_its_own_origin_and_not_the_proxys(self) -> None:
        headers = Headers({"Host": "127.0.0.1:9090", "Referer": "https://lab.example/robot/"})
        said = json.loads(respond("/origin", headers).body)
        assert said["option"] == "--allow-origin https://lab.example"

    def test_other_servers_page_is_known_by_its_origin(self) -> None:
        headers = Headers({"Host": HERE, "Origin": "null", "Referer": "http://localhost:9090/"})
        said = json.loads(respond("/origin", headers).body)
        assert (said["origin"], said["allowed"]) == ("null", False)
        assert said["option"] == "--allow-origin null"

    @pytest.mark.parametrize("referer", ["", "localhost", "http://me@localhost/", "http://"])
    def test_request_without_an_origin_is_allowed(self, referer: str) -> None:
        said = json.loads(respond("/origin", Headers({"Host": HERE, "Referer": referer})).body)
        assert (said["origin"], said["allowed"], said["reason"]) == (None, True, "")

    def test_every_page_may_read_it_and_no_cache_keeps_it(self) -> None:
        headers = respond("/origin", Headers({"Host": HERE})).headers
        assert headers["Access-Control-Allow-Origin"] == "*"
        assert headers["Cache-Control"] == "no-store"

    def test_it_decides_as_the_websocket_does(self) -> None:
        http = HttpRequests(Settings(allow_origin=("https://lab.example",)), {})
        for origin in ("https://lab.example", "http://lab.example", "http://localhost", "null"):
            for host in (HERE, "lab.example", "192.168.1.5:9090"):
                headers = Headers({"Host": host, "Origin": origin})
                said = http.respond(Request("/origin", headers))
                headers["Upgrade"] = "websocket"
                opened = http.respond(Request("/", headers)) is None
                assert said is not None
                assert json.loads(said.body)["allowed"] is opened
