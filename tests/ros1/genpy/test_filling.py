"""Messages are filled from what is typed in a terminal, as genpy fills them."""

from __future__ import annotations

from io import StringIO

import pytest
from genpy import Time
from genpy.message import fill_message_args, get_printable_message_args

from .conftest import Agree
from .test_message import TYPES, make

NOW = "now=Time(7), auto=M('std_msgs/Header', 1, Time(2), 'map')"


@pytest.mark.parametrize(
    "expression",
    [
        "filled(M('std_msgs/Int32'), [5])",
        "filled(M('std_msgs/Int32'), [{'data': 5}])",
        "filled(M('std_msgs/Int32'), None)",
        "filled(M('std_msgs/Int32'), [1, 2])",
        "filled(M('std_msgs/Int32'), 'data')",
        "filled(M('std_msgs/Int32'), 5)",
        "filled(M('std_msgs/Int32'), [{'dta': 5}])",
        "filled(M('std_msgs/Empty'), None)",
        "filled(M('std_msgs/Empty'), [])",
        "filled(M('std_msgs/String'), [{'data': None}])",
        "filled(M('geometry_msgs/Point'), [1, 2, 3])",
        "filled(M('geometry_msgs/Twist'), [[1, 2, 3], {'z': 1}])",
        "filled(M('geometry_msgs/Twist'), [{'linear': {'w': 1}}])",
        "filled(M('geometry_msgs/Twist'), [{'linear': 5}])",
        "filled(M('geometry_msgs/Twist'), [{'linear': 'fast'}])",
        f"filled(M('std_msgs/Time'), ['now'], {NOW})",
        "filled(M('std_msgs/Time'), ['now'])",
        "filled(M('std_msgs/Time'), [1500000000])",
        "filled(M('std_msgs/Time'), [[1, 2]])",
        "filled(M('std_msgs/Time'), [{'secs': 1}])",
        f"filled(M('geometry_msgs/PoseStamped'), [{{'header': 'auto'}}], {NOW})",
        f"filled(M('geometry_msgs/PoseStamped'), ['auto', [[1, 2, 3], [0, 0, 0, 1]]], {NOW})",
        "filled(M('geometry_msgs/Polygon'), [[[1, 2, 3], {'x': 5}]])",
        "filled(M('geometry_msgs/Polygon'), [5])",
        "filled(M('nav_msgs/Odometry'), [{'pose': {'covariance': [1]}}])",
        "filled(M('sensor_msgs/LaserScan'), [{'ranges': [1, 2]}])",
        "filled(M('sensor_msgs/LaserScan'), [{'ranges': 'a'}])",
        "filled(M('rosgraph_msgs/Log'), [{'topics': ['/a', '/b']}])",
        "filled(5, [1])",
        "get_printable_message_args(M('geometry_msgs/PoseStamped'))",
    ],
)
def test_messages_are_filled_as_by_genpy(agree: Agree, expression: str) -> None:
    agree(expression, *TYPES)


def test_field_names_can_be_written_to_a_file() -> None:
    buffer = StringIO()
    message = make("geometry_msgs/Twist")
    names = "twist.linear.x twist.linear.y twist.linear.z "
    names += "twist.angular.x twist.angular.y twist.angular.z"
    assert get_printable_message_args(message, buffer, "twist.") == names
    assert buffer.getvalue() == names


def test_words_are_replaced_by_times() -> None:
    message = make("std_msgs/Time")
    fill_message_args(message, ["now"], {"now": Time(5)})
    assert message.data == Time(5)
