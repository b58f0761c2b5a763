"""Maps of map_server, read from files and written to them."""

from __future__ import annotations

from array import array
from pathlib import Path
from typing import Any

import pytest
import yaml
from PIL import Image as pillow

from fibws.ros1 import map_files
from fibws.ros1.errors import MapError
from fibws.ros1.map_files import GridMap, read_image, read_map, write_map

METADATA: dict[str, Any] = {
    "image": "map.pgm",
    "resolution": 0.05,
    "origin": [-1.0, 2.0, 0.5],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


def metadata(folder: Path, **values: Any) -> Path:
    file = folder / "map.yaml"
    file.write_text(yaml.safe_dump({**METADATA, **values}))
    return file


def cells(folder: Path, **values: Any) -> list[int]:
    return read_map(metadata(folder, **values)).cells.tolist()


def test_missing_file_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(MapError, match=r"none\.yaml: No such file") as raised:
        read_map(tmp_path / "none.yaml")
    assert raised.value.part == "file"


def test_first_cell_is_the_lower_left_one(tmp_path: Path) -> None:
    (tmp_path / "map.pgm").write_bytes(b"P5\n# x\n3 2\n255\n" + bytes([0, 254, 205, 100, 254, 0]))
    grid = read_map(metadata(tmp_path))
    assert (grid.width, grid.height, grid.resolution) == (3, 2, 0.05)
    assert grid.origin == (-1.0, 2.0, 0.5)
    assert grid.cells.tolist() == [-1, 0, 100, 100, 0, -1]


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        # Expected values are those of map_server's documents for 255, 205, 128, 0.
        ({"mode": "trinary"}, [0, -1, -1, 100]),
        ({"mode": "scale"}, [0, 1, 66, 100]),
        ({"mode": "raw"}, [-1, -51, -128, 0]),
        ({"negate": 1}, [100, 100, -1, 0]),
        ({"negate": True, "occupied_thresh": 0.9}, [100, -1, -1, 0]),
        ({"free_thresh": 0.5, "occupied_thresh": 0.9}, [0, 0, 0, 100]),
    ],
)
def test_pixels_mean_cells(tmp_path: Path, values: dict[str, Any], expected: list[int]) -> None:
    (tmp_path / "map.pgm").write_bytes(b"P5 4 1 255\n" + bytes([255, 205, 128, 0]))
    assert cells(tmp_path, **values) == expected


@pytest.mark.parametrize(
    "content",
    [
        b"P2\n2 2\n# comment\n255\n0 255\n128 7\n",
        b"P5\n2 2\n255\n\x00\xff\x80\x07",
        b"P5\n2 2\n65535\n\x00\x00\xff\xff\x80\x80\x07\x07",
        b"P2 2 2 51 0 51 26 2",
    ],
)
def test_pgm_images_are_read(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.pgm").write_bytes(content)
    image = read_image(tmp_path / "a.pgm")
    [values] = image.channels
    assert values[:2] == b"\x00\xff"
    assert values[2] in (128, 130) and values[3] in (7, 10)


def test_png_images_are_read(tmp_path: Path) -> None:
    grey = pillow.new("L", (2, 1), 255)
    grey.putpixel((0, 0), 0)
    grey.save(tmp_path / "grey.png")
    assert cells(tmp_path, image="grey.png") == [100, 0]
    grey.convert("RGB").save(tmp_path / "color.png")
    assert cells(tmp_path, image="color.png") == [100, 0]
    clear = pillow.new("RGBA", (2, 1), (128, 128, 128, 0))
    clear.putpixel((0, 0), (128, 128, 128, 255))
    clear.save(tmp_path / "clear.png")
    assert cells(tmp_path, image="clear.png", mode="scale") == [66, -1]
    pillow.new("I;16", (1, 1), 65535).save(tmp_path / "deep.png")
    assert cells(tmp_path, image="deep.png") == [0]


@pytest.mark.parametrize(
    ("values", "part", "fact"),
    [
        ({"resolution": 0}, "metadata", "resolution must be > 0, got 0"),
        ({"resolution": "x"}, "metadata", "resolution must be a number, got 'x'"),
        ({"origin": [1, 2]}, "metadata", "origin must be [x, y, yaw], got [1, 2]"),
        ({"origin": [1, 2, float("nan")]}, "metadata", "origin"),
        ({"mode": "gray"}, "metadata", "trinary, scale, raw, got 'gray'"),
        ({"negate": 2}, "metadata", "negate must be 0 or 1, got 2"),
        ({"image": ""}, "metadata", "image"),
        ({"image": "none.pgm"}, "file", "none.pgm: No such file"),
        ({"image": "map.yaml"}, "image", "map.yaml"),
    ],
)
def test_invalid_maps_are_errors(
    tmp_path: Path, values: dict[str, Any], part: str, fact: str
) -> None:
    file = metadata(tmp_path, **values)
    with pytest.raises(MapError) as raised:
        read_map(file)
    assert raised.value.part == part
    assert fact in str(raised.value)


@pytest.mark.parametrize("text", ["image: [", "- 1", "image: map.pgm", "\0", "{}"])
def test_invalid_metadata_are_errors(tmp_path: Path, text: str) -> None:
    (tmp_path / "map.yaml").write_text(text)
    with pytest.raises(MapError) as raised:
        read_map(tmp_path / "map.yaml")
    assert raised.value.part == "metadata"


@pytest.mark.parametrize(
    ("content", "fact"),
    [
        (b"P5", "header"),
        (b"P5 2 x 255\n", "header"),
        (b"P5 2 2 255\n\x00", "expected 4 pixels, got 1"),
        (b"P5 2 2 0\n\x00\x00\x00\x00", "1 to 65535, got 0"),
        (b"P5 0 2 255\n", "0 x 2 pixels"),
        (b"P5 99999999 99999999 255\n", "limit is 67108864 pixels"),
        (b"P2 2 1 255\n1 x", "invalid pixels"),
        (b"P2 2 1 255\n1", "expected 2 pixels, got 1"),
        (b"P5" + b" " * 10_000 + b"2 2 255\n", "header"),
        (b"\x89PNG\r\n\x1a\n", "cannot identify image file"),
    ],
)
def test_invalid_images_are_errors(tmp_path: Path, content: bytes, fact: str) -> None:
    (tmp_path / "map.pgm").write_bytes(content)
    with pytest.raises(MapError, match=r"map\.pgm: ") as raised:
        read_image(tmp_path / "map.pgm")
    assert fact in str(raised.value)


def test_large_image_is_refused_before_it_is_decoded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pillow.new("L", (20, 20)).save(tmp_path / "a.png")
    monkeypatch.setattr(map_files, "MOST_CELLS", 399)
    with pytest.raises(MapError, match="20 x 20 pixels"):
        read_image(tmp_path / "a.png")


def test_written_map_is_read_again(tmp_path: Path) -> None:
    grid = GridMap(3, 2, 0.1, (1.0, -2.0, 0.0), array("b", [0, 100, -1, 25, 65, 40]))
    image, text = write_map(tmp_path / "out", grid)
    assert (image.name, text.name) == ("out.pgm", "out.yaml")
    # The bytes are map_saver's: occupied 0, free 254, unknown 205; the upper row is the first.
    assert image.read_bytes().endswith(b"\n3 2\n255\n" + bytes([254, 0, 205, 254, 0, 205]))
    found = read_map(text)
    assert found.cells.tolist() == [0, 100, -1, 0, 100, -1]
    assert (found.resolution, found.origin) == (0.1, (1.0, -2.0, 0.0))
    with pytest.raises(MapError, match="cannot write"):
        write_map(tmp_path / "none" / "out", grid)
