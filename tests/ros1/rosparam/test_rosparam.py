"""Parameters by files."""

from __future__ import annotations

import asyncio
import io
import math
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import pytest
import rosgraph
import rosparam

import fibws
from fibws.hub.server import HubServer


@pytest.fixture(autouse=True)
async def node(hub: HubServer, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[fibws.Node]:
    monkeypatch.setenv("FIBWS_HUB", hub.url)
    async with fibws.Node("node", hub=hub.url) as node:
        yield node


async def ask(function: Callable[..., Any], *arguments: Any, **named: Any) -> Any:
    return await asyncio.to_thread(function, *arguments, **named)


def test_file_is_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text("size: 3\nangle: deg(180)\nturn: rad(2*pi)\n---\n_ns: arm\njoints: [1, a]\n")
    assert rosparam.load_file(str(path), "/robot", verbose=True) == [
        ({"size": 3, "angle": math.pi, "turn": 2 * math.pi}, "/robot"),
        ({"joints": [1, "a"]}, "/robot/arm"),
    ]
    assert capsys.readouterr().out == (
        f"reading parameters from [{path}]\nreading parameters into namespace [/robot/arm]\n"
    )


def test_names_are_relative_to_the_programs_namespace(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "/robot")
    assert rosparam.load_str("size: 3", "text") == [({"size": 3}, "/robot/")]


def test_standard_input_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("size: 3"))
    assert rosparam.load_file("-", "/", verbose=True) == [({"size": 3}, "/")]


@pytest.mark.parametrize(
    ("text", "fault"), [("a: [1", "YAML"), ("a: rad(x)", "YAML"), ("\x07", "YAML")]
)
def test_invalid_yaml_is_an_error(tmp_path: Path, text: str, fault: str) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(text)
    with pytest.raises(rosparam.RosParamException, match=f"robot.yaml.*{fault}"):
        rosparam.load_file(str(path))


def test_unreadable_file_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(rosparam.RosParamException, match="does not exist"):
        rosparam.load_file(str(tmp_path / "nothing.yaml"))
    with pytest.raises(rosparam.RosParamException, match="cannot be read"):
        rosparam.load_file(str(tmp_path))


async def test_parameters_are_set(node: fibws.Node, capsys: pytest.CaptureFixture[str]) -> None:
    await ask(rosparam.upload_params, "/robot", {"size": 3, "arm": {"joints": [1, "a"]}})
    await ask(rosparam.upload_params, "/robot", {"arm": {"name": "left"}}, verbose=True)
    assert await node.params.get("/robot") == {
        "size": 3,
        "arm": {"joints": [1, "a"], "name": "left"},
    }
    await ask(rosparam.set_param, "/robot/size", "{x: deg(180), y: [1, 2.5]}", verbose=True)
    assert await ask(rosparam.get_param, "/robot/size") == {"x": math.pi, "y": [1, 2.5]}
    await ask(rosparam.set_param_raw, "/word", "on")
    assert await node.params.get("/word") == "on"
    assert capsys.readouterr().out == (
        "/robot/arm/name=left\n"
        f"set parameter [/robot/size/x] to [{math.pi}]\n"
        "set parameter [/robot/size/y] to [[1, 2.5]]\n"
    )


async def test_parameters_are_listed_and_deleted(capsys: pytest.CaptureFixture[str]) -> None:
    await ask(rosparam.upload_params, "/robot", {"b": 1, "a": 2})
    assert await ask(rosparam.list_params, "/robot") == ["/robot/a", "/robot/b"]
    await ask(rosparam.delete_param, "/robot/a", verbose=True)
    assert await ask(rosparam.list_params, "/robot") == ["/robot/b"]
    with pytest.raises(rosgraph.MasterError, match="not set"):
        await ask(rosparam.delete_param, "/robot/a")
    with pytest.raises(rosgraph.MasterError, match="not set"):
        await ask(rosparam.get_param, "/robot/a")
    await ask(rosparam.delete_param, "/", verbose=True)
    assert await ask(rosparam.list_params, "/robot") == []
    assert capsys.readouterr().out == (
        "deleted parameter [/robot/a]\ndeleted ENTIRE parameter server\n"
    )


async def test_parameters_are_dumped(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    await ask(rosparam.upload_params, "/robot", {"size": 3})
    path = tmp_path / "robot.yaml"
    await ask(rosparam.dump_params, str(path), "/robot", verbose=True)
    assert path.read_text() == "size: 3\n"
    await ask(rosparam.dump_params, None, "/robot")
    assert capsys.readouterr().out == "/robot/size=3\nsize: 3\n"


@pytest.mark.parametrize(
    ("name", "value", "fault"),
    [
        ("/", 3, "global / can only be set to a dictionary"),
        ("/robot", {3: 4}, "3"),
        ("/robot", {"a": None}, "null"),
        ("/robot", b"bytes", "bytes"),
    ],
)
async def test_invalid_value_is_refused(name: str, value: object, fault: str) -> None:
    with pytest.raises(rosparam.RosParamException, match=fault):
        await ask(rosparam.upload_params, name, value)
    with pytest.raises(rosparam.RosParamException, match="YAML"):
        await ask(rosparam.set_param, "/robot", "[")


async def test_missing_hub_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "ws://127.0.0.1:1")
    for function in (rosparam.list_params, rosparam.get_param, rosparam.delete_param):
        with pytest.raises(rosparam.RosParamIOException, match=r"master! .*127\.0\.0\.1:1"):
            await ask(function, "/robot")
    with pytest.raises(rosparam.RosParamIOException, match=r"master! .*127\.0\.0\.1:1"):
        await ask(rosparam.upload_params, "/robot", {"a": 1})
