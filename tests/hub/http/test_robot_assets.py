"""The files of robots over HTTP: which ones a browser may read, and how they are sent."""

from __future__ import annotations

import gzip
import json
import os
import struct
from pathlib import Path
from typing import Any, TypeAlias

import pytest
from conftest import StartHub

from fibws.hub.errors import AssetRefused
from fibws.hub.graph.graph import Graph
from fibws.hub.http import robot_assets
from fibws.hub.http.robot_assets import CONTENT_TYPES, RobotAssets
from fibws.hub.server import HubServer
from fibws.interfaces import Interfaces

from ..raw_client import dialled, longest_turn
from ..token_clients import entry

Answer: TypeAlias = tuple[int, dict[str, str], bytes]
URDF = '<robot name="r"><mesh filename="package://arm/meshes/a.stl"/></robot>'
MESH = b"solid arm\n" * 300


def write(folder: Path, package: str, path: str = "meshes/a.stl", data: bytes = MESH) -> Path:
    """Write a file of a package, and its package.xml."""
    file = folder / package / path
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(data)
    (folder / package / "package.xml").write_text(f"<package><name>{package}</name></package>")
    return file


def allow(right: str, name: str) -> bool:
    return True


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder on ROS_PACKAGE_PATH with two packages; one of them is named in `URDF`."""
    folder = tmp_path / "ws"
    write(folder, "arm")
    write(folder, "secret")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(folder))
    return folder


@pytest.fixture
def graph() -> Graph:
    """A graph with the robot's description as a parameter."""
    graph = Graph(Interfaces(), lambda: 0)
    graph.parameters.set("/robot_description", URDF)
    return graph


@pytest.fixture
def assets(graph: Graph, workspace: Path) -> RobotAssets:
    return RobotAssets(graph, os.environ)


@pytest.fixture
async def robot(start_hub: StartHub, workspace: Path) -> HubServer:
    """A hub with the robot's description as a parameter."""
    hub = await start_hub()
    hub.graph.parameters.set("/robot_description", URDF)
    return hub


async def get(
    hub: HubServer, path: str, method: str = "GET", more: bytes = b"", **headers: str
) -> Answer:
    """Send a request; underscores in header names become hyphens."""
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    lines = [f"{name}: {value}" for name, value in ({"Host": "localhost"} | named).items()]
    request = "\r\n".join([f"{method} {path} HTTP/1.1", *lines, "", ""]).encode("latin-1")
    async with dialled(hub.port) as client:
        await client.send(request + more)
        return await client.response()


def reason(answer: Answer) -> str:
    status, headers, body = answer
    assert status != 200 and headers["content-type"].startswith("application/json")
    text: str = json.loads(body)["reason"]
    return text


async def test_mesh_of_the_loaded_robot_is_served(robot: HubServer) -> None:
    status, headers, body = await get(robot, "/assets/package/arm/meshes/a.stl")
    assert (status, body) == (200, MESH)
    assert headers["content-type"] == "model/stl"
    assert int(headers["content-length"]) == len(MESH)
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["cross-origin-resource-policy"] == "same-origin"


async def test_mesh_is_compressed_and_pictures_are_not(robot: HubServer, workspace: Path) -> None:
    write(workspace, "arm", "skin.PNG", MESH)
    status, headers, body = await get(
        robot, "/assets/package/arm/meshes/a.stl", Accept_Encoding="gzip"
    )
    assert (status, headers["content-encoding"]) == (200, "gzip")
    assert len(body) == int(headers["content-length"]) < len(MESH)
    assert gzip.decompress(body) == MESH
    status, headers, body = await get(robot, "/assets/package/arm/skin.PNG", Accept_Encoding="gzip")
    assert "content-encoding" not in headers
    assert (body, headers["content-type"]) == (MESH, "image/png")


async def test_file_that_a_browser_has_is_not_sent_again(robot: HubServer, workspace: Path) -> None:
    path = "/assets/package/arm/meshes/a.stl"
    _, headers, _ = await get(robot, path)
    assert (await get(robot, path, If_None_Match=headers["etag"]))[0] == 304
    write(workspace, "arm", data=b"solid other\n")
    status, _, body = await get(robot, path, If_None_Match=headers["etag"])
    assert (status, body) == (200, b"solid other\n")


async def test_head_has_no_body(robot: HubServer) -> None:
    status, headers, body = await get(robot, "/assets/package/arm/meshes/a.stl", method="HEAD")
    assert (status, body) == (200, b"") and int(headers["content-length"]) == len(MESH)


async def test_hub_below_a_path_serves_files_there(start_hub: StartHub, workspace: Path) -> None:
    hub = await start_hub(url_path="/robot")
    hub.graph.parameters.set("/robot_description", URDF)
    assert (await get(hub, "/robot/assets/package/arm/meshes/a.stl"))[0] == 200
    assert (await get(hub, "/assets/package/arm/meshes/a.stl"))[0] == 404


@pytest.mark.both_loops
async def test_large_file_arrives_whole_and_delays_nobody(
    robot: HubServer, workspace: Path
) -> None:
    data = os.urandom(24 * 2**20)  # More than sockets buffer.
    write(workspace, "arm", "big.stl", data)
    async with longest_turn() as longest:
        status, _, body = await get(robot, "/assets/package/arm/big.stl", Accept_Encoding="gzip")
    assert status == 200 and gzip.decompress(body) == data
    assert longest() < 0.25


async def test_bytes_behind_a_request_are_ignored(robot: HubServer) -> None:
    ping = b"\x89\x80\x00\x00\x00\x00" * 100
    second = b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"
    for more in (ping, second, b"\xff" * 1000):
        answer = await get(robot, "/assets/package/arm/meshes/a.stl", more=more)
        assert (answer[0], answer[2]) == (200, MESH)


async def test_files_on_their_way_are_bounded(start_hub: StartHub, workspace: Path) -> None:
    size = 24 * 2**20
    hub = await start_hub(max_memory=8 * size)
    hub.graph.parameters.set("/robot_description", URDF)
    write(workspace, "arm", "big.stl", os.urandom(size))
    path = "/assets/package/arm/big.stl"
    async with dialled(hub.port, receive_buffer=1 << 16) as slow:
        await slow.send(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        await slow._until(b"200 OK")
        refused = await get(hub, path)
        assert refused[0] == 503 and "busy" in reason(refused)
        slow.reset()
        while refused[0] == 503:
            refused = await get(hub, path)
    assert refused[0] == 200 and len(refused[2]) == size
    write(workspace, "arm", "larger.stl", bytes(size + 1))
    refused = await get(hub, "/assets/package/arm/larger.stl")
    assert refused[0] == 404 and "--max-memory" in reason(refused)


@pytest.mark.parametrize(
    "path",
    [
        "arm/../secret/meshes/a.stl",
        "arm/%2e%2e/secret/meshes/a.stl",
        "arm/..%2fsecret/meshes/a.stl",
        "arm/%252e%252e/secret/meshes/a.stl",
        "arm//meshes/a.stl",
        "arm/./meshes/a.stl",
        "arm/.hidden/a.stl",
        "arm/meshes/.a.stl",
        "arm/meshes\\a.stl",
        "arm/meshes/a.stl%00.png",
        "../arm/meshes/a.stl",
        "%2e/a.stl",
        "/etc/a.stl",
        "arm",
        "arm/",
        "",
    ],
)
def test_path_that_leads_elsewhere_is_refused(assets: RobotAssets, path: str) -> None:
    with pytest.raises(AssetRefused):
        assets.resolve(f"package://{path}", {"arm", "secret"})


async def test_traversal_is_refused_over_http(robot: HubServer) -> None:
    for path in ("arm/../secret/meshes/a.stl", "arm/%2e%2e/secret/meshes/a.stl"):
        assert (await get(robot, f"/assets/package/{path}"))[0] == 404


@pytest.mark.parametrize("name", ["notes.txt", "arm.urdf", "id_rsa", "a.stl.txt", "a.py"])
def test_other_kinds_of_files_are_refused(assets: RobotAssets, workspace: Path, name: str) -> None:
    write(workspace, "arm", name)
    with pytest.raises(AssetRefused) as error:
        assets.resolve(f"package://arm/{name}", {"arm"})
    assert ".stl" in str(error.value)


@pytest.mark.parametrize("suffix", CONTENT_TYPES)
def test_suffixes_may_be_in_upper_case(assets: RobotAssets, workspace: Path, suffix: str) -> None:
    file = write(workspace, "arm", f"a b{suffix.upper()}")
    for name in ("a b", "a%20b"):
        assert assets.resolve(f"package://arm/{name}{suffix.upper()}", {"arm"}) == file


async def test_package_that_no_description_names_is_refused(robot: HubServer) -> None:
    text = reason(await get(robot, "/assets/package/secret/meshes/a.stl"))
    assert "secret" in text and "arm" in text
    robot.graph.parameters.delete("/robot_description")
    text = reason(await get(robot, "/assets/package/arm/meshes/a.stl"))
    assert "robot_description" in text


async def test_missing_files_and_packages_are_named(robot: HubServer) -> None:
    assert "meshes/b.stl" in reason(await get(robot, "/assets/package/arm/meshes/b.stl"))
    other = URDF.replace("package://arm", "package://nowhere")
    robot.graph.parameters.set("/a/robot_description", other)
    text = reason(await get(robot, "/assets/package/nowhere/meshes/a.stl"))
    assert "nowhere" in text and "ROS_PACKAGE_PATH" in text


def test_folder_without_package_xml_is_no_package(assets: RobotAssets, workspace: Path) -> None:
    (workspace / "arm/package.xml").unlink()
    with pytest.raises(AssetRefused):
        assets.resolve("package://arm/meshes/a.stl", {"arm"})


def test_link_out_of_the_package_is_refused(
    assets: RobotAssets, workspace: Path, tmp_path: Path
) -> None:
    outside = tmp_path / "outside.stl"
    outside.write_bytes(MESH)
    arm = workspace / "arm"
    (arm / "out.stl").symlink_to(outside)
    (arm / "other.stl").symlink_to(workspace / "secret/meshes/a.stl")
    (arm / "up").symlink_to(tmp_path)
    (arm / "notes.txt").write_text("secret")
    (arm / "notes.stl").symlink_to(arm / "notes.txt")
    (arm / "again.stl").symlink_to(arm / "meshes/a.stl")
    for name in ("out.stl", "other.stl", "up/outside.stl", "notes.stl"):
        with pytest.raises(AssetRefused):
            assets.resolve(f"package://arm/{name}", {"arm"})
    assert assets.resolve("package://arm/again.stl", {"arm"}) == arm / "meshes/a.stl"


def test_installed_link_to_the_same_package_is_followed(graph: Graph, tmp_path: Path) -> None:
    source = write(tmp_path / "src", "arm")
    installed = write(tmp_path / "install/share", "arm", "meshes/b.stl").with_name("a.stl")
    installed.symlink_to(source)
    assets = RobotAssets(graph, {"AMENT_PREFIX_PATH": str(tmp_path / "install")})
    assert assets.resolve("package://arm/meshes/a.stl", {"arm"}) == source


def test_file_above_the_limit_is_refused(assets: RobotAssets, workspace: Path) -> None:
    file = write(workspace, "arm", "huge.stl")
    with file.open("r+b") as opened:
        opened.truncate(robot_assets.LARGEST + 1)
    with pytest.raises(AssetRefused) as error:
        assets.resolve("package://arm/huge.stl", {"arm"})
    assert str(robot_assets.LARGEST) in str(error.value)


def test_fifo_is_refused_without_being_opened(assets: RobotAssets, workspace: Path) -> None:
    os.mkfifo(workspace / "arm/pipe.stl")
    with pytest.raises(AssetRefused):
        assets.resolve("package://arm/pipe.stl", {"arm"})


@pytest.mark.parametrize("uri", ["file:///etc/a.stl", "http://x/a.stl", "meshes/a.stl", ""])
def test_only_package_uris_are_resolved(assets: RobotAssets, uri: str) -> None:
    with pytest.raises(AssetRefused) as error:
        assets.resolve(uri, {"arm"})
    assert "package://" in str(error.value)


def test_refusal_names_few_packages(assets: RobotAssets) -> None:
    named = {f"package{number}" for number in range(100_000)}
    with pytest.raises(AssetRefused) as error:
        assets.resolve("package://arm/a.stl", named)
    assert "package0, package1, " in str(error.value)
    assert len(str(error.value)) < 500


def test_packages_come_from_parameters_and_latched_topics(
    graph: Graph, assets: RobotAssets
) -> None:
    topic = graph.topic("/robot1/robot_description")
    source = graph.advertise(topic, "/publisher", "std_msgs/String", latch=True)
    source.publish({"data": URDF.replace("package://arm", "package://legs-1")})
    other = graph.advertise(graph.topic("/x/robot_description"), "/other", "std_msgs/Int32")
    other.publish({"data": 8})
    size = struct.pack("<I", 18)
    third = graph.advertise(
        graph.topic("/y/robot_description"), "/y", "std_msgs/String", latch=True
    )
    third.publish_serialized(bytearray(size + b"package://head/a/b"))
    assert assets.named(allow) == {"arm", "legs-1", "head"}
    graph.parameters.set("/robot_description", "package://wheels/x")
    assert assets.named(allow) == {"wheels", "legs-1", "head"}
    graph.remove_source(source)
    graph.remove_source(third)
    assert assets.named(allow) == {"wheels"}


async def test_hub_with_tokens_serves_those_who_may_read_the_description(
    start_hub: StartHub, workspace: Path, tmp_path: Path
) -> None:
    tokens = tmp_path / "tokens.toml"
    tokens.write_text(
        entry("ann", 'allow = {param_read = ["/robot_description"]}')
        + entry("bob", 'allow = {param_read = ["/other"], subscribe = ["/**"]}'),
        "utf-8",
    )
    hub = await start_hub(tokens=tokens)
    hub.graph.parameters.set("/robot_description", URDF)
    path = "/assets/package/arm/meshes/a.stl"
    assert (await get(hub, path, Authorization="Bearer ann"))[0] == 200
    origin = f"http://127.0.0.1:{hub.port}"
    assert (await get(hub, path, Origin=origin, Authorization="Bearer ann"))[0] == 200
    assert (await get(hub, f"{path}?token=ann", Origin=origin))[0] == 401
    refused = await get(hub, path, Authorization="Bearer bob")
    assert refused[0] == 404 and "arm" in reason(refused)
    for query in ("", "?token=wrong"):
        refused = await get(hub, path + query)
        assert refused[0] == 401 and "token" in reason(refused)


async def test_pages_that_may_connect_may_send_their_token(
    start_hub: StartHub, workspace: Path
) -> None:
    """The browser asks first, without the token."""
    hub = await start_hub(allow_origin=("https://lab.example",))
    path = "/assets/package/arm/meshes/a.stl"
    status, headers, body = await get(hub, path, "OPTIONS", Origin="https://lab.example")
    assert (status, body) == (204, b"")
    assert headers["access-control-allow-origin"] == "https://lab.example"
    assert headers["access-control-allow-headers"] == "Authorization"
    status, headers, body = await get(hub, path, "OPTIONS", Origin="https://evil.example")
    assert status == 403 and "access-control-allow-origin" not in headers
    assert (await get(hub, "/metrics", "OPTIONS", Origin="https://lab.example"))[0] == 405


async def test_pages_of_other_origins_read_files_only_if_allowed(
    start_hub: StartHub, workspace: Path
) -> None:
    hub = await start_hub(allow_origin=("https://lab.example",))
    hub.graph.parameters.set("/robot_description", URDF)
    path = "/assets/package/arm/meshes/a.stl"
    status, headers, _ = await get(hub, path, Origin="https://lab.example")
    assert (status, headers["access-control-allow-origin"]) == (200, "https://lab.example")
    assert headers["cross-origin-resource-policy"] == "cross-origin"
    status, headers, _ = await get(hub, path, Origin="https://evil.example")
    assert status == 403 and "access-control-allow-origin" not in headers
    assert (await get(hub, path, Host="evil.example"))[0] == 403


async def test_fault_of_the_hub_is_reported(
    robot: HubServer, faults: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*arguments: object) -> None:
        raise RuntimeError("broken")

    monkeypatch.setattr(RobotAssets, "resolve", fail)
    assert (await get(robot, "/assets/package/arm/meshes/a.stl"))[0] == 500
    faults.expect("broken")
