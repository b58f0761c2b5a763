"""`CvBridge`, between sensor_msgs' images and arrays."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header

from cv_bridge.encodings import DEPTH_OF_DTYPE, EncodingError, convert, encoding_of
from fibws.values.message_sizes import check_picture

_FIRST_DEPTHS = ("8U", "8S", "16U", "16S", "32S", "32F", "64F")
_PILLOW_MODES = {1: "L", 3: "RGB", 4: "RGBA"}


class CvBridgeError(TypeError):
    """An image cannot be converted."""


def getCvType(encoding: str) -> int:
    """Return OpenCV's number of an encoding's type: 16 for ``bgr8``.

    Raises:
        RuntimeError: the encoding is unknown.
    """
    try:
        return encoding_of(encoding).cv_type
    except EncodingError as error:
        raise RuntimeError(str(error)) from None


def cvtColor2(im: Any, encoding_in: str, encoding_out: str) -> Any:
    """Return an image in another encoding.

    Raises:
        RuntimeError: the conversion is not supported.
    """
    try:
        return convert(im, encoding_in, encoding_out)
    except EncodingError as error:
        raise RuntimeError(str(error)) from None


class CvBridge:
    """Converts images.

    Attributes:
        cvtype_to_name: OpenCV's names of its types, by their numbers: ``8UC3`` for 16.
        numpy_type_to_cvtype: OpenCV's depths, by the names of numpy's types.
    """

    def __init__(self) -> None:
        self.cvtype_to_name = {
            depth + ((channels - 1) << 3): f"{name}C{channels}"
            for depth, name in enumerate(_FIRST_DEPTHS)
            for channels in range(1, 5)
        }
        self.numpy_type_to_cvtype = dict(DEPTH_OF_DTYPE)

    def dtype_with_channels_to_cvtype2(self, dtype: Any, n_channels: int) -> str:
        """Return OpenCV's name of a type: ``8UC3``."""
        return f"{self.numpy_type_to_cvtype[np.dtype(dtype).name]}C{n_channels}"

    def cvtype2_to_dtype_with_channels(self, cvtype: int) -> tuple[str, int]:
        """Return the name of numpy's type and the channels of one of OpenCV's types."""
        encoding = encoding_of(f"{_FIRST_DEPTHS[cvtype & 7]}C{(cvtype >> 3) + 1}")
        return encoding.dtype, encoding.channels

    def encoding_to_cvtype2(self, encoding: str) -> int:
        """Return OpenCV's number of an encoding's type.

        Raises:
            CvBridgeError: the encoding is unknown.
        """
        try:
            return getCvType(encoding)
        except RuntimeError as error:
            raise CvBridgeError(error) from None

    def encoding_to_dtype_with_channels(self, encoding: str) -> tuple[str, int]:
        """Return the name of numpy's type and the channels of an encoding.

        Raises:
            CvBridgeError: the encoding is unknown.
        """
        return self.cvtype2_to_dtype_with_channels(self.encoding_to_cvtype2(encoding))

    def imgmsg_to_cv2(self, img_msg: Any, desired_encoding: str = "passthrough") -> Any:
        """Return the array of an image: height, width and, if there are several, channels.

        Args:
            img_msg: a sensor_msgs/Image.
            desired_encoding: the array's encoding; by default the image's own.

        Raises:
            CvBridgeError: an encoding is unknown, or the image cannot be converted.
            TypeError: the data has fewer bytes than the image's size says.
        """
        name, channels = self.encoding_to_dtype_with_channels(img_msg.encoding)
        dtype = np.dtype(name).newbyteorder(">" if img_msg.is_bigendian else "<")
        pixels = img_msg.step // (dtype.itemsize * channels)
        shape = (img_msg.height, pixels) if channels == 1 else (img_msg.height, pixels, channels)
        # Lines may be padded to a size that is not a whole number of pixels.
        strides = (img_msg.step, dtype.itemsize * channels, dtype.itemsize)[: len(shape)]
        data = img_msg.data if isinstance(img_msg.data, bytes) else bytes(img_msg.data)
        if not data and img_msg.height and pixels:  # numpy takes no bytes for any number.
            raise TypeError("buffer is too small for requested array")
        try:
            whole = np.ndarray(shape, dtype, data, strides=strides)
        except ValueError as error:
            raise TypeError(str(error)) from None
        image = np.ascontiguousarray(whole[:, : img_msg.width], dtype.newbyteorder("="))
        if desired_encoding == "passthrough":
            return image
        try:
            return cvtColor2(image, img_msg.encoding, desired_encoding)
        except RuntimeError as error:
            raise CvBridgeError(error) from None

    def cv2_to_imgmsg(
        self, cvim: Any, encoding: str = "passthrough", header: Header | None = None
    ) -> Image:
        """Return the sensor_msgs/Image of an array.

        Args:
            cvim: an array of height, width and, if there are several, channels.
            encoding: its encoding; by default OpenCV's name of its type, ``8UC3``.
            header: the image's header.

        Raises:
            CvBridgeError: the encoding is unknown, or does not fit the array.
            TypeError: it is not an array.
        """
        if not isinstance(cvim, np.ndarray | np.generic):
            raise TypeError("Your input type is not a numpy array")
        shape: tuple[int, ...] = cvim.shape
        channels = 1 if len(shape) < 3 else shape[2]
        cv_type = self.dtype_with_channels_to_cvtype2(cvim.dtype, channels)
        if encoding == "passthrough":
            encoding = cv_type
        elif (own := self.cvtype_to_name.get(self.encoding_to_cvtype2(encoding))) != cv_type:
            raise CvBridgeError(
                f"encoding specified as {encoding}, but image has incompatible type {cv_type}"
                if own
                else f"encoding {encoding} has too many channels"
            )
        message = Image(header=header) if header is not None else Image()
        message.height, message.width = shape[:2]
        message.encoding = encoding
        if cvim.dtype.byteorder == ">":
            message.is_bigendian = True
        message.data = cvim.tobytes()
        message.step = len(message.data) // message.height if message.height else 0
        return message

    def compressed_imgmsg_to_cv2(
        self, cmprs_img_msg: Any, desired_encoding: str = "passthrough"
    ) -> Any:
        """Return the array of a compressed image, in the order blue, green, red.

        Args:
            cmprs_img_msg: a sensor_msgs/CompressedImage.
            desired_encoding: the array's encoding.

        Raises:
            CvBridgeError: the image is invalid, or cannot be converted.
            ModuleNotFoundError: neither OpenCV nor Pillow is installed.
        """
        image = _decoded(bytes(cmprs_img_msg.data))
        if desired_encoding == "passthrough":
            return image
        source = "mono8" if image.ndim < 3 else "bgr8"
        try:
            return cvtColor2(image, source, desired_encoding)
        except RuntimeError as error:
            raise CvBridgeError(error) from None

    def cv2_to_compressed_imgmsg(self, cvim: Any, dst_format: str = "jpg") -> CompressedImage:
        """Return the sensor_msgs/CompressedImage of an array in the order blue, green, red.

        Args:
            cvim: the array.
            dst_format: the suffix of a file in the image's format: ``jpg``, ``png``.

        Raises:
            TypeError: it is not an array.
            CvBridgeError: the format is unknown, or does not fit the array.
            ModuleNotFoundError: neither OpenCV nor Pillow is installed.
        """
        if not isinstance(cvim, np.ndarray | np.generic):
            raise TypeError("Your input type is not a numpy array")
        return CompressedImage(format=dst_format, data=_encoded(np.asarray(cvim), dst_format))


def _decoded(data: bytes) -> Any:
    try:
        check_picture(data)
    except ValueError as error:
        raise CvBridgeError(f"the data is not an image that can be read: {error}") from None
    try:
        import cv2
    except ModuleNotFoundError:
        pass
    else:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_ANYCOLOR)
        if image is None:
            raise CvBridgeError("the data is not an image that OpenCV can read")
        return image
    pillow = _pillow()
    try:
        with pillow.open(io.BytesIO(data)) as picture:
            if picture.mode in ("1", "L"):
                return np.asarray(picture.convert("L"))
            return np.ascontiguousarray(np.asarray(picture.convert("RGB"))[..., ::-1])
    except (OSError, ValueError, pillow.DecompressionBombError) as error:
        raise CvBridgeError(f"the data is not an image that Pillow can read: {error}") from None


def _encoded(image: Any, suffix: str) -> bytes:
    try:
        import cv2
    except ModuleNotFoundError:
        pass
    else:
        try:
            return bytes(cv2.imencode(f".{suffix}", image)[1].tobytes())
        except cv2.error as error:
            raise CvBridgeError(str(error)) from None
    pillow = _pillow()
    channels = 1 if image.ndim < 3 else image.shape[2]
    mode = _PILLOW_MODES.get(channels)
    if mode is None or image.dtype != np.uint8:
        raise CvBridgeError(
            f"expected 8 bits and 1, 3 or 4 channels, got {image.dtype}, {channels}"
        )
    if channels >= 3:
        image = image[..., [2, 1, 0, *range(3, channels)]]
    if channels == 4 and suffix in ("jpg", "jpeg"):
        image, mode = image[..., :3], "RGB"
    written = io.BytesIO()
    kind = pillow.registered_extensions().get(f".{suffix}")
    if kind is None:
        raise CvBridgeError(f"unknown format {suffix!r}; jpg and png are two")
    pillow.fromarray(np.ascontiguousarray(image), mode).save(written, kind)
    return written.getvalue()


def _pillow() -> Any:
    try:
        from PIL import Image as pillow
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            "compressed images need OpenCV or Pillow: run pip install opencv-python-headless, or "
            "pip install pillow",
            name=error.name,
        ) from None
    return pillow
