"""The parameters as rosapi serves them."""

from __future__ import annotations

import pytest

from fibws.hub.graph.parameters import Parameters
from fibws.hub.rosapi.parameters import set_defaults

from .asking import RUN_ID, Asking

DEFAULTS = ["/rosdistro", "/roslaunch/uris/host_localhost__9090", "/rosversion", "/run_id"]


@pytest.fixture
def asking() -> Asking:
    return Asking()


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
    ],
)
def test_what_was_set_is_got(asking: Asking, text: str, value: str) -> None:
    assert asking.gets("/rosapi/set_param", name="/x", value=text) == {}
    assert asking.gets("/rosapi/get_param", name="/x") == {"value": value}


def test_a_namespace_is_got_as_an_object(asking: Asking) -> None:
    asking.gets("/rosapi/set_param", name="/robot", value='{"arm": {"left": 1}}')
    asking.gets("/rosapi/set_param", name="/robot/arm/right", value="2")
    assert asking.gets("/rosapi/get_param", name="/robot") == {
        "value": '{"arm":{"left":1,"right":2}}'
    }


def test_all_parameters_are_a_namespace(asking: Asking) -> None:
    asking.gets("/rosapi/set_param", name="/", value='{"only": 1}')
    assert asking.gets("/rosapi/get_param", name="/") == {"value": '{"only":1}'}


@pytest.mark.parametrize(
    ("default", "value"),
    [
        ("", "null"),
        ("null", "null"),
        ("5", "5"),
        ('{"a": [1.0]}', '{"a":[1.0]}'),
        ('"text"', '"text"'),
        ("no JSON", '"no JSON"'),
        ("NaN", '"NaN"'),
        ("1e400", "null"),
    ],
)
def test_what_is_not_set_has_its_default(asking: Asking, default: str, value: str) -> None:
    got = asking.gets("/rosapi/get_param", name="/nothing", default=default)
    assert got == {"value": value}


def test_what_is_set_has_no_default(asking: Asking) -> None:
    asking.gets("/rosapi/set_param", name="/x", value="0")
    assert asking.gets("/rosapi/get_param", name="/x", default="5") == {"value": "0"}


def test_a_call_without_a_default_has_none(asking: Asking) -> None:
    assert asking.gets("/rosapi/get_param", name="/nothing") == {"value": "null"}


@pytest.mark.parametrize("text", ["", "text", "{'a': 1}", "NaN", "[1", "1 2", '"\\ud800"'])
def test_only_json_can_be_set(asking: Asking, text: str) -> None:
    refused = asking.is_refused("/rosapi/set_param", name="/x", value=text)
    assert refused.startswith(
        "Due to the type flexibility of the ROS parameter server, the value argument to set_param "
        "must be a JSON-formatted string."
    )
    assert asking.gets("/rosapi/has_param", name="/x") == {"exists": False}


@pytest.mark.parametrize("text", ["null", "[null]", '{"a": {"b": null}}', "1e400", '{"a/b": 1}'])
def test_not_all_json_is_a_parameter(asking: Asking, text: str) -> None:
    assert "/x" in asking.is_refused("/rosapi/set_param", name="/x", value=text)
    assert asking.gets("/rosapi/has_param", name="/x") == {"exists": False}


def test_the_root_takes_only_objects(asking: Asking) -> None:
    assert "set it to an object" in asking.is_refused("/rosapi/set_param", name="/", value="5")


@pytest.mark.parametrize("size", [2**22, 2**22 - 50])
def test_parameters_are_bounded(asking: Asking, size: int) -> None:
    value = '"' + "a" * size + '"'
    refused = asking.is_refused("/rosapi/set_param", name="/x", value=value)
    assert "--max-parameter-bytes" in refused


# Names.


@pytest.mark.parametrize("spelling", ["~x", "/asker/x", "asker/x", "/asker//x/"])
def test_names_are_those_that_the_caller_means(asking: Asking, spelling: str) -> None:
    asking.gets("/rosapi/set_param", name="~x", value="5")
    assert asking.gets("/rosapi/get_param", name=spelling) == {"value": "5"}
    assert asking.gets("/rosapi/has_param", name=spelling) == {"exists": True}
    asking.gets("/rosapi/delete_param", name=spelling)
    assert asking.gets("/rosapi/has_param", name="~x") == {"exists": False}


def test_every_name_that_is_told_can_be_asked_for(asking: Asking) -> None:
    asking.gets("/rosapi/set_param", name="/", value='{"1 odd-key": {"~": "ä", "é": 1}}')
    names = asking.gets("/rosapi/get_param_names")["names"]
    assert names == ["/1 odd-key/~", "/1 odd-key/é"]
    for name in names:
        assert asking.gets("/rosapi/has_param", name=name) == {"exists": True}


@pytest.mark.parametrize("name", ["", "no name", "~"])
def test_what_is_no_name_is_refused(asking: Asking, name: str) -> None:
    for service in ("get_param", "has_param", "delete_param"):
        assert "is not a legal name" in asking.is_refused(f"/rosapi/{service}", name=name)
    refused = asking.is_refused("/rosapi/set_param", name=name, value="{}")
    assert "is not a legal name" in refused


# The others.


def test_parameters_and_namespaces_are_there(asking: Asking) -> None:
    asking.gets("/rosapi/set_param", name="/robot/arm", value="0")
    for name, exists in [("/robot", True), ("/robot/arm", True), ("/robot/leg", False)]:
        assert asking.gets("/rosapi/has_param", name=name) == {"exists": exists}


def test_what_was_deleted_is_gone(asking: Asking) -> None:
    asking.gets("/rosapi/set_param", name="/robot", value='{"arm": 1, "leg": 2}')
    assert asking.gets("/rosapi/delete_param", name="/robot/arm") == {}
    assert asking.gets("/rosapi/get_param", name="/robot") == {"value": '{"leg":2}'}


def test_what_is_not_there_may_be_deleted(asking: Asking) -> None:
    assert asking.gets("/rosapi/delete_param", name="/nothing") == {}


def test_the_root_cannot_be_deleted(asking: Asking) -> None:
    assert "cannot be deleted" in asking.is_refused("/rosapi/delete_param", name="/")


def test_a_search_begins_with_the_caller() -> None:
    asking = Asking("/robot/arm/asker")

    def search(name: str) -> str:
        found: str = asking.gets("/rosapi/search_param", name=name)["global_name"]
        return found

    assert search("speed") == ""
    for place in ("", "/robot", "/robot/arm", "/robot/arm/asker"):
        asking.gets("/rosapi/set_param", name=f"{place}/speed", value="1")
        assert search("speed") == f"{place}/speed"
    assert search("speed/left") == "/robot/arm/asker/speed/left"
    assert search("/robot/speed") == "/robot/speed"
    assert search("/arm/speed") == ""


@pytest.mark.parametrize("name", ["", "~x"])
def test_a_search_needs_a_name_that_can_be_elsewhere(asking: Asking, name: str) -> None:
    assert "is not a legal name" in asking.is_refused("/rosapi/search_param", name=name)


def test_names_are_those_of_values(asking: Asking) -> None:
    asking.gets("/rosapi/set_param", name="/robot", value='{"arm": {"left": 1}, "none": {}}')
    assert asking.gets("/rosapi/get_param_names") == {"names": ["/robot/arm/left", *DEFAULTS]}


# The first parameters.


def test_there_are_parameters_from_the_start(asking: Asking) -> None:
    assert asking.gets("/rosapi/get_param_names") == {"names": DEFAULTS}
    values = [asking.gets("/rosapi/get_param", name=name)["value"] for name in DEFAULTS]
    assert values == [
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
def test_the_hub_s_address_is_a_parameter(host: str, name: str, uri: str) -> None:
    parameters = Parameters(2**20)
    set_defaults(parameters, run_id=RUN_ID, host=host, port=9090)
    assert parameters.get("/roslaunch/uris") == {name: uri}
