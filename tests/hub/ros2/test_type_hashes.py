"""The hashes of types, compared with those of ROS 2."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore

from fibws.errors import InterfaceError, Ros2Error
from fibws.hub.ros2.type_hashes import message_hash, service_hash
from fibws.hub.ros2.types import Ros2Types, check_hash
from fibws.interfaces import Interfaces

from .peer import ADD_HASH, STRING_HASH

STANDARD = Interfaces()
OTHER_FIELDS = {
    "sensor_msgs/msg/Range",
    "shape_msgs/msg/SolidPrimitive",
    "std_msgs/msg/Char",  # In rosbags, whose char is not uint8.
    "visualization_msgs/msg/InteractiveMarker",
    "visualization_msgs/msg/InteractiveMarkerControl",
    "visualization_msgs/msg/InteractiveMarkerInit",
    "visualization_msgs/msg/InteractiveMarkerUpdate",
    "visualization_msgs/msg/Marker",
    "visualization_msgs/msg/MarkerArray",
}
"""Messages whose definitions differ between ROS 1 and ROS 2."""


def hash_of(name: str, interfaces: Interfaces = STANDARD) -> str:
    return message_hash(interfaces.message(name), interfaces.message)


def test_hash_that_ros_2_has_published() -> None:
    assert hash_of("std_msgs/String") == STRING_HASH
    service = STANDARD.service("example_interfaces/AddTwoInts")
    assert service_hash(service, STANDARD.message) == ADD_HASH


@pytest.mark.parametrize("release", [Stores.ROS2_HUMBLE, Stores.ROS2_JAZZY, Stores.ROS2_KILTED])
def test_hashes_of_common_messages_are_those_of_rosbags(release: Stores) -> None:
    store: Any = get_typestore(release)
    same, other = set[str](), set[str]()
    for name in store.fielddefs:
        package, kind, type_ = name.split("/")
        try:
            own = hash_of(f"{package}/{type_}") if kind == "msg" else ""
        except InterfaceError:
            continue
        if own:
            (same if own == store.hash_rihs01(name) else other).add(name)
    assert len(same) >= 114
    assert other <= OTHER_FIELDS


def test_bounds_and_defaults(tmp_path: Path) -> None:
    definition = "string<=10 name\nuint8[<=4] some [1, 2]\nfloat32[3] three\nstring<=5[] words\n"
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Bounded.msg").write_text(f"int8 CONSTANT=1\n{definition}")
    from rosbags.typesys import get_types_from_msg

    store: Any = get_typestore(Stores.EMPTY)
    plain = definition.replace(" [1, 2]", "")
    store.register(get_types_from_msg(plain, "my_msgs/msg/Bounded"))
    interfaces = Interfaces([tmp_path])
    own = hash_of("my_msgs/Bounded", interfaces)
    assert own == store.hash_rihs01("my_msgs/msg/Bounded")


def test_type_that_cannot_be_converted_is_refused_each_time(tmp_path: Path) -> None:
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Wide.msg").write_text("wstring text\n")
    interfaces, types = Interfaces([tmp_path]), Ros2Types()
    for _ in range(2):
        with pytest.raises(Ros2Error, match="wstring"):
            types.message(interfaces, "my_msgs/Wide")
        with pytest.raises(InterfaceError):
            types.message(interfaces, "my_msgs/Missing")
    assert types.message(interfaces, "std_msgs/Int8") is types.message(interfaces, "std_msgs/Int8")


def test_other_hash_is_refused_with_both() -> None:
    check_hash("std_msgs/String", STRING_HASH, STRING_HASH)
    check_hash("std_msgs/String", STRING_HASH, "TypeHashNotSupported")
    with pytest.raises(Ros2Error, match=f"{ADD_HASH}.*{STRING_HASH}"):
        check_hash("std_msgs/String", STRING_HASH, ADD_HASH)
