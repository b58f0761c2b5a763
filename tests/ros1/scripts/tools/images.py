#!/usr/bin/env python3
"""Images to arrays and back, in all encodings."""
import hashlib

import numpy as np
from cv_bridge import CvBridge, CvBridgeError
from sensor_msgs.msg import Image
from std_msgs.msg import Header

COLORS = [each + bits for each in ("mono", "rgb", "bgr", "rgba", "bgra") for bits in ("8", "16")]
BAYERS = ["bayer_rggb8", "bayer_bggr16", "yuv422"]
GENERIC = ["8UC1", "8UC3", "8SC2", "16UC1", "16SC4", "32SC1", "32FC1", "64FC3", "32FC7", "8U"]
BAD = ["", "rgb", "9UC1", "bgr32", "8uc1"]
bridge = CvBridge()
chance = np.random.RandomState(7)


def show(value):
    if isinstance(value, np.ndarray):
        digest = hashlib.md5(np.ascontiguousarray(value).tobytes()).hexdigest()[:12]
        return "%s %s %s" % (value.dtype.name, value.shape, digest)
    return value


def attempt(title, function, *args):
    try:
        print(title, show(function(*args)), flush=True)
    except CvBridgeError as error:
        print(title, "CvBridgeError", error, flush=True)
    except Exception as error:
        print(title, type(error).__name__, flush=True)


def image_of(encoding, big=False):
    name, channels = bridge.encoding_to_dtype_with_channels(encoding)
    size = np.dtype(name).itemsize * channels
    rows = chance.randint(0, 256, (6, 8 * size)).astype(np.uint8)
    if "F" in encoding:
        rows = (chance.rand(6, 8, channels) * 99).astype(name).view(np.uint8).reshape(6, -1)
    data = rows.tobytes()
    return Image(Header(), 6, 8, encoding, int(big), rows.shape[1], data)


for encoding in COLORS + BAYERS + GENERIC + BAD:
    attempt(encoding, bridge.encoding_to_cvtype2, encoding)
    attempt(encoding, bridge.encoding_to_dtype_with_channels, encoding)
for encoding in COLORS + BAYERS + GENERIC[:-1]:
    attempt(encoding, bridge.imgmsg_to_cv2, image_of(encoding))
for source in COLORS + ["8UC3", "16UC1", "32FC1"]:
    for target in COLORS + ["8UC3", "16UC1", "32FC1", "bayer_rggb8", "nothing"]:
        message = image_of(source)
        attempt(source + " to " + target, bridge.imgmsg_to_cv2, message, target)
attempt("big", bridge.imgmsg_to_cv2, image_of("mono16", big=True))
attempt("big", bridge.imgmsg_to_cv2, image_of("mono16", big=True), "mono8")
attempt("cut", bridge.imgmsg_to_cv2, Image(Header(), 6, 8, "rgb8", 0, 24, b"12"))
for shape, dtype, encoding in (
    ((4, 5, 3), "uint8", "bgr8"),
    ((4, 5, 3), "uint8", "passthrough"),
    ((4, 5), "uint16", "mono16"),
    ((4, 5), "float32", "32FC1"),
    ((4, 5), "float32", "mono8"),
    ((4, 5, 4), "uint8", "rgb8"),
    ((4, 5, 1), "uint8", "mono8"),
    ((4, 5), ">u2", "mono16"),
):
    array = (chance.rand(*shape) * 200).astype(dtype)
    try:
        message = bridge.cv2_to_imgmsg(array, encoding, Header(frame_id="camera"))
    except CvBridgeError as error:
        print("CvBridgeError", error)
        continue
    print(message.encoding, message.height, message.width, message.step, message.is_bigendian)
    print(hashlib.md5(message.data).hexdigest(), message.header.frame_id)
attempt("list", bridge.cv2_to_imgmsg, [[1, 2]])
print(bridge.cvtype_to_name[16], bridge.numpy_type_to_cvtype["uint8"])
print(bridge.dtype_with_channels_to_cvtype2(np.dtype("int16"), 2))
print(bridge.cvtype2_to_dtype_with_channels(bridge.encoding_to_cvtype2("bgra16")))
