"""Padded, swapped, cut and compressed images; all encodings are compared with ROS side by side."""

from __future__ import annotations

import importlib.util
import sys

import numpy as np
import pytest
from cv_bridge import CvBridge, CvBridgeError
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header

bridge = CvBridge()
RED = np.zeros((4, 6, 3), np.uint8)
RED[..., 2] = 250  # In OpenCV's order: blue, green, red.


def test_padding_of_lines_is_left_out() -> None:
    data = b"".join(bytes([row, row, row, 99, 99]) for row in range(2))
    image = bridge.imgmsg_to_cv2(Image(Header(), 2, 1, "rgb8", 0, 5, data))
    assert image.tolist() == [[[0, 0, 0]], [[1, 1, 1]]]
    assert image.flags["C_CONTIGUOUS"]


def test_big_numbers_are_swapped() -> None:
    image = bridge.imgmsg_to_cv2(Image(Header(), 1, 2, "mono16", 1, 4, b"\x01\x02\x03\x04"))
    assert image.tolist() == [[0x0102, 0x0304]]
    assert image.dtype.isnative


def test_image_without_lines_is_empty() -> None:
    assert bridge.imgmsg_to_cv2(Image(encoding="bgr8")).shape == (0, 0, 3)
    assert bridge.cv2_to_imgmsg(np.zeros((0, 5), np.uint8)).step == 0


@pytest.mark.parametrize(("step", "data"), [(18, b"short"), (2**31, b""), (1, bytes(72))])
def test_data_that_does_not_fit_is_an_error(step: int, data: bytes) -> None:
    message = Image(Header(), 4, 6, "rgb8", 0, step, data)
    if step == 1:
        assert bridge.imgmsg_to_cv2(message).shape == (4, 0, 3)
        return
    with pytest.raises(TypeError):
        bridge.imgmsg_to_cv2(message)


def test_raw_pixels_of_sensors_need_opencv() -> None:
    if importlib.util.find_spec("cv2") is not None:
        pytest.skip("OpenCV is installed")
    message = Image(Header(), 2, 2, "bayer_rggb8", 0, 2, bytes(4))
    with pytest.raises(CvBridgeError, match="pip install opencv-python-headless"):
        bridge.imgmsg_to_cv2(message, "bgr8")


@pytest.mark.parametrize("kind", ["png", "jpg"])
def test_compressed_image_is_read_again(kind: str) -> None:
    pytest.importorskip("PIL")
    message = bridge.cv2_to_compressed_imgmsg(RED, kind)
    assert message.format == kind
    image = bridge.compressed_imgmsg_to_cv2(message)
    assert image.shape == RED.shape
    assert np.abs(image.astype(int) - RED).max() <= (0 if kind == "png" else 5)
    assert bridge.compressed_imgmsg_to_cv2(message, "mono8").shape == (4, 6)
    gray = bridge.cv2_to_compressed_imgmsg(RED[..., 2], kind)
    assert bridge.compressed_imgmsg_to_cv2(gray).shape == (4, 6)


def test_invalid_compressed_images_are_errors() -> None:
    pytest.importorskip("PIL")
    with pytest.raises(CvBridgeError):
        bridge.compressed_imgmsg_to_cv2(CompressedImage(data=b"no image"))
    with pytest.raises(CvBridgeError):
        bridge.cv2_to_compressed_imgmsg(RED, "nothing")
    with pytest.raises(CvBridgeError):
        bridge.cv2_to_compressed_imgmsg(np.zeros((2, 2, 7), np.uint8))


@pytest.mark.parametrize(("encoding", "brightness"), [("yuv422", 1), ("yuv422_yuy2", 0)])
def test_gray_of_yuv_is_its_brightness(encoding: str, brightness: int) -> None:
    pixels = np.arange(16, dtype=np.uint8).reshape(2, 4, 2)
    message = Image(height=2, width=4, encoding=encoding, step=8, data=pixels.tobytes())
    found = bridge.imgmsg_to_cv2(message, "mono8")
    assert (found == pixels[..., brightness]).all()
    assert bridge.imgmsg_to_cv2(message, "mono16")[0, 0] == round(int(found[0, 0]) * 257)


def test_gray_of_raw_pixels_is_not_rounded_twice() -> None:
    cv2 = pytest.importorskip("cv2")
    pixels = np.random.RandomState(1).randint(0, 255, (8, 8)).astype(np.uint8)
    message = Image(height=8, width=8, encoding="bayer_rggb8", step=8, data=pixels.tobytes())
    found = bridge.imgmsg_to_cv2(message, "mono8")
    assert (found == cv2.cvtColor(pixels, cv2.COLOR_BayerBG2GRAY)).all()


def test_picture_that_claims_too_many_pixels_is_not_decoded() -> None:
    data = b"\xff\xd8\xff\xc0\0\x11\x08\xff\xff\xff\xff" + bytes(50)
    with pytest.raises(CvBridgeError, match="65535 x 65535 pixels are too many"):
        bridge.compressed_imgmsg_to_cv2(CompressedImage(data=data))


def test_without_libraries_the_error_names_both(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cv2", None)
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(ModuleNotFoundError, match=r"opencv-python-headless.*pillow"):
        bridge.compressed_imgmsg_to_cv2(CompressedImage(data=b""))


@pytest.mark.parametrize("data", [b"", bytes(5)])
def test_image_with_too_few_bytes_is_an_error(data: bytes) -> None:
    image = Image(height=2, width=3, step=3, encoding="mono8", data=data)
    with pytest.raises(TypeError):
        CvBridge().imgmsg_to_cv2(image)
