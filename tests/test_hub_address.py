"""Where a node finds its hub."""

import re
from urllib.parse import urlsplit

import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_inputs import examples
from websockets.uri import parse_uri

import fibws
from fibws.errors import InvalidAddress
from fibws.hub_address import (
    hub_url,
    is_loopback,
    node_url,
    page_url,
    redirected,
    token_in,
    without_token,
)
from fibws.hub_advice import advice


def test_address_of_a_page_is_corrected() -> None:
    with pytest.raises(InvalidAddress, match=r"expected wss://, got https://\. Write wss://"):
        hub_url("https://robot:9090")
    with pytest.raises(InvalidAddress, match=r"expected ws://, got http://\. Write ws://"):
        hub_url("http://robot:9090")


@pytest.mark.parametrize(
    ("address", "url"),
    [
        ("ws://127.0.0.1:9090", "ws://127.0.0.1:9090"),
        ("wss://robot/bridge?a=b&c", "wss://robot/bridge?a=b&c"),
        ("robot:9090", "ws://robot:9090"),
        ("robot", "ws://robot:9090"),
        ("robot/bridge?a=b", "ws://robot:9090/bridge?a=b"),
        ("ws://robot", "ws://robot"),
        (" robot:9090\n", "ws://robot:9090"),
        ("[::1]", "ws://[::1]:9090"),
        ("[::1]:9090", "ws://[::1]:9090"),
        ("127.0.0.1:9090/path", "ws://127.0.0.1:9090/path"),
    ],
)
def test_scheme_and_port_have_defaults(address: str, url: str) -> None:
    assert hub_url(address) == url


@pytest.mark.parametrize("address", [None, ""])
def test_environment_gives_the_default_address(
    address: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FIBWS_HUB", "robot")
    assert hub_url(address) == "ws://robot:9090"
    monkeypatch.setenv("FIBWS_HUB", "")
    assert hub_url(address) == "ws://127.0.0.1:9090"
    monkeypatch.delenv("FIBWS_HUB")
    assert hub_url(address) == "ws://127.0.0.1:9090"


@pytest.mark.parametrize(
    ("address", "fault"),
    [
        ("http://robot:9090", "http://"),
        ("9090", "the host is missing"),
        ("ws://", "the host is missing"),
        (" ", "the host is missing"),
        ("ws://:9090", "the host is missing"),
        ("my robot:9090", "the host is missing"),
        ("ws://robot:ninety", "must be a number from 1 to 65535, got ninety"),
        ("ws://robot:70000", "must be a number from 1 to 65535, got 70000"),
        ("ws:/robot:9090", "expected ws://, got ws:/"),
        ("wss:/robot", "expected wss://, got wss:/"),
        ("ws://robot:", "the port is missing"),
        ("robot:", "the port is missing"),
        ("robot:/path", "the port is missing"),
        ("pi@robot", "a user without a password"),
        ("robot..example", "robot..example is not a host name"),
        (f"{'r' * 64}.example", "is not a host name"),
        (".ä", "is not a host name"),
        ("ws://robot:0", "port is 0"),
        ("ws://[::1", "Invalid IPv6"),
        ("ws://robot/#there", "# part"),
    ],
)
def test_invalid_address_is_explained(address: str, fault: str) -> None:
    with pytest.raises(ValueError, match="is not the address of a hub") as caught:
        hub_url(address)
    assert fault in str(caught.value)
    assert re.search(r"Write wss?://host:port", str(caught.value))


@given(st.text(st.sampled_from("ws:/[]@#?%.= 1é\x00"), max_size=12))
@examples(5)
def test_address_is_refused_or_can_be_used(address: str) -> None:
    try:
        url = hub_url(address)
    except InvalidAddress:
        return
    assert parse_uri(node_url(url, "/talker")).host
    assert urlsplit(page_url(url)).hostname
    assert advice(url)


def test_node_name_is_in_the_query() -> None:
    assert node_url("ws://robot:9090", "/talker_7") == "ws://robot:9090/?node=/talker_7"


def test_other_keys_of_the_query_are_kept() -> None:
    url = node_url("wss://robot/bridge?token=a%20b&node=/old&flag=", "/talker")
    assert url == "wss://robot/bridge?token=a%20b&flag=&node=/talker"


@pytest.mark.parametrize(
    ("hub", "path", "page"),
    [
        ("ws://robot:9090", "", "http://robot:9090/"),
        ("wss://lab/robot", "", "https://lab/robot/"),
        ("wss://lab/robot/?key=5", "healthz", "https://lab/robot/healthz"),
    ],
)
def test_page_is_below_the_path_of_the_hub(hub: str, path: str, page: str) -> None:
    assert page_url(hub, path) == page


@pytest.mark.parametrize(
    ("hub", "location", "target"),
    [
        ("wss://lab/robot", "/robot/?node=/talker", "wss://lab/robot/"),
        (
            "wss://lab/robot?key=5",
            "https://lab/robot/?key=5&node=/a",
            "wss://lab/robot/?key=5",
        ),
        ("wss://lab:8443/robot", "http://lab/robot/", "wss://lab:8443/robot/"),
        ("ws://lab/robot", "http://other:81/robot/", "ws://other:81/robot/"),
        ("ws://lab/robot", "https://lab/robot/", "wss://lab/robot/"),
    ],
)
def test_redirect_leads_to_a_hub(hub: str, location: str, target: str) -> None:
    assert redirected(hub, location) == target


@pytest.mark.parametrize("location", ["http://other/robot/", "mailto:robot@lab", "http://["])
def test_redirect_without_tls_or_to_no_hub_is_refused(location: str) -> None:
    with pytest.raises(InvalidAddress):
        redirected("wss://lab/robot", location)


@pytest.mark.parametrize(
    ("address", "token", "rest"),
    [
        ("ws://robot:9090/?token=abc", "abc", "ws://robot:9090/"),
        ("robot?token=a%2Bb", "a+b", "robot"),
        ("wss://robot/x?a=%20&token=abc&b", "abc", "wss://robot/x?a=%20&b"),
        ("wss://robot/x?%74oken=abc#part", "abc", "wss://robot/x#part"),
        ("wss://robot/x?token=&a=b", None, "wss://robot/x?a=b"),
        ("wss://robot/x?a=b&&c", None, "wss://robot/x?a=b&&c"),
        ("wss://robot/token=abc", None, "wss://robot/token=abc"),
        ("robot", None, "robot"),
    ],
)
def test_token_is_taken_out_of_an_address(address: str, token: str | None, rest: str) -> None:
    assert token_in(address) == token
    assert without_token(address) == rest


@pytest.mark.parametrize(
    "address", ["robot?token=secret", "http://robot?token=secret", "ws://robot:0/?token=secret"]
)
def test_token_is_not_in_urls_and_errors(address: str) -> None:
    try:
        shown = hub_url(address)
    except InvalidAddress as error:
        shown = str(error)
    assert "secret" not in shown


@pytest.mark.parametrize("host", ["127.0.0.1", "127.1.2.3", "::1", "localhost", "LOCALHOST"])
def test_loopback_is_recognized(host: str) -> None:
    assert is_loopback(host)


@pytest.mark.parametrize("host", ["127.0.0.1.example.org", "robot", "10.0.0.1", "", "127.0.0"])
def test_other_hosts_are_not_loopback(host: str) -> None:
    assert not is_loopback(host)


@pytest.mark.parametrize(
    ("url", "answers", "expected"),
    [
        ("ws://127.0.0.1:9090", False, "Start one with: fibws hub"),
        ("ws://localhost:9095/", False, "Start one with: fibws hub --port 9095"),
        ("wss://127.0.0.1:9090", False, "Start one with: fibws hub --self-signed"),
        ("ws://127.0.0.1:9090", True, "start a hub elsewhere: fibws hub --port 9091"),
        ("ws://localhost", False, "it is 80: perhaps ws://localhost:9090"),
        ("ws://lab", True, "it is 80: perhaps ws://lab:9090 or wss://lab"),
        ("ws://lab.example/robot/", False, "ws://lab.example:9090 or wss://lab.example/robot"),
        ("wss://lab", False, "it is 443: perhaps wss://lab:9090"),
        ("ws://[fd00::1]", False, "perhaps ws://[fd00::1]:9090"),
        ("ws://lab:443", True, "Perhaps wss://lab:443"),
        (
            "ws://lab:9090",
            False,
            "Check the address, and that the hub there was started with --host",
        ),
        ("ws://10.0.0.7:9090", True, "Check the address"),
    ],
)
def test_advice_depends_on_whose_address_it_is(url: str, answers: bool, expected: str) -> None:
    found = advice(url, answers=answers)
    assert expected in found
    assert ("fibws hub" in found) == ("fibws hub" in expected)


def test_address_is_a_string() -> None:
    with pytest.raises(TypeError, match="must be a string such as ws://"):
        fibws.Node("talker", hub=9090)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="got 9090"):
        fibws.Hub(9090)  # type: ignore[arg-type]
