"""The sizes that messages claim, against the bytes that are there."""

from __future__ import annotations

import pytest

from fibws.values.message_sizes import check_cloud, check_grid, check_image

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
