"""Many hubs, hubs that are refused, and the tutorial's programs on three hubs."""

from __future__ import annotations

import asyncio
import logging
import re
from pathlib import Path

import pytest
from certificates import Authority
from certificates import authority as authority
from client.servers import redirecting_server
from conftest import StartHub
from patience import PATIENCE
from running_programs import Start
from running_programs import start as start

from fibws.msg.std_msgs import Int32

from ..token_clients import entry
from .conftest import Join, StartNode, until
from .test_federation import peers, remote_nodes, take

HUBS, TOPICS = 20, 50


@pytest.mark.slow
async def test_fleet_of_twenty_hubs_with_fifty_topics_each_has_one_graph(
    join: Join, start_node: StartNode
) -> None:
    center = await join("center")
    hubs = [center, *[await join(f"hub{number}", center) for number in range(1, HUBS)]]
    nodes = [await start_node(f"node{number}", hub) for number, hub in enumerate(hubs)]
    publishers = [
        [
            await node.advertise(f"topic_{number}_{each}", Int32, peers=True)
            for each in range(TOPICS)
        ]
        for number, node in enumerate(nodes)
    ]
    names = {f"/topic_{number}_{each}" for number in range(HUBS) for each in range(TOPICS)}
    await until(lambda: all(names <= hub.graph.topics.keys() for hub in hubs), *hubs)
    for number, hub in enumerate(hubs):
        others = {f"/node{other}" for other in range(HUBS) if other != number}
        assert remote_nodes(hub).keys() == others
    # Each node gets the messages of the next one.
    subscriptions = [
        nodes[number - 1].subscribe(f"topic_{number}_7", Int32, queue_size=100)
        for number in range(HUBS)
    ]
    for number, subscription in enumerate(subscriptions):
        await peers(publishers[number][7], 1)
        for each in range(20):
            await publishers[number][7].publish(data=each)
        assert await take(subscription, 20) == list(range(20))


async def test_hub_with_a_wrong_token_is_refused_and_both_sides_log_why(
    start_hub: StartHub, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    tokens = tmp_path / "tokens.toml"
    tokens.write_text(entry("robot", "admin = true"))
    cloud = await start_hub(hub_name="cloud", tokens=tokens)
    robot = await start_hub(hub_name="robot", join=(f"{cloud.url}/?token=of-another-hub",))
    await logged(caplog, r"Not joined to ws://127.0.0.1:\d+.* \(unknown token\)")
    await logged(caplog, r"Refused 127\.0\.0\.1: unknown token")
    assert cloud.federation.peers == robot.federation.peers == []
    assert "of-another-hub" not in caplog.text


async def test_hub_without_a_token_is_refused_and_both_sides_log_why(
    start_hub: StartHub, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    tokens = tmp_path / "tokens.toml"
    tokens.write_text(entry("robot", "admin = true"))
    cloud = await start_hub(hub_name="cloud", tokens=tokens)
    robot = await start_hub(hub_name="robot", join=(cloud.url,))
    await logged(caplog, r"Not joined to ws://127.0.0.1:\d+.* \(.*missing token")
    assert cloud.federation.peers == robot.federation.peers == []


async def test_hub_is_joined_where_a_proxy_redirects_to(start_hub: StartHub) -> None:
    cloud = await start_hub(hub_name="cloud")
    with redirecting_server(f"http://127.0.0.1:{cloud.port}/robot/") as url:
        robot = await start_hub(hub_name="robot", join=(url,))
        await until(lambda: cloud.federation.peers and robot.federation.peers, cloud)


async def test_hub_is_joined_where_a_server_without_tls_redirects_to_tls(
    start_hub: StartHub, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FIBWS_CA", str(authority.file))
    certificate, key = authority.issue("127.0.0.1")
    cloud = await start_hub(hub_name="cloud", cert=certificate, key=key)
    with redirecting_server(f"https://127.0.0.1:{cloud.port}/robot/") as url:
        robot = await start_hub(hub_name="robot", join=(url,))
        await until(lambda: cloud.federation.peers and robot.federation.peers, cloud)


@pytest.mark.parametrize("has_tls", [False, True])
async def test_another_server_that_redirects_does_not_get_the_token_passed_on(
    start_hub: StartHub,
    authority: Authority,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    has_tls: bool,
) -> None:
    monkeypatch.setenv("FIBWS_CA", str(authority.file))
    tokens = tmp_path / "tokens.toml"
    tokens.write_text(entry("robot", "admin = true"))
    certificate, key = authority.issue("127.0.0.1") if has_tls else (None, None)
    cloud = await start_hub(hub_name="cloud", tokens=tokens, cert=certificate, key=key)
    scheme = "https" if has_tls else "http"
    with redirecting_server(f"{scheme}://127.0.0.1:{cloud.port}/") as url:
        await start_hub(hub_name="robot", join=(f"{url}?token=robot",))
        await logged(caplog, r"Not joined to ws://127.0.0.1:\d+/robot \(.*missing token")
    assert cloud.federation.peers == []


async def test_redirect_to_no_hub_is_logged(
    start_hub: StartHub, caplog: pytest.LogCaptureFixture
) -> None:
    with redirecting_server("ftp://lab/") as url:
        await start_hub(hub_name="robot", join=(url,))
        await logged(caplog, r"Not joined to .*ftp://lab/.* redirects to it")


async def test_hub_whose_token_does_not_allow_its_node_is_refused_and_logs_why(
    start_hub: StartHub, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    tokens = tmp_path / "tokens.toml"
    tokens.write_text(entry("robot", 'allow = {node = ["/robot7/**"]}'))
    cloud = await start_hub(hub_name="cloud", tokens=tokens)
    robot = await start_hub(
        hub_name="robot", join=(f"{cloud.url}/?token=robot",), join_prefix="/robot8"
    )
    await logged(caplog, r"Not joined to ws://127.0.0.1:\d+.* \(.*/robot8/hub")
    assert cloud.federation.peers == robot.federation.peers == []


async def test_token_of_a_hub_limits_what_it_and_its_nodes_may_do(
    start_hub: StartHub, start_node: StartNode, tmp_path: Path
) -> None:
    tokens = tmp_path / "tokens.toml"
    allowed = 'node = ["/**"], publish = ["/scan"], subscribe = ["/cmd_vel"]'
    tokens.write_text(entry("robot", f"allow = {{{allowed}}}") + entry("viewer", "admin = true"))
    cloud = await start_hub(hub_name="cloud", tokens=tokens)
    robot = await start_hub(hub_name="robot", join=(f"{cloud.url}/?token=robot",))
    await until(lambda: cloud.federation.peers, cloud)
    talker = await start_node("talker", robot)
    for topic in ("secret", "scan"):
        await talker.advertise(topic, Int32)
    await until(lambda: "/scan" in cloud.graph.topics, cloud)
    await until(lambda: cloud.graph.topics["/scan"].sources, cloud)
    secret = cloud.graph.topics.get("/secret")
    assert secret is None or not secret.sources


@pytest.mark.parametrize("trust", ["nobody", "another authority"])
async def test_hub_with_an_unknown_certificate_is_refused_and_the_log_says_why(
    start_hub: StartHub,
    authority: Authority,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    trust: str,
) -> None:
    cert, key = authority.issue()
    if trust == "another authority":
        (tmp_path / "other").mkdir()
        monkeypatch.setenv("FIBWS_CA", str(Authority(tmp_path / "other").file))
    cloud = await start_hub(hub_name="cloud", cert=cert, key=key)
    robot = await start_hub(hub_name="robot", join=(cloud.url,))
    await logged(caplog, r"Not joined to wss://127.0.0.1:\d+.* \(.*certificate")
    assert cloud.federation.peers == robot.federation.peers == []


async def test_hub_with_a_known_certificate_is_joined(
    start_hub: StartHub, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    cert, key = authority.issue()
    monkeypatch.setenv("FIBWS_CA", str(authority.file))
    cloud = await start_hub(hub_name="cloud", cert=cert, key=key)
    robot = await start_hub(hub_name="robot", join=(cloud.url,))
    await until(lambda: cloud.federation.peers and robot.federation.peers, cloud, robot)


async def logged(caplog: pytest.LogCaptureFixture, pattern: str) -> None:
    """Wait until a line that matches is logged."""
    changed = asyncio.Event()
    handler = logging.Handler()
    handler.emit = lambda record: changed.set()  # type: ignore[method-assign]
    logger = logging.getLogger("fibws")
    logger.addHandler(handler)
    try:
        async with asyncio.timeout(PATIENCE):
            while not re.search(pattern, caplog.text):
                changed.clear()
                await changed.wait()
    finally:
        logger.removeHandler(handler)


async def test_broadcaster_and_listener_of_the_tutorial_meet_across_hubs(
    join: Join, start: Start
) -> None:
    first = await join("first")
    second = await join("second", first)
    listener = await start("fibws.listener", FIBWS_HUB=second.url)
    await start("fibws.broadcaster", "--rate", "20", FIBWS_HUB=first.url)
    while "I heard" not in (line := await listener.line()):
        assert line
