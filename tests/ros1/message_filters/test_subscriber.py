"""Filters of topics in a script."""

from __future__ import annotations

from ros1.side_by_side import Part, our_ros


async def test_messages_of_two_topics_are_matched() -> None:
    async with our_ros() as ros:
        (said,) = await ros.play(Part("filters/synchronized.py", interrupted=False))
    assert said.out == [
        "image /camera_info",
        *("both 1.0 camera", "both 3.0 camera", "both 5.0 camera"),
        "[3.0, 5.0]",
    ]
    assert (said.err, said.code) == ([], 0)
