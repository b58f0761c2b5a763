"""rosapi's services for parameters."""

from __future__ import annotations

import pytest

from fibws.hub.graph.parameters import Parameters
from fibws.hub.rosapi.parameters import set_defaults

from .rosapi_client import RUN_ID, RosapiClient

DEFAULTS = [
    "/rosbridge_websocket/actual_host",
    "/rosbridge_websocket/actual_port",
    "/rosdistro",
    "/roslaunch/uris/host_localhost__9090",
    "/rosversion",
    "/run_id",
]


@pytest.fixture
def rosapi() -> RosapiClient:
    return RosapiClient()


# get_param and set_param.


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("5", "5"),
        (" [1, 2.50, true] ", "[1,2.5,true]"),
        ('"caf\\u00e9"', '"café"'),
        ('{"a": {"b": []}}', '{"a":{"b":[]}}'),
        (str(2**100), str(2**100)),
        ("0.1", "0.1"),
        ("1e300", "1e+300"),
        ("NaN", "null"),
        ("[NaN, -Infinity, 1]", "[null,-1e999,1]"),
        ('{"$binary": "AP8="}', '{"$binary":"AP8="}'),
        ('{"a/b": 1, "": {"c": 2}}', '{"a/b":1,"":{"c":2}}'),
    ],
)
def test_parameter_can_be_set_and_read(rosapi: RosapiClient, text: str, value: str) -> None:
    assert rosapi.call("/rosapi/set_param", name="/x", value=text) == {}
    assert rosapi.call("/rosapi/get_param", name="/x") == {"value": value}


def test_namespace_is_read_as_an_object(rosapi: RosapiClient) -> None:
    rosapi.call("/rosapi/set_param", name="/robot", value='{"arm": {"left": 1}}')
    rosapi.call("/rosapi/set_param", name="/robot/arm/right", value="2")
    assert rosapi.call("/rosapi/get_param", name="/robot") == {
        "value": '{"arm":{"left":1,"right":2}}'
    }


def test_all_parameters_can_be_set_and_read_at_once(rosapi: RosapiClient) -> None:
    rosapi.call("/rosapi/set_param", name="/", value='{"only": 1}')
    assert rosapi.call("/rosapi/get_param", name="/") == {"value": '{"only":1}'}


@pytest.mark.parametrize(
    ("default", "value"),
    [
        ("", "null"),
        ("null", "null"),
        ("5", "5"),
        ('{"a": [1.0]}', '{"a":[1.0]}'),
        ('"text"', '"text"'),
        ("not JSON", '"not JSON"'),
        ("NaN", '"NaN"'),
        ("1e400", "null"),
    ],
)
def test_get_param_returns_the_default_of_an_unknown_parameter(
    rosapi: RosapiClient, default: str, value: str
) -> None:
    got = rosapi.call("/rosapi/get_param", name="/nothing", default=default)
    assert got == {"value": value}


def test_get_param_ignores_the_default_of_a_known_parameter(rosapi: RosapiClient) -> None:
    rosapi.call("/rosapi/set_param", name="/x", value="0")
    assert rosapi.call("/rosapi/get_param", name="/x", default="5") == {"value": "0"}


def test_get_param_without_a_default_returns_null(rosapi: RosapiClient) -> None:
    assert rosapi.call("/rosapi/get_param", name="/nothing") == {"value": "null"}


@pytest.mark.parametrize("text", ["", "text", "{'a': 1}", "nan", "[1", "1 2", '"\\ud800"'])
def test_set_param_refuses_text_that_is_not_json(rosapi: RosapiClient, text: str) -> None:
    refusal = rosapi.refusal("/rosapi/set_param", name="/x", value=text)
    assert refusal.startswith(
        "Due to the type flexibility of the ROS parameter server, the value argument to set_param "
        "must be a JSON-formatted string."
    )
    assert rosapi.call("/rosapi/has_param", name="/x") == {"exists": False}


@pytest.mark.parametrize("text", ["null", "[null]", '{"a": {"b": null}}'])
def test_set_param_refuses_json_that_cannot_be_a_parameter(rosapi: RosapiClient, text: str) -> None:
    assert "/x" in rosapi.refusal("/rosapi/set_param", name="/x", value=text)
    assert rosapi.call("/rosapi/has_param", name="/x") == {"exists": False}


def test_root_can_only_be_set_to_an_object(rosapi: RosapiClient) -> None:
    assert "set it to an object" in rosapi.refusal("/rosapi/set_param", name="/", value="5")


@pytest.mark.parametrize("size", [2**22, 2**22 - 50])
def test_set_param_refuses_values_beyond_the_limit(rosapi: RosapiClient, size: int) -> None:
    value = '"' + "a" * size + '"'
    refusal = rosapi.refusal("/rosapi/set_param", name="/x", value=value)
    assert "--max-parameter-bytes" in refusal


# Names.


@pytest.mark.parametrize("spelling", ["~x", "/caller/x", "caller/x", "/caller//x/"])
def test_names_are_resolved_for_the_caller(rosapi: RosapiClient, spelling: str) -> None:
    rosapi.call("/rosapi/set_param", name="~x", value="5")
    assert rosapi.call("/rosapi/get_param", name=spelling) == {"value": "5"}
    assert rosapi.call("/rosapi/has_param", name=spelling) == {"exists": True}
    rosapi.call("/rosapi/delete_param", name=spelling)
    assert rosapi.call("/rosapi/has_param", name="~x") == {"exists": False}


def test_every_listed_name_can_be_looked_up(rosapi: RosapiClient) -> None:
    rosapi.call("/rosapi/set_param", name="/", value='{"1 odd-key": {"~": "ä", "é": 1}}')
    names = rosapi.call("/rosapi/get_param_names")["names"]
    assert names == ["/1 odd-key/~", "/1 odd-key/é"]
    for name in names:
        assert rosapi.call("/rosapi/has_param", name=name) == {"exists": True}


@pytest.mark.parametrize("name", ["", "not a name", "~"])
def test_invalid_name_is_refused(rosapi: RosapiClient, name: str) -> None:
    for service in ("get_param", "has_param", "delete_param"):
        assert "is not a legal name" in rosapi.refusal(f"/rosapi/{service}", name=name)
    refusal = rosapi.refusal("/rosapi/set_param", name=name, value="{}")
    assert "is not a legal name" in refusal


# The others.


def test_has_param_finds_parameters_and_namespaces(rosapi: RosapiClient) -> None:
    rosapi.call("/rosapi/set_param", name="/robot/arm", value="0")
    for name, exists in [("/robot", True), ("/robot/arm", True), ("/robot/leg", False)]:
        assert rosapi.call("/rosapi/has_param", name=name) == {"exists": exists}


def test_deleted_parameter_is_gone(rosapi: RosapiClient) -> None:
    rosapi.call("/rosapi/set_param", name="/robot", value='{"arm": 1, "leg": 2}')
    assert rosapi.call("/rosapi/delete_param", name="/robot/arm") == {}
    assert rosapi.call("/rosapi/get_param", name="/robot") == {"value": '{"leg":2}'}


def test_delete_param_ignores_an_unknown_parameter(rosapi: RosapiClient) -> None:
    assert rosapi.call("/rosapi/delete_param", name="/nothing") == {}


def test_root_cannot_be_deleted(rosapi: RosapiClient) -> None:
    assert "cannot be deleted" in rosapi.refusal("/rosapi/delete_param", name="/")


def test_search_param_starts_in_the_callers_namespace() -> None:
    rosapi = RosapiClient("/robot/arm/caller")

    def search(name: str) -> str:
        found: str = rosapi.call("/rosapi/search_param", name=name)["global_name"]
        return found

    assert search("speed") == ""
    for namespace in ("", "/robot", "/robot/arm", "/robot/arm/caller"):
        rosapi.call("/rosapi/set_param", name=f"{namespace}/speed", value="1")
        assert search("speed") == f"{namespace}/speed"
    assert search("speed/left") == "/robot/arm/caller/speed/left"
    assert search("/robot/speed") == "/robot/speed"
    assert search("/arm/speed") == ""


@pytest.mark.parametrize("name", ["", "~x"])
def test_search_param_refuses_empty_and_private_names(rosapi: RosapiClient, name: str) -> None:
    assert "is not a legal name" in rosapi.refusal("/rosapi/search_param", name=name)


def test_get_param_names_lists_values_but_not_namespaces(rosapi: RosapiClient) -> None:
    rosapi.call("/rosapi/set_param", name="/robot", value='{"arm": {"left": 1}, "none": {}}')
    assert rosapi.call("/rosapi/get_param_names") == {"names": ["/robot/arm/left", *DEFAULTS]}


# The first parameters.


def test_first_parameters_are_those_of_roscore_and_rosbridge(rosapi: RosapiClient) -> None:
    assert rosapi.call("/rosapi/get_param_names") == {"names": DEFAULTS}
    values = [rosapi.call("/rosapi/get_param", name=name)["value"] for name in DEFAULTS]
    assert values == [
        '"127.0.0.1"',
        "9090",
        '"noetic\\n"',
        '"http://localhost:9090/"',
        '"1.16.0\\n"',
        f'"{RUN_ID}"',
    ]


@pytest.mark.parametrize(
    ("host", "name", "uri"),
    [
        ("127.0.0.1", "host_127_0_0_1__9090", "http://127.0.0.1:9090/"),
        ("My-Robot.local", "host_my_robot_local__9090", "http://My-Robot.local:9090/"),
        ("::1", "host___1__9090", "http://[::1]:9090/"),
    ],
)
def test_hubs_address_is_a_parameter(host: str, name: str, uri: str) -> None:
    parameters = Parameters(2**20)
    set_defaults(parameters, run_id=RUN_ID, host=host, port=9090, address="0.0.0.0")
    assert parameters.get("/roslaunch/uris") == {name: uri}
