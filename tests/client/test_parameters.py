"""Parameters over the hub's services."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.client.hub_client import HubClient
from fibws.client.parameters import ROOT, HubParameters
from fibws.errors import ParameterError, ParameterNotSet, ServiceError


@pytest.fixture
def parameters(client: HubClient) -> HubParameters:
    return HubParameters(client.call)


@pytest.mark.parametrize("value", [1, 1.5, "\u00fc", True, [1, "a"], {}])
def test_value_is_set_and_read(parameters: HubParameters, value: Any) -> None:
    parameters.set("/x", value)
    assert parameters.get("/x") == value
    assert parameters.has("/x")


def test_dict_replaces_a_namespace(parameters: HubParameters) -> None:
    parameters.set("/robot", {"size": 3, "arm": {"length": 1}})
    assert parameters.get("/robot/arm/length") == 1
    assert {"/robot/arm/length", "/robot/size"} <= set(parameters.names())
    parameters.set("/robot", {"size": 4})
    assert parameters.get("/robot") == {"size": 4}


def test_nearest_parameter_is_found(parameters: HubParameters) -> None:
    parameters.set("/gain", 1)
    assert parameters.search("gain") == "/gain"
    assert parameters.search("missing") is None


def test_deleted_parameter_is_not_set(parameters: HubParameters) -> None:
    parameters.set("/x", 1)
    parameters.delete("/x")
    assert not parameters.has("/x")
    for method in (parameters.get, parameters.delete):
        with pytest.raises(ParameterNotSet, match="/x"):
            method("/x")


def test_deleting_the_root_deletes_all(parameters: HubParameters) -> None:
    parameters.set("/x", 1)
    parameters.delete(ROOT)
    assert parameters.names() == []


def test_numbers_may_be_infinite_or_nan(parameters: HubParameters) -> None:
    parameters.set("/x", [float("nan"), float("inf"), -float("inf")])
    assert parameters.get("/x") == [None, float("inf"), -float("inf")]
    parameters.set("/x", float("nan"))
    assert parameters.get("/x") is None


def test_value_that_json_does_not_have_is_an_error(parameters: HubParameters) -> None:
    with pytest.raises(TypeError):
        parameters.set("/x", b"bytes")


def test_invalid_json_of_another_server_is_an_error() -> None:
    def call(service: str, request: dict[str, Any]) -> dict[str, Any]:
        return {"value": "{"}

    with pytest.raises(ServiceError, match="get_param"):
        HubParameters(call).get("/x")


def test_refused_parameter_is_an_error(parameters: HubParameters) -> None:
    with pytest.raises(ParameterError, match="/x"):
        parameters.set("/x", "x" * 2**22)
