"""Maps of map_server: a file in YAML, which names an image of the cells.

Source: map_server of ROS Noetic, http://wiki.ros.org/map_server#Map_format.
"""

from __future__ import annotations

import math
import re
from array import array
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

from fibws.ros1.errors import MapError

MOST_CELLS = 2**26
"""Most cells of a map, each a byte."""
MOST_HEADER = 4096
"""Most bytes of a PGM file before its pixels."""
UNKNOWN = -1
OCCUPIED = 100
MODES = ("trinary", "scale", "raw")
FREE_PIXEL, OCCUPIED_PIXEL, UNKNOWN_PIXEL = 254, 0, 205
_PGM_TOKEN = re.compile(rb"(?:\s|#[^\n]*\n)*(\S+)")


@dataclass(frozen=True, slots=True)
class GridMap:
    """A grid of cells, each free (0) to occupied (100), or unknown (-1).

    Attributes:
        width: cells in a row.
        height: rows.
        resolution: the edge of a cell, in meters.
        origin: the pose of the lower left corner: x and y in meters, yaw in radians.
        cells: row by row, from the lower left corner on, as signed bytes.
    """

    width: int
    height: int
    resolution: float
    origin: tuple[float, float, float]
    cells: array[int]


@dataclass(frozen=True, slots=True)
class Metadata:
    """The content of a map's YAML file; ROS's documents explain the names."""

    image: Path
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str


@dataclass(frozen=True, slots=True)
class Image:
    """An image of 8 bits for each channel.

    Attributes:
        channels: the bytes of each channel, row by row from the top; with two or four channels, the
            last one is opacity.
    """

    width: int
    height: int
    channels: tuple[bytes, ...]


def read_map(file: Path) -> GridMap:
    """Read a map.

    Args:
        file: the YAML file; the image is relative to its folder.

    Raises:
        MapError: a file is missing or invalid; the text says which, and why.
    """
    metadata = read_metadata(file)
    image = read_image(metadata.image)
    return GridMap(
        image.width, image.height, metadata.resolution, metadata.origin, _cells(image, metadata)
    )


def read_metadata(file: Path) -> Metadata:
    """Read the YAML file of a map.

    Raises:
        MapError: it is missing or invalid.
    """
    import yaml

    content = _read(file)
    try:
        values = yaml.safe_load(content)
    except (yaml.YAMLError, ValueError) as error:
        text = " ".join(str(error).split())
        raise MapError("metadata", f"{file}: invalid YAML: {text}") from None
    fault = partial(_metadata_fault, file)
    if not isinstance(values, dict):
        raise fault(f"expected names with values, got {str(values)[:40]!r}")
    _check_metadata(values, fault)
    x, y, yaw = map(float, values["origin"])
    return Metadata(
        file.parent / values["image"],
        float(values["resolution"]),
        (x, y, yaw),
        bool(values["negate"]),
        float(values["occupied_thresh"]),
        float(values["free_thresh"]),
        values.get("mode", MODES[0]),
    )


def _check_metadata(values: dict[Any, Any], fault: Callable[[str], MapError]) -> None:
    missing = {"image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"} - {
        *values
    }
    if missing:
        raise fault(f"missing {', '.join(sorted(missing))}")
    origin = values["origin"]
    if not (isinstance(origin, list) and len(origin) == 3 and all(map(_is_number, origin))):
        raise fault(f"origin must be [x, y, yaw], got {origin!r}")
    for name in ("resolution", "occupied_thresh", "free_thresh"):
        if not _is_number(values[name]):
            raise fault(f"{name} must be a number, got {values[name]!r}")
    if values["resolution"] <= 0:
        raise fault(f"resolution must be > 0, got {values['resolution']}")
    mode = values.get("mode", MODES[0])
    if mode not in MODES:
        raise fault(f"mode must be {', '.join(MODES)}, got {mode!r}")
    if values["negate"] not in (0, 1):
        raise fault(f"negate must be 0 or 1, got {values['negate']!r}")
    if not (isinstance(values["image"], str) and values["image"]):
        raise fault("image must be the name of a file")


def read_image(file: Path) -> Image:
    """Read an image; formats other than PGM need Pillow.

    Raises:
        MapError: it is missing, invalid, too large, or Pillow is not installed.
    """
    content = _read(file)
    if content[:2] in (b"P2", b"P5"):
        return _read_pgm(file, content)
    return _read_by_pillow(file, content)


def write_map(
    name: Path, grid: GridMap, *, occupied: int = 65, free: int = 25
) -> tuple[Path, Path]:
    """Write a map as ``name.pgm`` and ``name.yaml``; return the two files.

    Args:
        occupied: cells of at least this value are written as occupied.
        free: cells of at most this value are written as free.

    Raises:
        MapError: a file cannot be written.
    """
    table = bytearray([UNKNOWN_PIXEL]) * 256
    for value in range(128):  # The other half are negative cells.
        if value <= free:
            table[value] = FREE_PIXEL
        elif value >= occupied:
            table[value] = OCCUPIED_PIXEL
    pixels = grid.cells.tobytes().translate(table)
    rows = [pixels[at : at + grid.width] for at in range(0, len(pixels), grid.width or 1)]
    image, metadata = (name.with_name(f"{name.name}.{suffix}") for suffix in ("pgm", "yaml"))
    head = f"P5\n# CREATOR: fibws map_saver {grid.resolution:.3f} m/pix\n"
    size = f"{grid.width} {grid.height}\n255\n"
    x, y, yaw = grid.origin
    text = (
        f"image: {image.name}\nresolution: {grid.resolution:f}\norigin: [{x:f}, {y:f}, {yaw:f}]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n\n"
    )
    try:
        image.write_bytes((head + size).encode() + b"".join(reversed(rows)))
        metadata.write_text(text)
    except OSError as error:
        raise MapError("file", f"cannot write {error.filename}: {error.strerror}") from None
    return image, metadata


def _read(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError as error:
        raise MapError("file", f"cannot read {file}: {error.strerror}") from None


def _metadata_fault(file: Path, text: str) -> MapError:
    return MapError("metadata", f"{file}: {text}")


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and type(value) is not bool and math.isfinite(value)


def _check_size(file: Path, width: int, height: int) -> None:
    if width <= 0 or height <= 0 or width * height > MOST_CELLS:
        fault = f"{width} x {height} pixels (limit is {MOST_CELLS} pixels)"
        raise MapError("image", f"{file}: {fault}")


def _read_pgm(file: Path, content: bytes) -> Image:
    """Read a PGM image (https://netpbm.sourceforge.net/doc/pgm.html)."""

    def tokens() -> Iterator[tuple[bytes, int]]:
        at = 0
        while found := _PGM_TOKEN.match(content, at, MOST_HEADER):
            yield found[1], found.end()
            at = found.end()

    try:
        (kind, _), (width, _), (height, _), (most, end) = islice(tokens(), 4)
        wide, high, largest = int(width), int(height), int(most)
    except ValueError:
        raise MapError("image", f"{file}: invalid header of a PGM image") from None
    _check_size(file, wide, high)
    if not 0 < largest < 65536:
        raise MapError("image", f"{file}: largest value must be 1 to 65535, got {largest}")
    count = wide * high
    values: bytes | array[int]
    if kind == b"P2":
        try:
            values = array("H", map(int, content[end:].split(maxsplit=count)[:count]))
        except (ValueError, OverflowError):
            raise MapError("image", f"{file}: invalid pixels") from None
    elif largest < 256:
        values = content[end + 1 : end + 1 + count]
    else:
        values = array("H", content[end + 1 : end + 1 + 2 * count][: 2 * count & ~1])
        values.byteswap()
    if len(values) != count:
        raise MapError("image", f"{file}: expected {count} pixels, got {len(values)}")
    if not isinstance(values, bytes) or largest != 255:
        values = bytes(min(255, value * 255 // largest) for value in values)
    return Image(wide, high, (values,))


def _read_by_pillow(file: Path, content: bytes) -> Image:
    from io import BytesIO

    try:
        from PIL import Image as pillow
    except ModuleNotFoundError:
        fault = "images other than PGM need Pillow; run pip install pillow"
        raise MapError("image", f"{file}: {fault}") from None
    try:
        with pillow.open(BytesIO(content)) as image:
            _check_size(file, *image.size)
            channels: tuple[bytes, ...]
            if image.mode == "I;16":
                channels = (image.tobytes()[1::2],)  # The higher byte of each pixel.
            else:
                has_alpha = "A" in image.getbands() or "transparency" in image.info
                mode = "RGBA" if has_alpha else "L" if image.mode in ("1", "L") else "RGB"
                channels = tuple(band.tobytes() for band in image.convert(mode).split())
            return Image(*image.size, channels)
    except (OSError, ValueError, SyntaxError, pillow.DecompressionBombError) as error:
        raise MapError("image", f"{file}: {error}") from None


def _cells(image: Image, metadata: Metadata) -> array[int]:
    """Return the cells that an image means, from the lower left corner on."""
    to_cell = _cell_of(metadata)
    has_alpha = len(image.channels) in (2, 4)
    if len(image.channels) == 1:
        table = bytes(to_cell(value, True) & 255 for value in range(256))
        found = image.channels[0].translate(table)
    else:
        # In ROS, opacity is one of the colors in mode trinary, and only there.
        count = len(image.channels) - (1 if has_alpha and metadata.mode != "trinary" else 0)
        known: dict[tuple[int, ...], int] = {}
        cells = bytearray()
        for pixel in zip(*image.channels, strict=True):
            cell = known.get(pixel)
            if cell is None:
                is_opaque = not has_alpha or pixel[-1] >= 1
                cell = to_cell(sum(pixel[:count]) / count, is_opaque) & 255
                known[pixel] = cell
            cells.append(cell)
        found = bytes(cells)
    width = image.width
    rows = [found[at : at + width] for at in range(0, len(found), width)]
    return array("b", b"".join(reversed(rows)))


def _cell_of(metadata: Metadata) -> Callable[[float, bool], int]:
    """Return what makes a cell from a pixel's color, 0 to 255, and whether it is opaque."""
    occupied, free, mode = metadata.occupied_thresh, metadata.free_thresh, metadata.mode

    def to_cell(color: float, is_opaque: bool) -> int:
        if metadata.negate:
            color = 255 - color
        if mode == "raw":
            return int(color)
        occupancy = (255 - color) / 255
        if occupancy > occupied:
            return OCCUPIED
        if occupancy < free:
            return 0
        if mode == "trinary" or not is_opaque:
            return UNKNOWN
        return int(1 + 98 * (occupancy - free) / (occupied - free))

    return to_cell
