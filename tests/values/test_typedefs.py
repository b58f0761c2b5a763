"""Definitions of types, as a real hub reports them."""

from __future__ import annotations

import pytest

from fibws.client.hub_client import HubClient
from fibws.errors import ServiceError
from fibws.values.typedefs import TypedefField, Typedefs, if_known


def test_message_has_its_fields_in_order(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "geometry_msgs/PoseWithCovariance")
    assert typedefs.root == "geometry_msgs/PoseWithCovariance"
    assert typedefs.fields(typedefs.root) == [
        TypedefField("pose", "geometry_msgs/Pose"),
        TypedefField("covariance", "float64", 36),
    ]
    assert [field.name for field in typedefs.fields("geometry_msgs/Point")] == ["x", "y", "z"]


def test_array_of_any_length_has_length_0(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "std_msgs/Int32MultiArray")
    data = typedefs.fields(typedefs.root)[1]
    assert data == TypedefField("data", "int32", 0)
    assert data.written_type == "int32[]"


@pytest.mark.parametrize(
    ("field", "written"),
    [
        (TypedefField("a", "int32"), "int32"),
        (TypedefField("a", "int32", 0), "int32[]"),
        (TypedefField("a", "std_msgs/Header", 3), "std_msgs/Header[3]"),
    ],
)
def test_type_is_written_as_in_definitions(field: TypedefField, written: str) -> None:
    assert field.written_type == written


def test_names_of_ros_2_mean_the_same_types(client: HubClient) -> None:
    assert Typedefs.of_message(client, "std_msgs/msg/Int32").root == "std_msgs/Int32"


def test_constants_have_names_and_values(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "rosgraph_msgs/Log")
    assert typedefs.constants("rosgraph_msgs/Log")["WARN"] == "4"


def test_service_has_a_request_and_a_response(client: HubClient) -> None:
    request = Typedefs.of_request(client, "rospy_tutorials/AddTwoInts")
    response = Typedefs.of_response(client, "rospy_tutorials/AddTwoInts")
    assert request.fields(request.root) == [TypedefField("a", "int64"), TypedefField("b", "int64")]
    assert response.fields(response.root) == [TypedefField("sum", "int64")]


def test_unknown_type_is_an_error(client: HubClient) -> None:
    with pytest.raises(ServiceError, match="did you mean std_msgs/String"):
        Typedefs.of_message(client, "std_msgs/Strin")
    unknown = if_known(Typedefs.of_message, client, "std_msgs/Strin")
    assert unknown.root == "std_msgs/Strin"
    assert unknown.root not in unknown


def test_defaults_are_those_of_ros(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "geometry_msgs/PoseStamped")
    default = typedefs.default(TypedefField("", typedefs.root))
    assert default["header"] == {"seq": 0, "stamp": {"secs": 0, "nsecs": 0}, "frame_id": ""}
    assert default["pose"]["position"] == {"x": 0.0, "y": 0.0, "z": 0.0}
    assert typedefs.default(TypedefField("", "bool", 2)) == [False, False]
    assert typedefs.default(TypedefField("", "uint8", 0)) == []


def test_empty_definition_contains_no_type() -> None:
    typedefs = Typedefs("my_msgs/Mine")
    assert "my_msgs/Mine" not in typedefs
    with pytest.raises(KeyError):
        typedefs.fields("my_msgs/Mine")


def test_header_is_the_first_field(client: HubClient) -> None:
    typedefs = Typedefs.of_message(client, "nav_msgs/Path")
    assert typedefs.has_header("nav_msgs/Path")
    assert typedefs.has_header("geometry_msgs/PoseStamped")
    assert not typedefs.has_header("geometry_msgs/Point")
    assert not typedefs.has_header("unknown_msgs/Type")
    assert typedefs.has_sequenced_header("nav_msgs/Path")
    assert not typedefs.has_sequenced_header("geometry_msgs/Point")


@pytest.mark.parametrize("typedefs", [5, [5], [{"type": "x"}], [{}]])
def test_invalid_response_is_an_error(typedefs: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(HubClient, "__init__", lambda *_: None)
    monkeypatch.setattr(HubClient, "call", lambda *_: {"typedefs": typedefs})
    with pytest.raises(ServiceError, match=r"invalid .*std_msgs/Int32"):
        Typedefs.of_message(HubClient("test"), "std_msgs/Int32")
