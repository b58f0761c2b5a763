"""The picture that pens draw: a square of pixels, and its PNG."""

from __future__ import annotations

import struct
import zlib
from math import ceil, hypot
from typing import TypeAlias

Color: TypeAlias = tuple[int, int, int]
"""Red, green and blue, each 0 to 255."""

MOST_COLORS = 256
_PNG_START = b"\x89PNG\r\n\x1a\n"
_PALETTE = 3
"""The colour type of PNG whose pixels are numbers of colours: PNG specification, 11.2.2."""


class Canvas:
    """A square of pixels; the first row is at the top.

    It keeps `MOST_COLORS` colours. Once all of them are in the picture, further ones become the
    nearest of them.

    Args:
        size: its width and height in pixels.
        background: its colour.
    """

    def __init__(self, size: int, background: Color) -> None:
        self.size = size
        self.fill(background)

    def fill(self, color: Color) -> None:
        """Give all pixels one colour."""
        self._colors = [color]
        self._pixels = bytearray(self.size * self.size)

    def color_at(self, x: float, y: float) -> Color:
        """Return the colour of the pixel at a point; points outside are moved to the edge."""
        row, column = self._inside(round(y)), self._inside(round(x))
        return self._colors[self._pixels[row * self.size + column]]

    def draw_stroke(
        self, start: tuple[float, float], end: tuple[float, float], color: Color, width: int
    ) -> None:
        """Draw a line with round ends; what is outside is left out.

        Args:
            start: a point in pixels.
            end: another one.
            color: its colour.
            width: its width in pixels, at least 1.
        """
        number = self._number(color)
        (x, y), (end_x, end_y) = start, end
        steps = max(1, ceil(hypot(end_x - x, end_y - y)))
        dots = {
            (
                round(x + (end_x - x) * step / steps),
                round(y + (end_y - y) * step / steps),
            )
            for step in range(steps + 1)
        }
        brush = _brush(width)
        for column, row in dots:
            for offset, before, after in brush:
                self._draw_row(row + offset, column + before, column + after, number)

    def png(self) -> bytes:
        """Return the picture as a PNG."""
        size, pixels = self.size, self._pixels
        rows = b"".join(
            b"\0" + pixels[start : start + size] for start in range(0, size * size, size)
        )
        colors = b"".join(map(bytes, self._colors))
        return b"".join(
            (
                _PNG_START,
                _chunk(b"IHDR", struct.pack("!2I5B", size, size, 8, _PALETTE, 0, 0, 0)),
                _chunk(b"PLTE", colors),
                _chunk(b"IDAT", zlib.compress(rows, 1)),
                _chunk(b"IEND", b""),
            )
        )

    def _draw_row(self, row: int, first: int, last: int, number: int) -> None:
        first, last = max(0, first), min(self.size - 1, last)
        if 0 <= row < self.size and first <= last:
            start = row * self.size
            self._pixels[start + first : start + last + 1] = bytes([number]) * (last - first + 1)

    def _number(self, color: Color) -> int:
        if color in self._colors:
            return self._colors.index(color)
        if len(self._colors) == MOST_COLORS:
            self._forget_unused()
        if len(self._colors) == MOST_COLORS:
            return min(range(MOST_COLORS), key=lambda each: _distance(self._colors[each], color))
        self._colors.append(color)
        return len(self._colors) - 1

    def _forget_unused(self) -> None:
        """Keep only the colours that are in the picture."""
        used = sorted(set(self._pixels))
        table = bytearray(MOST_COLORS)
        for new, old in enumerate(used):
            table[old] = new
        self._pixels = self._pixels.translate(bytes(table))
        self._colors = [self._colors[old] for old in used]

    def _inside(self, pixel: int) -> int:
        return min(max(pixel, 0), self.size - 1)


def _brush(width: int) -> list[tuple[int, int, int]]:
    """Return the rows of a round dot: offset, and the first and the last column."""
    reach = width // 2
    rows = []
    for offset in range(-reach, width - reach):
        # Measured from the middle of the dot, which is between pixels if the width is even.
        height = offset + 0.5 * (width % 2 == 0)
        half = max(0.0, (width / 2) ** 2 - height**2) ** 0.5
        columns = [
            each
            for each in range(-reach, width - reach)
            if abs(each + 0.5 * (width % 2 == 0)) <= half
        ]
        rows.append((offset, columns[0], columns[-1]))
    return rows


def _chunk(kind: bytes, data: bytes) -> bytes:
    check = zlib.crc32(kind + data)
    return struct.pack("!I", len(data)) + kind + data + struct.pack("!I", check)


def _distance(one: Color, other: Color) -> int:
    return sum((a - b) ** 2 for a, b in zip(one, other, strict=True))
