"""What transform and relay_field compute; their programs are tested as programs."""

from __future__ import annotations

import pytest
import rospy
from geometry_msgs.msg import Point, PointStamped
from std_msgs.msg import Float64, String
from topic_tools import expressions


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("m.x", Float64(3.0)),
        ("[m.x + 1]", Float64(4.0)),
        ("Float64", None),
        ("math.hypot(m.x, m.y)", Float64(5.0)),
    ],
)
def test_transform_evaluates_an_expression(expression: str, expected: Float64 | None) -> None:
    compute = expressions._transform(expression, ["math"], Float64)
    if expected is None:
        with pytest.raises(NameError):
            compute(Point(3.0, 4.0, 0.0))
    else:
        assert compute(Point(3.0, 4.0, 0.0)) == expected


def test_transform_may_give_the_message_itself() -> None:
    point = Point(1.0, 2.0, 3.0)
    assert expressions._transform("m", [], Point)(point) is point
    assert expressions._transform("[m.z, m.y, m.x]", [], Point)(point) == Point(3.0, 2.0, 1.0)


def test_modules_that_are_missing_are_named(capsys: pytest.CaptureFixture[str]) -> None:
    expressions._transform("m", ["nothing_of_this_name"], Float64)
    assert "nothing_of_this_name" in capsys.readouterr().err


def test_relay_field_evaluates_texts_of_yaml(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rospy, "get_rostime", rospy.Time)
    fields = "{header: {frame_id: a map}, point: {x: m.y, y: -m.x, z: 1}}"
    found = expressions._relay_field(fields, PointStamped)(Point(3.0, 4.0, 0.0))
    assert found.header.frame_id == "a map"
    assert found.point == Point(4.0, -3.0, 1)
    assert expressions._relay_field("data: m.data * 2", String)(String("a")) == String("aa")


@pytest.mark.parametrize(
    ("program", "expression", "text"),
    [
        ("transform", "m.", "invalid expression"),
        ("relay_field", "7", "expected fields as YAML"),
        ("relay_field", "{", "invalid YAML"),
    ],
)
def test_other_expressions_are_errors(program: str, expression: str, text: str) -> None:
    with pytest.raises(SystemExit, match=text):
        if program == "transform":
            expressions._transform(expression, [], Float64)
        else:
            expressions._relay_field(expression, Float64)
