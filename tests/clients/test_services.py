"""Services, with each client."""

from __future__ import annotations

from typing import Any

from .casts import ROSLIB_2, Cast, playing

pytestmark = playing("services")


def test_service_answers_another_client(seen: Any) -> None:
    assert seen == {"sum": 3}


def test_client_calls_its_own_service(seen: Any) -> None:
    assert seen == {"sum": 42}


def test_missing_field_of_a_request_is_0(seen: Any) -> None:
    assert seen == {"sum": 5}


def test_concurrent_calls_get_their_own_responses(seen: Any) -> None:
    assert seen == [11, 12, 13]


def test_service_reports_its_failure(seen: Any, cast: Cast) -> None:
    if cast.library == ROSLIB_2:  # It sends no values then.
        assert seen["failed"].startswith("service [/failing/trigger] responded with an error")
    else:  # rosbridge takes what the others send for a success with these values.
        assert seen == {"success": False, "message": "out of paper"}


def test_call_of_a_missing_service_fails(seen: Any) -> None:
    assert seen == "Service /nobody/trigger does not exist"


def test_call_of_an_unadvertised_service_fails(seen: Any) -> None:
    assert seen == "Service /brief/add_two_ints does not exist"


def test_invalid_request_fails(seen: Any) -> None:
    assert "rospy_tutorials/AddTwoIntsRequest message requires an int64 for field a" in seen
