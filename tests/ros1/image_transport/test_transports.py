"""Images that are compressed, and decompressed again."""

from __future__ import annotations

import numpy as np
import pytest
from cv_bridge import CvBridge, CvBridgeError
from image_transport.transports import (
    Options,
    compress,
    compress_depth,
    decompress,
    decompress_depth,
    topic,
)
from sensor_msgs.msg import CompressedImage, Image

BRIDGE = CvBridge()
PNG = Options(format="png")


def image(encoding: str, dtype: str = "uint8", channels: int = 1) -> Image:
    numbers = np.arange(4 * 6 * channels).reshape((4, 6, channels)[: 2 if channels == 1 else 3])
    message = BRIDGE.cv2_to_imgmsg((numbers * 3).astype(dtype), encoding)
    message.header.frame_id = "camera"
    return message


def test_topics_have_the_name_of_the_transport() -> None:
    assert topic("/a", "raw") == "/a"
    assert topic("/a", "compressed") == "/a/compressed"


@pytest.mark.parametrize(
    ("encoding", "dtype", "channels", "stored"),
    [
        ("mono8", "uint8", 1, ""),
        ("8UC1", "uint8", 1, ""),
        ("mono16", "uint16", 1, ""),
        ("rgb8", "uint8", 3, "bgr8"),
        ("bgr8", "uint8", 3, "bgr8"),
        ("8UC3", "uint8", 3, "bgr8"),
    ],
)
def test_png_keeps_all_of_an_image(encoding: str, dtype: str, channels: int, stored: str) -> None:
    before = image(encoding, dtype, channels)
    if encoding == "8UC3":  # OpenCV's name of a type says nothing of the colors.
        before.encoding = "bgr8"
    compressed = compress(before, PNG)
    assert compressed.format == f"{before.encoding}; png compressed {stored}"
    after = decompress(compressed)
    assert after.header.frame_id == "camera"
    assert (after.encoding, after.width, after.height) == (before.encoding, 6, 4)
    assert after.data == before.data


def test_jpeg_is_close_to_the_image() -> None:
    before = image("rgb8", channels=3)
    after = decompress(compress(before, Options(jpeg_quality=95)))
    difference = np.abs(np.array(list(before.data)) - np.array(list(after.data)))
    assert after.encoding == "rgb8"
    assert difference.mean() < 6
    small, large = (len(compress(before, Options(jpeg_quality=each)).data) for each in (5, 95))
    assert small < large


def test_jpeg_of_16_bits_has_the_higher_8() -> None:
    before = BRIDGE.cv2_to_imgmsg(np.full((8, 8), 0x80FF, np.uint16), "mono16")
    compressed = compress(before, Options())
    compressed.format = "jpeg"
    assert decompress(compressed).data == bytes([0x80]) * 64


def test_format_may_say_nothing_of_the_encoding() -> None:
    compressed = compress(image("rgb8", channels=3), PNG)
    compressed.format = "png"
    assert decompress(compressed).encoding == "bgr8"


def test_depths_in_millimeters_are_exact() -> None:
    before = image("16UC1", "uint16")
    compressed = compress_depth(before, Options())
    assert compressed.format == "16UC1; compressedDepth png"
    assert compressed.data[12:16] == b"\x89PNG"
    assert decompress_depth(compressed).data == before.data


def test_depths_in_meters_are_close() -> None:
    depths = np.array([[0.5, 1.0, 9.9], [0.0, np.nan, 20.0]], np.float32)
    compressed = compress_depth(BRIDGE.cv2_to_imgmsg(depths, "32FC1"), Options())
    after = BRIDGE.imgmsg_to_cv2(decompress_depth(compressed))
    assert after[0] == pytest.approx(depths[0], rel=0.01)
    assert np.isnan(after[1]).all()


@pytest.mark.parametrize(
    ("format_", "data", "fact"),
    [
        ("rgb8; jpeg compressed bgr8", b"", "not an image"),
        ("rgb8; jpeg compressed bgr8", b"\xff\xd8\xff", "not an image"),
        ("xyz8; png compressed ", None, "xyz8"),
    ],
)
def test_invalid_images_are_errors(format_: str, data: bytes | None, fact: str) -> None:
    valid = compress(image("mono8"), PNG).data
    with pytest.raises(CvBridgeError, match=fact):
        decompress(CompressedImage(format=format_, data=valid if data is None else data))


@pytest.mark.parametrize("data", [b"", b"123456789012", b"12345678901"])
def test_invalid_depths_are_errors(data: bytes) -> None:
    with pytest.raises(CvBridgeError):
        decompress_depth(CompressedImage(format="16UC1; compressedDepth png", data=data))
    with pytest.raises(CvBridgeError, match="16UC1 or 32FC1"):
        compress_depth(image("mono8"), Options())
    with pytest.raises(CvBridgeError, match="expected the format"):
        decompress_depth(CompressedImage(format="png", data=b"x" * 20))
