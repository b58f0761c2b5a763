"""The pixels that pens draw, and their PNG."""

from __future__ import annotations

import struct
import zlib

import pytest

from fibws.programs.turtlesim.canvas import MOST_COLORS, Canvas

BLUE, RED, WHITE = (0, 0, 255), (255, 0, 0), (255, 255, 255)


def pixels_of(png: bytes) -> list[list[tuple[int, ...]]]:
    """Return the rows of a PNG with a palette, as another program would read them."""
    chunks, at = {}, 8
    while at < len(png):
        (size,) = struct.unpack_from("!I", png, at)
        kind, data = png[at + 4 : at + 8], png[at + 8 : at + 8 + size]
        assert struct.unpack_from("!I", png, at + 8 + size) == (zlib.crc32(kind + data),)
        chunks[kind] = data
        at += size + 12
    width, height, depth, color_type = struct.unpack_from("!2I2B", chunks[b"IHDR"])
    assert (depth, color_type) == (8, 3)
    colors = [tuple(chunks[b"PLTE"][i : i + 3]) for i in range(0, len(chunks[b"PLTE"]), 3)]
    data = zlib.decompress(chunks[b"IDAT"])
    rows = [data[i : i + width + 1] for i in range(0, len(data), width + 1)]
    assert len(rows) == height
    assert all(row[0] == 0 for row in rows)
    return [[colors[each] for each in row[1:]] for row in rows]


@pytest.mark.parametrize(("width", "expected"), [(1, 11), (2, 24), (3, 39)])
def test_stroke_has_its_width_and_round_ends(width: int, expected: int) -> None:
    canvas = Canvas(20, BLUE)
    canvas.draw_stroke((5, 10), (15, 10), RED, width)
    rows = pixels_of(canvas.png())
    assert sum(row.count(RED) for row in rows) == expected
    assert rows[10][5:16] == [RED] * 11
    assert sum(RED in row for row in rows) == width


def test_what_is_outside_is_left_out() -> None:
    canvas = Canvas(10, BLUE)
    canvas.draw_stroke((-5, 4), (20, 4), RED, 1)
    canvas.draw_stroke((0, -50), (0, -20), WHITE, 255)
    rows = pixels_of(canvas.png())
    assert rows[4] == [RED] * 10 or WHITE in rows[4]
    assert canvas.color_at(-7, 4) == canvas.color_at(0, 4)
    assert canvas.color_at(100, 100) == canvas.color_at(9, 9)


def test_fill_removes_everything() -> None:
    canvas = Canvas(5, BLUE)
    canvas.draw_stroke((0, 0), (4, 4), RED, 3)
    canvas.fill(WHITE)
    assert pixels_of(canvas.png()) == [[WHITE] * 5] * 5


def test_colors_that_are_painted_over_make_room_for_others() -> None:
    canvas = Canvas(20, BLUE)
    for red in range(256):
        for green in (0, 1):
            canvas.draw_stroke((3, 3), (3, 3), (red, green, 7), 1)
            assert canvas.color_at(3, 3) == (red, green, 7)
    assert canvas.color_at(0, 0) == BLUE


def test_with_all_colors_in_use_the_nearest_is_drawn() -> None:
    canvas = Canvas(20, (0, 0, 0))
    for each in range(1, MOST_COLORS):
        canvas.draw_stroke((each % 20, each // 20), (each % 20, each // 20), (each, 0, 0), 1)
    canvas.draw_stroke((19, 19), (19, 19), (100, 3, 0), 1)
    assert canvas.color_at(19, 19) == (100, 0, 0)
