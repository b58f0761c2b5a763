"""Parameters, on a real hub."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import suppress
from typing import Any

import pytest
from conftest import StartHub

import fibws


@pytest.fixture
async def node(start_hub: StartHub) -> AsyncIterator[fibws.Node]:
    remapping = fibws.parse_remappings(["speed:=/limits/speed"])
    hub = await start_hub()
    async with fibws.Node("arm", hub=hub.url, namespace="robot", remapping=remapping) as node:
        yield node


@pytest.mark.parametrize("value", [1, 2.5, True, "text", "", [1, "a", []], {"x": {"y": 1}}, 2**53])
async def test_value_is_read_as_it_was_set(node: fibws.Node, value: Any) -> None:
    assert not await node.params.has("gain")
    await node.params.set("gain", value)
    assert await node.params.has("gain")
    got = await node.params.get("gain")
    assert (got, type(got)) == (value, type(value))


async def test_names_are_resolved_and_remapped(node: fibws.Node) -> None:
    params = node.params
    assert params is node.params
    for name in ("gain", "~gain", "/gain", "speed"):
        await params.set(name, name)
    assert await params.get("/robot/gain") == "gain"
    assert await params.get("/robot/arm/gain") == "~gain"
    assert await params.get("/gain") == "/gain"
    assert await params.get("/limits/speed") == "speed"
    names = await params.names()
    assert {"/robot/gain", "/robot/arm/gain", "/gain", "/limits/speed"} <= set(names)
    assert "/run_id" in names


async def test_dict_is_a_namespace(node: fibws.Node) -> None:
    await node.params.set("pid", {"p": 1, "i": 2})
    assert await node.params.get("pid/p") == 1
    await node.params.set("pid/d", 3)
    assert await node.params.get("pid") == {"p": 1, "i": 2, "d": 3}
    assert (await node.params.get("/"))["robot"] == {"pid": {"p": 1, "i": 2, "d": 3}}
    await node.params.set("pid", {"p": 5})
    assert await node.params.get("pid") == {"p": 5}


async def test_missing_parameter_has_a_default_or_raises(node: fibws.Node) -> None:
    assert await node.params.get("gain", 7) == 7
    assert await node.params.get("gain", None) is None
    with pytest.raises(fibws.ParameterNotSet, match=r"^Parameter \[/robot/gain\] is not set$"):
        await node.params.get("gain")
    with pytest.raises(KeyError):
        await node.params.get("gain")


async def test_deleted_parameter_is_missing(node: fibws.Node) -> None:
    await node.params.set("gain", 1)
    for _ in range(2):
        await node.params.delete("gain")
    assert not await node.params.has("gain")


async def test_nearest_parameter_is_found(node: fibws.Node) -> None:
    assert await node.params.search("gain") is None
    for name in ("/gain", "/robot/gain", "/robot/arm/gain"):
        await node.params.set(name, 1)
        assert await node.params.search("gain") == name


@pytest.mark.parametrize("name", ["~gain", "", "1st"])
async def test_search_requires_a_valid_name(node: fibws.Node, name: str) -> None:
    with pytest.raises(fibws.InvalidName):
        await node.params.search(name)


async def test_none_is_refused(node: fibws.Node) -> None:
    with pytest.raises(ValueError, match="parameter gain: None is not a value"):
        await node.params.set("gain", None)


USES: dict[str, Callable[[fibws.Node], Awaitable[object]]] = {
    "get": lambda node: node.params.get("gain", timeout=0.01),
    "set": lambda node: node.params.set("gain", 1, timeout=0.01),
    "has": lambda node: node.params.has("gain", timeout=0.01),
    "delete": lambda node: node.params.delete("gain", timeout=0.01),
    "search": lambda node: node.params.search("gain", timeout=0.01),
    "names": lambda node: node.params.names(timeout=0.01),
    "graph": lambda node: node.graph.nodes(timeout=0.01),
}


@pytest.mark.parametrize("use", USES)
async def test_without_a_hub_a_timeout_ends_the_wait(start_hub: StartHub, use: str) -> None:
    hub = await start_hub()
    async with fibws.Node("arm", hub=hub.url) as node:
        await hub.close()
        with pytest.raises(fibws.ServiceTimeout) as caught:
            while True:  # The node may not have noticed yet that the hub has gone.
                with suppress(fibws.ServiceLost):
                    await USES[use](node)
        assert isinstance(caught.value, TimeoutError)
    with pytest.raises(ValueError, match="timeout must be"):
        await node.params.get("gain", timeout=0)


@pytest.mark.parametrize("value", [b"bytes", {1, 2}, object()])
async def test_value_that_json_cannot_express_raises(node: fibws.Node, value: object) -> None:
    with pytest.raises(TypeError, match=r"gain: .*not JSON serializable; values are numbers"):
        await node.params.set("gain", value)


async def test_nan_and_infinity_raise(node: fibws.Node) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        await node.params.set("gain", math.nan)


async def test_refusal_by_the_hub_raises_its_text(node: fibws.Node) -> None:
    with pytest.raises(fibws.ServiceError, match="null cannot be set"):
        await node.params.set("gain", {"p": None})
    with pytest.raises(fibws.InvalidName):
        await node.params.get("no name")


async def test_private_parameters_of_the_command_line_are_set(start_hub: StartHub) -> None:
    hub = await start_hub()
    remapping = fibws.parse_remappings(["_gain:=1.5", "_pid/p:=[1, 2]", "_name:=left"])
    async with fibws.Node("arm", hub=hub.url, remapping=remapping) as node:
        assert await node.params.get("/arm") == {"gain": 1.5, "pid": {"p": [1, 2]}, "name": "left"}


@pytest.mark.parametrize("text", ["_gain:=", "_gain:=[", "_gain:=.nan", "_gain:=2026-01-01"])
async def test_invalid_parameter_of_the_command_line_is_an_error(
    start_hub: StartHub, text: str
) -> None:
    hub = await start_hub()
    node = fibws.Node("arm", hub=hub.url, remapping=fibws.parse_remappings([text]))
    with pytest.raises(fibws.FibwsError, match="_gain:="):
        async with node:
            pass
    assert not hub.graph.parameters.has("/arm")
