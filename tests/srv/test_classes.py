"""The standard services have a class each, as their definitions say."""

from __future__ import annotations

from fibws.interfaces import Interfaces, MessageDefinition, Service, Validators
from fibws.msg import geometry_msgs, roscpp
from fibws.srv import service_class
from fibws.srv.nav_msgs import GetPlan
from fibws.srv.roscpp import GetLoggers, GetLoggersResponse
from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsRequest

INTERFACES = Interfaces()
VALIDATORS = Validators(INTERFACES, lambda: 0)
SERVICES = [name for package in INTERFACES.packages() for name in INTERFACES.services(package)]


def defaults(definition: MessageDefinition) -> dict[str, object]:
    return VALIDATORS.of_definition(definition).validate({})


def test_each_service_has_the_messages_of_its_definition() -> None:
    for name in SERVICES:
        service, definition = service_class(name), INTERFACES.service(name)
        assert issubclass(service, Service), name
        assert service._type == name
        for message, expected in (
            (service.Request, definition.request),
            (service.Response, definition.response),
        ):
            assert message._type == expected.type
            given = message().to_dict()
            # A stamp that is missing from a message is the current time.
            assert VALIDATORS.of_definition(expected).validate(given) == given, name
            assert given.keys() == defaults(expected).keys(), name
            assert message.from_dict(given) == message(), name


def test_both_spellings_of_a_service_are_one_class() -> None:
    assert service_class("rospy_tutorials/srv/AddTwoInts") is AddTwoInts
    assert AddTwoInts.Request is AddTwoIntsRequest
    assert AddTwoInts.Request(1, b=2).to_dict() == {"a": 1, "b": 2}


def test_nested_fields_of_services_use_the_message_classes() -> None:
    response = GetLoggers.Response([roscpp.Logger("rosout", "info")])
    assert isinstance(response, GetLoggersResponse)
    assert response.to_dict() == {"loggers": [{"name": "rosout", "level": "info"}]}
    assert isinstance(GetPlan.Request().start, geometry_msgs.PoseStamped)
