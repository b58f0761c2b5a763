"""A link is a principal: its token limits what the other hub gets and does."""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack
from pathlib import Path
from tempfile import mkdtemp

import pytest
from certificates import Authority
from certificates import authority as authority
from conftest import StartHub
from hub_reload import reloaded
from patience import PATIENCE

import fibws
from fibws import tls
from fibws.access.rights import Right, Rights
from fibws.access.token_file import TokenFile
from fibws.hub.federation.connections import Join as Joining
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import String
from fibws.srv.std_srvs import Trigger

from ..fakes import FIBONACCI
from ..token_clients import Client, entering, entry
from ..zenoh_endpoints import listens_at, zenoh_config
from .conftest import Join, until
from .test_federation import remote_nodes


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "tokens.toml"


async def start_cloud(start_hub: StartHub, path: Path) -> tuple[HubServer, str]:
    """Return a hub with a token for its operator, and one for a robot's hub."""
    admin = TokenFile(path).add("operator", Rights(admin=True))
    globs = ["/robot7/**"]
    rights: tuple[Right, ...] = ("publish", "subscribe", "call", "provide", "node")
    robot = TokenFile(path).add("robot7", Rights({right: globs for right in rights}))
    cloud = await start_hub(hub_name="cloud", tokens=path)
    return cloud, f"{robot} {admin}"


async def test_robot_with_a_token_joins_below_its_prefix(start_hub: StartHub, path: Path) -> None:
    cloud, words = await start_cloud(start_hub, path)
    robot_token, admin = words.split()
    url = f"{cloud.url}/?token={robot_token}"
    robot = await start_hub(hub_name="robot", join=(url,), join_prefix="/robot7")
    async with (
        fibws.Node("talker", hub=robot.url) as talker,
        fibws.Node("viewer", hub=cloud.url, token=admin) as viewer,
    ):
        publisher = await talker.advertise("scan", String, latch=True)
        await publisher.publish(data="hello")
        message = await viewer.wait_for_message("/robot7/scan", String, timeout=PATIENCE)
        assert message.data == "hello"
        assert remote_nodes(cloud) == {"/robot7/talker": "robot"}


async def fault_of(robot: HubServer, url: str) -> str:
    """Return why a hub cannot join another one."""
    faults: asyncio.Queue[str] = asyncio.Queue()
    join = Joining(url, robot.federation, robot.settings)
    join.on_fault = faults.put_nowait
    join.start()
    try:
        return await asyncio.wait_for(faults.get(), PATIENCE)
    finally:
        await join.close()


async def test_prefix_that_a_token_does_not_allow_is_refused(
    start_hub: StartHub, path: Path
) -> None:
    cloud, words = await start_cloud(start_hub, path)
    robot = await start_hub(hub_name="robot", join_prefix="/robot8")
    fault = await fault_of(robot, f"{cloud.url}/?token={words.split()[0]}")
    assert "/robot8/hub" in fault
    assert not cloud.federation.peers


@pytest.mark.parametrize("query", ["", "/?token=wrong"])
async def test_missing_or_wrong_token_is_refused_with_the_reason(
    start_hub: StartHub, path: Path, query: str
) -> None:
    cloud, _ = await start_cloud(start_hub, path)
    robot = await start_hub()
    assert "token" in await fault_of(robot, f"{cloud.url}{query}")
    assert not cloud.federation.peers


async def test_refused_hub_joins_once_the_other_one_knows_its_token(
    start_hub: StartHub, path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    TokenFile(path).add("operator", Rights(admin=True))
    cloud = await start_hub(hub_name="cloud", tokens=path)
    later = tmp_path / "later.toml"
    token = TokenFile(later).add("robot", Rights(admin=True))
    waited: list[float] = []
    is_waiting, is_over = asyncio.Event(), asyncio.Event()

    async def sleep(seconds: float) -> None:
        waited.append(seconds)
        is_waiting.set()
        await is_over.wait()

    monkeypatch.setattr("fibws.hub.federation.connections.sleep", sleep)
    robot = await start_hub(join=(f"{cloud.url}/?token={token}",))
    async with asyncio.timeout(PATIENCE):
        await is_waiting.wait()
        later.replace(path)
        await reloaded(cloud)
        is_over.set()
        await until(lambda: cloud.federation.peers and robot.federation.peers, cloud, robot)
    (seconds,) = waited
    assert 20 <= seconds <= 30


async def test_untrusted_certificate_is_refused_with_the_reason(
    start_hub: StartHub, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    certificate, key = authority.issue()
    cloud = await start_hub(hub_name="cloud", cert=certificate, key=key)
    robot = await start_hub()
    assert "certificate" in await fault_of(robot, cloud.url)
    assert not cloud.federation.peers
    monkeypatch.setenv("FIBWS_CA", str(authority.file))
    robot = await start_hub(join=(cloud.url,))
    await until(lambda: cloud.federation.peers, cloud)


async def test_refused_certificate_of_this_hub_is_explained(
    start_hub: StartHub, authority: Authority, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    certificate, key = authority.issue()
    cloud = await start_hub(hub_name="cloud", cert=certificate, key=key, client_ca=authority.file)
    (tmp_path / "other").mkdir()
    own = Authority(tmp_path / "other").issue(common_name="robot")
    for name, file in zip(tls.VARIABLES, (authority.file, *own), strict=True):
        monkeypatch.setenv(name, str(file))
    robot = await start_hub()
    assert "refuses this client's certificate" in await fault_of(robot, cloud.url)


async def test_zenoh_accepts_only_hubs_that_trust_its_certificate(
    start_hub: StartHub, tmp_path: Path
) -> None:
    pytest.importorskip("zenoh")
    for name in ("right", "wrong"):
        (tmp_path / name).mkdir()
    right, wrong = Authority(tmp_path / "right"), Authority(tmp_path / "wrong")
    certificate, key = right.issue()

    def config(**tls: Path) -> Path:
        return zenoh_config(
            Path(mkdtemp(dir=tmp_path)), link={"tls": {key: str(tls[key]) for key in tls}}
        )

    hub = await start_hub(
        zenoh_listen=("tls/127.0.0.1:0",),
        zenoh_config=config(listen_certificate=certificate, listen_private_key=key),
    )
    assert hub._zenoh is not None
    endpoint = await listens_at(hub._zenoh._session)
    stranger, friend = [
        await start_hub(zenoh=(endpoint,), zenoh_config=config(root_ca_certificate=each.file))
        for each in (wrong, right)
    ]
    await until(lambda: friend.federation.peers, friend)
    assert not stranger.federation.peers


async def test_section_join_limits_the_hub_that_is_joined(start_hub: StartHub, path: Path) -> None:
    cloud = await start_hub(hub_name="cloud")
    admin = TokenFile(path).add("operator", Rights(admin=True))
    with path.open("a") as file:
        file.write('[join]\nallow = {publish = ["/cmd_vel"], node = ["/**"]}\n')
    robot = await start_hub(hub_name="robot", join=(cloud.url,), tokens=path)
    async with (
        fibws.Node("viewer", hub=cloud.url) as viewer,
        fibws.Node("driver", hub=robot.url, token=admin) as driver,
    ):
        await viewer.advertise("/cmd_vel", String)
        await viewer.advertise("/other", String)
        await driver.advertise("/scan", String)
        await until(lambda: "/viewer" in robot.graph.nodes, robot)
        await until(lambda: "/cmd_vel" in robot.graph.topics, robot)
        assert "/viewer" not in getattr(robot.graph.topics.get("/other"), "sources", {})
        assert "/scan" not in cloud.graph.topics


async def test_section_join_counts_as_soon_as_it_is_reloaded(
    start_hub: StartHub, path: Path
) -> None:
    cloud = await start_hub(hub_name="cloud")
    section = '[join]\nallow = {{publish = ["{}"], node = ["/**"]}}\n'
    write = path.write_text
    write(section.format("/**"))
    robot = await start_hub(hub_name="robot", join=(cloud.url,), tokens=path)

    def has(topic: str) -> bool:
        return "/viewer" in getattr(robot.graph.topics.get(topic), "sources", ())

    async with fibws.Node("viewer", hub=cloud.url) as viewer:
        await viewer.advertise("/cmd_vel", String)
        await until(lambda: has("/cmd_vel"), robot)
        await reloaded(robot)
        assert has("/cmd_vel"), "nothing has changed"
        write(section.format("/other"))
        await reloaded(robot)
        await until(lambda: not has("/cmd_vel"), robot)
        await viewer.advertise("/other", String)
        await until(lambda: has("/other"), robot)
        assert not has("/cmd_vel")


@pytest.mark.parametrize("join", ["zenoh"], indirect=True)
async def test_section_zenoh_counts_as_soon_as_it_is_reloaded(join: Join, path: Path) -> None:
    cloud = await join("cloud")
    admin = TokenFile(path).add("operator", Rights(admin=True))
    read, write_text = path.read_text, path.write_text
    tokens = read()
    section = '[zenoh]\nallow = {{publish = ["{}"], subscribe = ["/scan"], node = ["/**"]}}\n'

    def write(text: str) -> None:
        write_text(tokens + text)

    write(section.format("/**"))
    robot = await join("robot", cloud, tokens=path)

    def has(topic: str) -> bool:
        return "/viewer" in getattr(robot.graph.topics.get(topic), "sources", ())

    async with (
        fibws.Node("viewer", hub=cloud.url) as viewer,
        fibws.Node("driver", hub=robot.url, token=admin) as driver,
    ):
        await viewer.advertise("/cmd_vel", String)
        await until(lambda: has("/cmd_vel"), robot)
        scan = await driver.advertise("/scan", String, latch=True)
        await scan.publish(data="before")
        scans = aiter(viewer.subscribe("/scan", String))
        assert (await anext(scans)).data == "before"
        await reloaded(robot)
        assert has("/cmd_vel"), "nothing has changed"
        write(section.format("/other"))
        await reloaded(robot)
        await until(lambda: not has("/cmd_vel"), robot)
        await viewer.advertise("/other", String)
        await until(lambda: has("/other"), robot)
        assert not has("/cmd_vel")
        # Messages pass again.
        await scan.publish(data="after")
        async with asyncio.timeout(PATIENCE):
            while (await anext(scans)).data != "after":
                pass
        write('[zenoh]\nallow = {subscribe = ["/scan"], node = ["/nobody"]}\n')
        await reloaded(robot)
        await until(
            lambda: not robot.federation.peers and "/driver" not in cloud.graph.nodes, robot, cloud
        )
        write(section.format("/other"))
        await reloaded(robot)
        await until(lambda: has("/other") and "/driver" in cloud.graph.nodes, robot, cloud)


async def test_nodes_are_announced_once_they_have_something_that_may_be_seen(
    start_hub: StartHub, path: Path
) -> None:
    """A node enters the graph before it has topics and services, and is hidden until then."""
    cloud = await start_hub(hub_name="cloud")
    admin = TokenFile(path).add("operator", Rights(admin=True))
    with path.open("a") as file:
        file.write('[join]\nallow = {publish = ["/cmd_vel"], call = ["/dock"], node = ["/**"]}\n')
    robot = await start_hub(hub_name="robot", join=(cloud.url,), tokens=path)
    await until(lambda: robot.federation.peers, robot)
    async with (
        fibws.Node("viewer", hub=cloud.url) as viewer,
        fibws.Node("driver", hub=robot.url, token=admin) as driver,
        fibws.Node("docker", hub=robot.url, token=admin) as docker,
    ):
        publisher = await viewer.advertise("/cmd_vel", String, latch=True)
        commands = driver.subscribe("/cmd_vel", String)
        topic = cloud.graph.topic("/cmd_vel")
        await until(lambda: "/driver" in topic.subscribers(), cloud)
        await publisher.publish(data="go")
        assert (await anext(commands)).data == "go"
        assert "/docker" not in cloud.graph.nodes
        await docker.service("/dock", Trigger, lambda request: (True, "docked"))
        await until(lambda: "/dock" in cloud.graph.services, cloud)
        assert (await viewer.call("/dock", Trigger)).success


@pytest.mark.parametrize("side", ["token", "join"])
async def test_calls_and_goals_under_way_end_with_the_rights_of_their_hub(
    start_hub: StartHub, tmp_path: Path, side: str
) -> None:
    admin = entry("boss", "admin = true")
    cloud_tokens, robot_tokens = tmp_path / "cloud.toml", tmp_path / "robot.toml"

    def write(rights: str) -> None:
        allow = f'allow = {{provide = ["/**"], {rights}node = ["/**"]}}\n'
        cloud_tokens.write_text(admin + entry("link", allow))
        robot_tokens.write_text(f"{admin}[join]\n{allow}")

    write('call = ["/**"], ')
    cloud = await start_hub(hub_name="cloud", tokens=cloud_tokens)
    robot = await start_hub(
        hub_name="robot", tokens=robot_tokens, join=(f"{cloud.url}/?token=link",)
    )
    serving, calling = (cloud, robot) if side == "token" else (robot, cloud)
    async with AsyncExitStack() as stack:
        server, client = [
            Client(
                await stack.enter_async_context(entering(hub, "boss", name, serialized=True)),
                name,
                "boss",
            )
            for hub, name in ((serving, "/server"), (calling, "/client"))
        ]
        await server.does("advertise_service", service="/slow", type="std_srvs/Trigger")
        await server.does("advertise_action", action="/dock", type=FIBONACCI)
        known = calling.graph
        await until(lambda: "/slow" in known.services and "/dock" in known.actions, calling)
        await client.send("call_service", service="/slow", id="1")
        call = await server.receive("call_service")
        goal = {"action": "/dock", "action_type": FIBONACCI, "args": {"order": 1}}
        await client.send("send_action_goal", id="2", **goal)
        id_ = (await server.receive("send_action_goal"))["id"]
        write("")
        await reloaded(serving)
        assert (await server.receive("cancel_action_goal"))["id"] == id_
        response = await client.receive("service_response")
        assert (response["id"], response["result"]) == ("1", False)
        result = await client.receive("action_result")
        assert (result["id"], result["result"]) == ("2", False)
        late = {"id": call["id"], "values": {"success": True}, "result": True}
        await server.does("service_response", service="/slow", **late)
        assert serving.graph.actions["/dock"].goals == {}
