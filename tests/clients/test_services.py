"""Services, with each client."""

from __future__ import annotations

from typing import Any

from .casts import ROSLIB_2, Cast, playing

pytestmark = playing("services")


def test_a_service_answers_another_client(seen: Any) -> None:
    assert seen == {"sum": 3}


def test_a_service_answers_its_own_client(seen: Any) -> None:
    assert seen == {"sum": 42}


def test_a_field_that_the_request_leaves_out_is_0(seen: Any) -> None:
    assert seen == {"sum": 5}


def test_calls_that_overlap_get_each_its_own_answer(seen: Any) -> None:
    assert seen == [11, 12, 13]


def test_a_service_says_that_it_failed(seen: Any, cast: Cast) -> None:
    if cast.library == ROSLIB_2:  # It sends no values then.
        assert seen["failed"].startswith("service [/failing/trigger] responded with an error")
    else:  # rosbridge takes what the others send for a success with these values.
        assert seen == {"success": False, "message": "out of paper"}


def test_a_service_that_is_not_there_fails(seen: Any) -> None:
    assert seen == "Service /nobody/trigger does not exist"


def test_a_service_that_is_no_longer_there_fails(seen: Any) -> None:
    assert seen == "Service /brief/add_two_ints does not exist"


def test_a_request_that_does_not_fit_the_type_fails(seen: Any) -> None:
    assert "rospy_tutorials/AddTwoIntsRequest message requires a int64 for field a" in seen
