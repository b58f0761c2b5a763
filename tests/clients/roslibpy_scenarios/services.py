"""Services, as the documentation of roslibpy uses them."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

from patience import PATIENCE
from roslibpy import Service, ServiceRequest
from roslibpy.core import ServiceException

from .world import World

ADD = "rospy_tutorials/AddTwoInts"
TRIGGER = "std_srvs/Trigger"


def _add(request: Any, response: Any) -> bool:
    response["sum"] = request["a"] + request["b"]
    return True


def _call(service: Any, **request: Any) -> Any:
    return service.call(ServiceRequest(request), timeout=PATIENCE)


def _refusal(service: Any, **request: Any) -> str:
    try:
        answer = _call(service, **request)
    except ServiceException as error:
        return str(error)
    raise AssertionError(f"It was not refused but gave {answer}.")


def service_answers_another_client(world: World) -> Any:
    provider, caller = world.connect(), world.connect()
    Service(provider, "/add_two_ints", ADD).advertise(_add)
    world.settled(provider)
    return _call(Service(caller, "/add_two_ints", ADD), a=1, b=2)


def client_calls_its_own_service(world: World) -> Any:
    ros = world.connect()
    Service(ros, "/own/add_two_ints", ADD).advertise(_add)
    return _call(Service(ros, "/own/add_two_ints", ADD), a=20, b=22)


def missing_field_of_a_request_is_0(world: World) -> Any:
    ros = world.connect()
    Service(ros, "/short/add_two_ints", ADD).advertise(_add)
    return _call(Service(ros, "/short/add_two_ints", ADD), b=5)


def concurrent_calls_get_their_own_responses(world: World) -> Any:
    ros = world.connect()
    Service(ros, "/busy/add_two_ints", ADD).advertise(_add)
    service = Service(ros, "/busy/add_two_ints", ADD)
    with ThreadPoolExecutor() as pool:
        answers = pool.map(lambda a: _call(service, a=a, b=10), [1, 2, 3])
        return [answer["sum"] for answer in answers]


def service_reports_its_failure(world: World) -> Any:
    ros = world.connect()

    def fail(_: Any, response: Any) -> bool:
        response["message"] = "out of paper"
        return False

    Service(ros, "/failing/trigger", TRIGGER).advertise(fail)
    return _call(Service(ros, "/failing/trigger", TRIGGER))


def call_of_a_missing_service_fails(world: World) -> Any:
    return _refusal(Service(world.connect(), "/nobody/trigger", TRIGGER))


def call_of_an_unadvertised_service_fails(world: World) -> Any:
    ros = world.connect()
    provider = Service(ros, "/brief/add_two_ints", ADD)
    provider.advertise(_add)
    world.settled(ros)
    provider.unadvertise()
    world.settled(ros)
    return _refusal(Service(ros, "/brief/add_two_ints", ADD), a=1, b=2)


def invalid_request_fails(world: World) -> Any:
    ros = world.connect()
    Service(ros, "/strict/add_two_ints", ADD).advertise(_add)
    return _refusal(Service(ros, "/strict/add_two_ints", ADD), a="one", b=2)
