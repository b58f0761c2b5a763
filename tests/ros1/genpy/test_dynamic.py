"""Message classes from the full text of a definition."""

from __future__ import annotations

import io

import pytest
from genpy.classes import message_class
from genpy.dynamic import MsgGenerationException, generate_dynamic

SEPARATOR = "=" * 80
CHANGED = f"""uint8 FIRST=1
int32 number
Part[] parts
{SEPARATOR}
MSG: std_msgs/Part
float32 x
"""


def test_classes_are_those_of_the_text_not_of_the_installed_type() -> None:
    made = generate_dynamic("std_msgs/Int32", CHANGED)
    assert set(made) == {"std_msgs/Int32", "std_msgs/Part"}
    whole, part = made["std_msgs/Int32"], made["std_msgs/Part"]
    assert whole.__slots__ == ["number", "parts"]
    assert whole._md5sum != message_class("std_msgs/Int32")._md5sum
    written = io.BytesIO()
    whole(number=5, parts=[part(x=2.5)]).serialize(written)
    read = whole().deserialize(written.getvalue())
    assert (read.number, read.parts[0].x) == (5, 2.5)
    assert message_class("std_msgs/Int32").__slots__ == ["data"]


def test_header_of_old_bags_is_that_of_std_msgs() -> None:
    text = (
        f"Header header\n{SEPARATOR}\nMSG: roslib/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
    )
    made = generate_dynamic("own/Whole", text)
    assert set(made) == {"own/Whole", "std_msgs/Header"}
    assert made["own/Whole"]._has_header


@pytest.mark.parametrize(
    "text", ["int32", "Missing missing", f"int32 x\n{SEPARATOR}\nno title", "a/A b\na/A b"]
)
def test_invalid_text_is_an_error(text: str) -> None:
    with pytest.raises(MsgGenerationException):
        generate_dynamic("own/Whole", text)
