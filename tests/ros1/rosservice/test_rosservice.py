"""rosservice's functions for scripts."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import pytest
import rosservice
from running_programs import Program

import fibws
from fibws.hub.server import HubServer
from fibws.srv.std_srvs import SetBool, SetBoolRequest, SetBoolResponse


def answer(request: SetBoolRequest) -> SetBoolResponse:
    if not request.data:
        raise ValueError("only on")
    return SetBoolResponse(success=True, message="on")


@pytest.fixture(autouse=True)
async def node(hub: HubServer, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[fibws.Node]:
    monkeypatch.setenv("FIBWS_HUB", hub.url)
    async with fibws.Node("light", namespace="/robot", hub=hub.url) as node:
        await node.service("~switch", SetBool, answer)
        yield node


async def ask(function: Callable[..., Any], *arguments: Any, **named: Any) -> Any:
    return await asyncio.to_thread(function, *arguments, **named)


async def test_service_is_found_by_name() -> None:
    assert await ask(rosservice.get_service_type, "/robot/light/switch") == "std_srvs/SetBool"
    assert await ask(rosservice.get_service_node, "robot/light/switch") == "/robot/light"
    uri = await ask(rosservice.get_service_uri, "/robot/light/switch")
    assert uri.startswith("rosrpc://127.0.0.1:")
    service_class = await ask(rosservice.get_service_class_by_name, "/robot/light/switch")
    assert service_class._type == "std_srvs/SetBool"
    assert await ask(rosservice.get_service_args, "/robot/light/switch") == "data"
    assert await ask(rosservice.has_service_args, "/robot/light/switch")


async def test_headers_of_a_service_have_its_type() -> None:
    headers = await ask(rosservice.get_service_headers, "/robot/light/switch", "")
    assert headers == {
        "callerid": "/robot/light",
        "md5sum": "09fb03525b03e7ea1fd3992bafd87e16",
        "service": "/robot/light/switch",
        "type": "std_srvs/SetBool",
    }
    with pytest.raises(rosservice.ROSServiceException, match="/nothing"):
        await ask(rosservice.get_service_headers, "/nothing", "")


async def test_unknown_service_gives_none() -> None:
    for function in (
        rosservice.get_service_type,
        rosservice.get_service_node,
        rosservice.get_service_uri,
    ):
        assert await ask(function, "/nothing") is None
    with pytest.raises(rosservice.ROSServiceException, match=r"\[/nothing\] is not available"):
        await ask(rosservice.get_service_class_by_name, "/nothing")


async def test_services_are_listed() -> None:
    assert "/robot/light/switch" in await ask(rosservice.get_service_list)
    assert "/robot/light/switch" in await ask(rosservice.get_service_list, node="/robot/light")
    assert await ask(rosservice.get_service_list, namespace="/rob") == []
    pair = ["/robot/light/switch", ["/robot/light"]]
    assert pair in await ask(rosservice.get_service_list, namespace="/robot", include_nodes=True)
    assert await ask(rosservice.rosservice_find, "std_srvs/SetBool") == ["/robot/light/switch"]


async def test_undefined_type_is_an_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("genpy.message.get_service_class", lambda type_: None)
    with pytest.raises(rosservice.ROSServiceException, match=r"Have you typed .* in \[std_srvs\]"):
        await ask(rosservice.get_service_class_by_name, "/robot/light/switch")


CALLS = """
import rosservice

def attempt(*arguments):
    try:
        request, response = rosservice.call_service("/robot/light/switch", *arguments)
        print(request.data, response.message)
    except rosservice.ROSServiceException as error:
        print(error)

attempt([True])
attempt([{"data": True}])
attempt([False])
attempt([1, 2])
attempt(["yes"])
"""


async def test_service_is_called_with_values(hub: HubServer, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(CALLS)
    program = await Program.start("fibws.rospy", str(script), FIBWS_HUB=hub.url)
    code, out, err = await program.end()
    lines = out.splitlines()
    assert (code, err) == (0, "")
    assert lines[:2] == ["True on", "True on"]
    assert "only on" in lines[2]
    assert lines[3] == "Incompatible arguments to call service:"
    end = lines.index("Service arguments are: [data]")
    assert lines[end - 3 : end] == [" * 1 (type int)", " * 2 (type int)", ""]
    assert lines[end + 1].endswith("One of the fields has an incorrect type:")
    assert "data" in lines[end + 2]
    assert "bool data" in lines


async def test_missing_hub_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "ws://127.0.0.1:1")
    with pytest.raises(rosservice.ROSServiceIOException, match=r"master! .*127\.0\.0\.1:1"):
        await ask(rosservice.get_service_list)
