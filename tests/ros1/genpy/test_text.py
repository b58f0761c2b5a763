"""Values are printed as genpy prints them, whatever is asked for."""

from __future__ import annotations

import pytest

from .conftest import Agree
from .test_message import TYPES

STAMPED = "M('geometry_msgs/PoseStamped', header=M('std_msgs/Header', 1, Time(5, 6), 'map'))"


@pytest.mark.parametrize(
    "value",
    [
        *("5", "-5", "1.5", "True", "None", "'text'", "''", "b'a'", "[]", "()", "[1, 2]", "[1.5]"),
        *("(True, False)", "['a', 'b c']", "[[1], [2]]", "{'a': 1}", "Time(1, 2)"),
        *("Duration(-1, 2)", "[Time(1), Duration(2)]", "[None]", "nan", "TVal(1, 2)"),
        *(STAMPED, f"[{STAMPED}]", "M('std_msgs/Empty')", "[M('std_msgs/Empty')]"),
        "M('sensor_msgs/Image', data='abc')",
        "M('sensor_msgs/Image', data=b'abc')",
        "M('sensor_msgs/Image', data=[1, 2])",
        "M('sensor_msgs/Image', data=bytearray(b'abc'))",
        "M('sensor_msgs/LaserScan', ranges=(1, 2.5))",
        "M('rosgraph_msgs/Log', topics=['/a', 'b c'])",
        "M('std_msgs/Int32', data='wrong')",
    ],
)
@pytest.mark.parametrize(
    "how",
    [
        *("", "indent='    '", "time_offset=Time(3)", "fixed_numeric_width=7"),
        "current_time=Time(9)",
        "field_filter=lambda m: [n for n in m.__slots__ if n != 'header']",
    ],
)
def test_values_are_printed_as_by_genpy(agree: Agree, value: str, how: str) -> None:
    agree(f"strify_message({value}, {how})", *TYPES)
