"""The sizes that messages claim, against the bytes that are there."""

from __future__ import annotations

import pytest

from fibws.values.message_sizes import (
    check_cloud,
    check_grid,
    check_image,
    check_picture,
    picture_size,
)

MOST = 2**32 - 1


@pytest.mark.parametrize(
    ("width", "height", "step", "size", "fault"),
    [
        (2, 2, 6, 12, ""),
        (2, 2, 8, 14, ""),  # The last row without its padding.
        (2, 1, 0, 6, ""),
        (2, 2, 6, 11, "need 12 bytes, got 11"),
        (2, 2, 5, 12, "a row has 5 bytes"),
        (30_000, 30_000, 0, 100, "a row has 0 bytes"),
        (30_000, 1, 0, 100, "need 90000 bytes"),
        (MOST, MOST, MOST, 100, "a row has"),
        (1, MOST, 3, 100, "need"),
        (0, 0, 0, 0, "no pixels"),
        (0, MOST, 0, 0, "no pixels"),
        (5, 0, 15, 0, "no pixels"),
    ],
)
def test_image(width: int, height: int, step: int, size: int, fault: str) -> None:
    expect(lambda: check_image(width, height, step, 3, size), fault)


@pytest.mark.parametrize(
    ("width", "height", "row_step", "point_step", "size", "fault"),
    [
        (2, 2, 32, 16, 64, ""),
        (2, 2, 40, 16, 72, ""),
        (0, 0, 0, 0, 0, ""),
        (0, MOST, 0, 16, 0, ""),
        (2, 2, 32, 16, 63, "need 64 bytes, got 63"),
        (2, 2, 1, 16, 64, "a row has 1 bytes"),
        (MOST, MOST, 0, 0, 64, "point_step is 0"),
        (MOST, 1, 16, 16, 64, "need"),
        (1, MOST, 16, 16, 64, "need"),
    ],
)
def test_cloud(
    width: int, height: int, row_step: int, point_step: int, size: int, fault: str
) -> None:
    expect(lambda: check_cloud(width, height, row_step, point_step, size), fault)


@pytest.mark.parametrize(
    ("width", "height", "cells", "fault"),
    [
        (2, 3, 6, ""),
        (0, MOST, 0, ""),
        (2, 3, 5, "2 x 3 cells"),
        (2, 3, 7, "2 x 3 cells"),
        (MOST, MOST, 6, "cells"),
    ],
)
def test_grid(width: int, height: int, cells: int, fault: str) -> None:
    expect(lambda: check_grid(width, height, cells), fault)


def expect(check: object, fault: str) -> None:
    assert callable(check)
    if fault:
        with pytest.raises(ValueError, match=fault):
            check()
    else:
        check()


def png(width: int, height: int, rest: int = 10**6) -> bytes:
    head = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"
    return head + width.to_bytes(4, "big") + height.to_bytes(4, "big") + bytes(rest)


def jpeg(width: int, height: int, before: bytes = b"") -> bytes:
    size = height.to_bytes(2, "big") + width.to_bytes(2, "big")
    return b"\xff\xd8" + before + b"\xff\xc0\0\x11\x08" + size + bytes(20)


def webp(kind: bytes, rest: bytes) -> bytes:
    return b"RIFF\0\0\0\0WEBP" + kind + bytes(4) + rest


PICTURES = [
    (png(640, 480), (640, 480)),
    (jpeg(640, 480), (640, 480)),
    (jpeg(640, 480, b"\xff\xe0\0\x10JFIF" + bytes(10)), (640, 480)),
    (jpeg(640, 480, b"\xff\xff\xc4\0\x04\1\2\xff\xd0"), (640, 480)),
    (webp(b"VP8X", bytes(4) + b"\x7f\2\0\xdf\1\0"), (640, 480)),
    (webp(b"VP8 ", bytes(6) + b"\x80\2\xe0\1"), (640, 480)),
    (webp(b"VP8L", b"\x2f" + (639 | 479 << 14).to_bytes(4, "little")), (640, 480)),
    (webp(b"ALPH", bytes(20)), None),
    (b"BM" + bytes(50), None),
    (b"", None),
    (b"\xff\xd8", None),
    (b"\xff\xd8" + b"\xff\xe0\0\0" * 20, None),
    (b"\xff\xd8abcdef", None),
]


@pytest.mark.parametrize(("data", "size"), PICTURES)
def test_size_of_a_picture_is_in_its_head(data: bytes, size: tuple[int, int] | None) -> None:
    assert picture_size(data) == size
    check_picture(data)


@pytest.mark.parametrize(
    ("data", "fault"),
    [
        (png(2**31, 2**31), "too many"),
        (png(8192, 8192, rest=100), "too few"),
        (jpeg(65535, 65535), "too many"),
        (webp(b"VP8X", bytes(4) + b"\xff" * 6), "too many"),
        (webp(b"VP8L", b"\x2f\xff\xff\xff\xff"), "too many"),
    ],
)
def test_picture_that_claims_too_much_is_refused(data: bytes, fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        check_picture(data)


def test_damaged_heads_of_pictures_are_read_without_an_error() -> None:
    for whole, _ in PICTURES:
        head = whole[:60]
        for at in range(len(head)):
            for byte in (0, 1, 0x7F, 0xC0, 0xFF):
                picture_size(head[:at] + bytes((byte,)) + head[at + 1 :])
                picture_size(head[:at] + bytes((byte,)))
