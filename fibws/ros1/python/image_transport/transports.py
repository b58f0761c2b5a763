"""The transports of images: raw, compressed (JPEG or PNG) and compressedDepth (PNG).

A transport publishes an image of ``/camera/image`` on ``/camera/image/compressed``. Source: the
packages compressed_image_transport and compressed_depth_image_transport of ROS Noetic.
"""

from __future__ import annotations

import io
import struct
from typing import Any, NamedTuple

import numpy as np
from cv_bridge import CvBridge, CvBridgeError
from sensor_msgs.msg import CompressedImage, Image

TRANSPORTS = ("raw", "compressed", "compressedDepth")
_DEPTH_HEADER = struct.Struct("<iff")
"""The header before a depth's PNG: 0, and the two numbers of the quantization."""
_DEPTH_ENCODINGS = ("16UC1", "32FC1")
_MOST_PIXELS = 2**26


class Options(NamedTuple):
    """How images are compressed.

    Attributes:
        format: ``jpeg`` or ``png``.
        jpeg_quality: 1 to 100.
        png_level: 1 (fast) to 9 (small).
        depth_max: the greatest depth, in meters; greater ones are lost.
        depth_quantization: the depth at which the resolution is 1 m, as ROS's option of that name.
    """

    format: str = "jpeg"
    jpeg_quality: int = 80
    png_level: int = 3
    depth_max: float = 10.0
    depth_quantization: float = 100.0


def topic(base: str, transport: str) -> str:
    """Return the topic of a transport."""
    return base if transport == "raw" else f"{base}/{transport}"


def compress(image: Image, options: Options) -> CompressedImage:
    """Return an image as JPEG or PNG; more than 8 bits are kept by PNG alone.

    Raises:
        CvBridgeError: the encoding cannot be converted.
        TypeError: the image has fewer bytes than its size says.
    """
    array = CvBridge().imgmsg_to_cv2(image)
    is_grey = array.ndim < 3
    kind = options.format
    if array.dtype == np.uint16 and is_grey and kind == "png":
        picture, stored = array, ""
    elif array.dtype == np.uint16 and is_grey:
        picture, stored = (array >> 8).astype(np.uint8), ""
    elif is_grey and image.encoding in ("mono8", "8UC1"):
        picture, stored = array, ""
    else:
        picture, stored = CvBridge().imgmsg_to_cv2(image, "rgb8"), "bgr8"
    return CompressedImage(
        header=image.header,
        format=f"{image.encoding}; {kind} compressed {stored}",
        data=_write(picture, options),
    )


def decompress(message: CompressedImage) -> Image:
    """Return the image of a compressed one, in its encoding before if that is in its format.

    Raises:
        CvBridgeError: the data is not an image, or its encoding is unknown.
    """
    array = _read(bytes(message.data))
    own = "rgb8" if array.ndim == 3 else "mono16" if array.dtype == np.uint16 else "mono8"
    before, is_told, _ = message.format.partition(";")
    wanted = before.strip() if is_told else {"rgb8": "bgr8"}.get(own, own)
    bridge = CvBridge()
    if wanted in (own, "8UC1", "16UC1") and array.ndim < 3:
        return bridge.cv2_to_imgmsg(array, wanted, message.header)
    if wanted == "8UC3":
        return bridge.cv2_to_imgmsg(np.ascontiguousarray(array[..., ::-1]), wanted, message.header)
    raw = bridge.cv2_to_imgmsg(array, own)
    return bridge.cv2_to_imgmsg(bridge.imgmsg_to_cv2(raw, wanted), wanted, message.header)


def compress_depth(image: Image, options: Options) -> CompressedImage:
    """Return depths as PNG of 16 bits: millimeters as they are, meters as quantized inverses.

    Raises:
        CvBridgeError: it is not an image of depths.
    """
    if image.encoding not in _DEPTH_ENCODINGS:
        known = " or ".join(_DEPTH_ENCODINGS)
        raise CvBridgeError(f"compressedDepth needs the encoding {known}, got {image.encoding}")
    depths = CvBridge().imgmsg_to_cv2(image)
    a = b = 0.0
    if image.encoding == "32FC1":
        a = options.depth_quantization * (options.depth_quantization + 1)
        b = 1 - a / options.depth_max
        with np.errstate(divide="ignore", invalid="ignore"):
            is_known = (depths > 0) & (depths <= options.depth_max)
            numbers = np.clip(np.where(is_known, a / depths + b, 0), 0, 65535)
        depths = numbers.astype(np.uint16)
    return CompressedImage(
        header=image.header,
        format=f"{image.encoding}; compressedDepth png",
        data=_DEPTH_HEADER.pack(0, a, b) + _write(depths, options._replace(format="png")),
    )


def decompress_depth(message: CompressedImage) -> Image:
    """Return the depths of `compress_depth`; unknown ones are 0, or NaN for meters.

    Raises:
        CvBridgeError: the data is not an image of depths.
    """
    data = bytes(message.data)
    encoding = message.format.partition(";")[0].strip()
    if encoding not in _DEPTH_ENCODINGS or len(data) < _DEPTH_HEADER.size:
        known = " or ".join(f"{each}; compressedDepth" for each in _DEPTH_ENCODINGS)
        raise CvBridgeError(f"expected the format {known}, got {message.format!r}")
    _, a, b = _DEPTH_HEADER.unpack_from(data)
    numbers = _read(data[_DEPTH_HEADER.size :])
    if numbers.ndim != 2:
        raise CvBridgeError("expected one channel of depths, got colors")
    depths = numbers.astype(np.uint16)
    if encoding == "32FC1":
        with np.errstate(divide="ignore", invalid="ignore"):
            meters = a / (numbers.astype(np.float64) - b)
        depths = np.where(numbers == 0, np.nan, meters).astype(np.float32)
    return CvBridge().cv2_to_imgmsg(depths, encoding, message.header)


def _write(array: Any, options: Options) -> bytes:
    """Return an array of one channel, or of red, green and blue, as the bytes of a file."""
    pillow = _pillow()
    written = io.BytesIO()
    picture = pillow.fromarray(np.ascontiguousarray(array))
    if options.format == "png":
        picture.save(written, "PNG", compress_level=options.png_level)
    else:
        picture.save(written, "JPEG", quality=options.jpeg_quality)
    return written.getvalue()


def _read(data: bytes) -> Any:
    """Return the array of a file: of 8 or 16 bits of grey, or of red, green and blue.

    Raises:
        CvBridgeError: it is not an image, or too large.
    """
    pillow = _pillow()
    try:
        with pillow.open(io.BytesIO(data)) as picture:
            if picture.width * picture.height > _MOST_PIXELS:
                raise ValueError(f"limit is {_MOST_PIXELS} pixels")
            if picture.mode.startswith("I"):
                return np.asarray(picture).astype(np.uint16)
            mode = "L" if picture.mode in ("1", "L") else "RGB"
            return np.asarray(picture.convert(mode))
    except (OSError, ValueError, SyntaxError, pillow.DecompressionBombError) as error:
        raise CvBridgeError(f"the data is not an image that Pillow can read: {error}") from None


def _pillow() -> Any:
    try:
        from PIL import Image as pillow
    except ModuleNotFoundError as error:
        fault = "compressed images need Pillow: run pip install pillow"
        raise ModuleNotFoundError(fault, name=error.name) from None
    return pillow
