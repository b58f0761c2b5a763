"""Comma-separated values; compared with rostopic's in `test_side_by_side`."""

from __future__ import annotations

from fibws.client.hub_client import HubClient
from fibws.values.csv_rows import Rows
from fibws.values.typedefs import TypedefField, Typedefs

NOW = 12_000_000_000


def test_row_begins_with_the_time(client: HubClient) -> None:
    rows = Rows(Typedefs.of_message(client, "std_msgs/Int32"), TypedefField("", "std_msgs/Int32"))
    assert rows.head({"data": 8}) == "%time,field.data"
    assert rows.row({"data": 8}, now=NOW) == f"{NOW},8"


def test_time_is_the_header_s_stamp(client: HubClient) -> None:
    type_ = "geometry_msgs/PointStamped"
    rows = Rows(Typedefs.of_message(client, type_), TypedefField("", type_))
    header = {"seq": 1, "stamp": {"secs": 11, "nsecs": 5}, "frame_id": "map"}
    message = {"header": header, "point": {"x": 1.0, "y": None, "z": 3.0}}
    assert rows.row(message, now=NOW) == "11000000005,1,11000000005,map,1.0,nan,3.0"
    relative = "-999999995,1,-999999995,map,1.0,nan,3.0"
    assert rows.row(message, now=NOW, relative=True) == relative


def test_each_element_of_an_array_has_a_column(client: HubClient) -> None:
    type_ = "std_msgs/UInt8MultiArray"
    message = {"layout": {"dim": [], "data_offset": 0}, "data": "AQI="}
    rows = Rows(Typedefs.of_message(client, type_), TypedefField("", type_))
    assert rows.head(message) == "%time,field.layout.data_offset,field.data0,field.data1"
    assert rows.row(message, now=NOW) == f"{NOW},0,1,2"


def test_message_of_an_unknown_type_has_a_column_for_each_value() -> None:
    rows = Rows(Typedefs("unknown_msgs/Type"), TypedefField("", "unknown_msgs/Type"))
    message = {"a": True, "b": {"c": "x"}, "d": [1, 2]}
    assert rows.head(message) == "%time,field.a,field.b.c,field.d0,field.d1"
    assert rows.row(message, now=NOW) == f"{NOW},1,x,1,2"
