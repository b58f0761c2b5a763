"""The encodings of images, and the conversion of colours between them.

Sources: sensor_msgs/image_encodings.h and cv_bridge of ROS Noetic; colours as OpenCV converts them.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

import numpy as np

_DEPTHS = {
    "8U": ("uint8", 0),
    "8S": ("int8", 1),
    "16U": ("uint16", 2),
    "16S": ("int16", 3),
    "32S": ("int32", 4),
    "32F": ("float32", 5),
    "64F": ("float64", 6),
}
"""The depths of OpenCV: numpy's type and OpenCV's number of each."""
DEPTH_OF_DTYPE = {dtype: depth for depth, (dtype, _) in _DEPTHS.items()}
_GENERIC = re.compile(r"(8U|8S|16U|16S|32S|32F|64F)(?:C([0-9]+))?")
_COLOR = re.compile(r"(mono|rgba?|bgra?)(8|16)")
_BAYER = re.compile(r"bayer_(rggb|bggr|gbrg|grbg)(8|16)")
_CHANNELS = {"mono": 1, "rgb": 3, "bgr": 3, "rgba": 4, "bgra": 4}
_YUV = {"yuv422": 2, "yuv422_yuy2": 2}
_GRAY_WEIGHTS = {"r": 9798, "g": 19235, "b": 3735}
"""The weights of OpenCV for grey, in 2**15ths: ITU-R BT.601."""
_GRAY_BITS = 15
MOST_CHANNELS = 512
"""As in OpenCV: CV_CN_MAX."""


class EncodingError(ValueError):
    """An encoding is unknown, or cannot be converted into another."""


class Encoding(NamedTuple):
    """The parts of an encoding."""

    name: str
    depth: str
    """OpenCV's: ``8U``."""
    channels: int
    color: str
    """The order of its channels, such as ``bgr``; ``mono``, ``bayer``, ``yuv``; empty for none."""

    @property
    def dtype(self) -> str:
        """The name of numpy's type."""
        return _DEPTHS[self.depth][0]

    @property
    def cv_type(self) -> int:
        """OpenCV's number of the type: ``CV_8UC3`` is 16."""
        return _DEPTHS[self.depth][1] + ((self.channels - 1) << 3)

    @property
    def cv_name(self) -> str:
        """OpenCV's name of the type, without CV_: ``8UC3``."""
        return f"{self.depth}C{self.channels}"


def encoding_of(name: str) -> Encoding:
    """Return what an encoding means.

    Raises:
        EncodingError: it is unknown.
    """
    if found := _COLOR.fullmatch(name):
        return Encoding(name, f"{found[2]}U", _CHANNELS[found[1]], found[1])
    if found := _BAYER.fullmatch(name):
        return Encoding(name, f"{found[2]}U", 1, "bayer")
    if name in _YUV:
        return Encoding(name, "8U", _YUV[name], "yuv")
    found = _GENERIC.fullmatch(name)
    channels = int(found[2] or 1) if found and len(found[2] or "") < 4 else 0
    if found is None or not 0 < channels <= MOST_CHANNELS:
        raise EncodingError(f"Unrecognized image encoding [{name}]")
    return Encoding(name, found[1], channels, "")


def convert(image: Any, source: str, target: str) -> Any:
    """Return an image in another encoding.

    Args:
        image: an array of height, width and, for more than one, channels.
        source: its encoding.
        target: the other encoding.

    Raises:
        EncodingError: one is unknown, or the conversion is not supported.
    """
    if source == target:
        return image
    old = encoding_of(source)
    try:
        new = encoding_of(target)
    except EncodingError:
        raise EncodingError(f"Unknown encoding {target}") from None
    if not (old.color and new.color):
        _check_numbers(old, new)
        return _with_depth(image, old, new)
    if old.color == new.color and old.color not in ("bayer", "yuv"):
        return _with_depth(image, old, new)
    if new.color in ("bayer", "yuv"):
        raise EncodingError(f"Unsupported conversion from [{source}] to [{target}]")
    if (old.color, new.color) == ("yuv", "mono"):
        brightness = image[..., 0 if old.name.endswith("yuy2") else 1]
        return convert(np.ascontiguousarray(brightness), "mono8", new.name)
    if old.color in ("bayer", "yuv"):
        return _by_opencv(image, old, new)
    return _with_depth(_with_color(image, old.color, new.color), old, new)


def _check_numbers(old: Encoding, new: Encoding) -> None:
    """Raise `EncodingError` if images cannot be converted that have no color in one encoding."""
    if new.color:
        raise EncodingError(
            f"[{old.name}] is not a color format. but [{new.name}] is. "
            "The conversion does not make sense"
        )
    if old.channels == new.channels:
        return
    if old.color:
        raise EncodingError(
            f"[{old.name}] is a color format but [{new.name}] "
            "is not so they must have the same OpenCV type, CV_8UC3, CV16UC1 ...."
        )
    raise EncodingError(f"[{old.name}] and [{new.name}] do not have the same number of channel")


def _with_color(image: Any, old: str, new: str) -> Any:
    """Return an image with its channels in another order."""
    if old == "mono":
        channels = {each: image for each in "rgb"}
    else:
        channels = {each: image[..., index] for index, each in enumerate(old)}
    if new == "mono":
        weighted = sum(channels[each].astype(np.uint32) * _GRAY_WEIGHTS[each] for each in "rgb")
        return ((weighted + (1 << (_GRAY_BITS - 1))) >> _GRAY_BITS).astype(image.dtype)
    channels.setdefault("a", np.full_like(channels["r"], np.iinfo(image.dtype).max))
    return np.stack([channels[each] for each in new], axis=-1)


def _with_depth(image: Any, old: Encoding, new: Encoding) -> Any:
    """Return an image with numbers of another type; 8 and 16 bits are scaled, as in cv_bridge."""
    if old.depth == new.depth:
        return image
    sizes = (old.depth[:-1], new.depth[:-1])
    factor = {("8", "16"): 65535 / 255, ("16", "8"): 255 / 65535}.get(sizes, 1.0)
    scaled = image * np.float32(factor) if factor != 1.0 else image
    kind = np.dtype(new.dtype)
    if kind.kind == "f":
        return scaled.astype(kind)
    limits = np.iinfo(kind)
    return np.clip(np.rint(scaled), limits.min, limits.max).astype(kind)


def _by_opencv(image: Any, old: Encoding, new: Encoding) -> Any:
    """Convert raw pixels of a sensor, or YUV, which is OpenCV's work."""
    try:
        import cv2
    except ModuleNotFoundError:
        raise EncodingError(
            f"the conversion from [{old.name}] needs OpenCV: pip install opencv-python-headless"
        ) from None
    made = ("mono", "GRAY") if new.color == "mono" else ("bgr", "BGR")
    if old.color == "yuv":
        code = f"COLOR_YUV2BGR_{'YUY2' if old.name.endswith('yuy2') else 'UYVY'}"
    else:
        # OpenCV names the second row and column, sensors the first. Grey is made at once, as in
        # cv_bridge, since colors in between would round it twice.
        pattern = {"rggb": "BG", "bggr": "RG", "gbrg": "GR", "grbg": "GB"}[old.name[6:10]]
        code = f"COLOR_Bayer{pattern}2{made[1]}"
    converted = cv2.cvtColor(image, getattr(cv2, code))
    return convert(converted, f"{made[0]}{old.depth[:-1]}", new.name)
