"""Images: an array of height, width and, if there are several, channels."""

from __future__ import annotations

from typing import Any

import numpy as np
from cv_bridge import CvBridge, CvBridgeError
from sensor_msgs.msg import Image

from ros_numpy.registry import converts_from_numpy, converts_to_numpy


@converts_to_numpy(Image)
def image_to_numpy(msg: Image) -> Any:
    """Return the array of an image, in its own encoding.

    Raises:
        ValueError: the encoding is unknown, or the data has fewer bytes than the size says.
    """
    try:
        return CvBridge().imgmsg_to_cv2(msg)
    except TypeError as error:  # A CvBridgeError is one.
        raise ValueError(str(error)) from None


@converts_from_numpy(Image)
def numpy_to_image(arr: Any, encoding: str) -> Image:
    """Return the image of an array.

    Raises:
        ValueError: the encoding is unknown, or does not fit the array.
    """
    try:
        return CvBridge().cv2_to_imgmsg(np.asarray(arr), encoding)
    except CvBridgeError as error:
        raise ValueError(str(error)) from None
