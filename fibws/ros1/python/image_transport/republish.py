"""republish: publishes images of one transport in others.

Source: image_transport of ROS Noetic, http://wiki.ros.org/image_transport#republish.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from typing import Any, NoReturn

import rospy
from sensor_msgs.msg import CompressedImage, Image

from fibws.suggestions import suggestion
from image_transport import transports
from image_transport.transports import TRANSPORTS, Options

USAGE = "usage: republish IN_TRANSPORT in:=TOPIC [OUT_TRANSPORT] out:=TOPIC"
_FORMATS = ("jpeg", "png")


class Republisher:
    """Publishes images again.

    It subscribes only while its output has subscribers, as ROS's program does.

    Args:
        source: the transport that images come in.
        outputs: the transports that they are published in.
    """

    def __init__(self, source: str, outputs: list[str]) -> None:
        self._source = source
        self._in = transports.topic(rospy.resolve_name("in"), source)
        base = rospy.resolve_name("out")
        self._options = _options(base)
        listener = _Listener(self._changed)
        self._lock = threading.Lock()
        self._subscriber: rospy.Subscriber | None = None
        self._publishers: dict[str, rospy.Publisher] = {}
        for output in outputs:
            publisher = rospy.Publisher(
                transports.topic(base, output),
                _class(output),
                subscriber_listener=listener,
                queue_size=1,
            )
            with self._lock:
                self._publishers[output] = publisher
        self._changed()  # Subscribers may have come before all publishers were there.

    def _changed(self) -> None:
        with self._lock:
            is_wanted = any(each.get_num_connections() for each in self._publishers.values())
            if is_wanted and self._subscriber is None:
                self._subscriber = rospy.Subscriber(
                    self._in, _class(self._source), self._receive, queue_size=1
                )
            elif not is_wanted and self._subscriber is not None:
                self._subscriber.unregister()
                self._subscriber = None

    def _receive(self, message: Any) -> None:
        wanted = {
            name: each for name, each in self._publishers.items() if each.get_num_connections()
        }
        try:
            if self._source in wanted:
                wanted.pop(self._source).publish(message)
            if not wanted:
                return
            if self._source == "compressed":
                image = transports.decompress(message)
            elif self._source == "compressedDepth":
                image = transports.decompress_depth(message)
            else:
                image = message
            for name, publisher in wanted.items():
                publisher.publish(self._converted(image, name))
        except (TypeError, ModuleNotFoundError) as error:  # A CvBridgeError is a TypeError.
            rospy.logerr_throttle(10, f"{self._in}: {error}")

    def _converted(self, image: Image, transport: str) -> Any:
        if transport == "compressed":
            return transports.compress(image, self._options)
        if transport == "compressedDepth":
            return transports.compress_depth(image, self._options)
        return image


class _Listener(rospy.SubscribeListener):
    """Calls a function when subscribers come and leave."""

    def __init__(self, changed: Callable[[], None]) -> None:
        super().__init__()
        self._changed = changed

    def peer_subscribe(self, *args: Any) -> None:
        self._changed()

    def peer_unsubscribe(self, *args: Any) -> None:
        self._changed()


def _class(transport: str) -> type[Any]:
    found: type[Any] = Image if transport == "raw" else CompressedImage
    return found


def _options(base: str) -> Options:
    """Return the parameters of the output, under ROS's names: ``/out/compressed/jpeg_quality``."""
    limits = {"jpeg_quality": (1, 100), "png_level": (1, 9)}
    found: dict[str, Any] = {}
    for name, (least, most) in limits.items():
        value = rospy.get_param(f"{base}/compressed/{name}", None)
        if value is None:
            continue
        if type(value) is not int or not least <= value <= most:
            _fail(f"{base}/compressed/{name} must be {least} to {most}, got {value!r}")
        found[name] = value
    kind = rospy.get_param(f"{base}/compressed/format", _FORMATS[0])
    if kind not in _FORMATS:
        _fail(f"{base}/compressed/format must be {' or '.join(_FORMATS)}, got {kind!r}")
    for name in ("depth_max", "depth_quantization"):
        value = rospy.get_param(f"{base}/compressedDepth/{name}", None)
        if value is not None:
            if not isinstance(value, int | float) or value <= 0:
                _fail(f"{base}/compressedDepth/{name} must be > 0, got {value!r}")
            found[name] = float(value)
    return Options(format=kind, **found)


def _fail(fault: str) -> NoReturn:
    sys.stderr.write(f"republish: {fault}\n")
    sys.exit(1)


def main() -> None:
    """Run the program until the node ends."""
    words = rospy.myargv()[1:]
    if not 1 <= len(words) <= 2:
        sys.exit(USAGE)
    for word in words:
        if word not in TRANSPORTS:
            known = ", ".join(TRANSPORTS)
            _fail(f"unknown transport {word!r}{suggestion(word, TRANSPORTS)}; known are {known}")
    rospy.init_node("image_republisher", anonymous=True)
    if words[1:]:
        outputs = words[1:]
    else:
        outputs = [each for each in TRANSPORTS if each != "compressedDepth"]
    republisher = Republisher(words[0], outputs)
    rospy.spin()
    del republisher


if __name__ == "__main__":
    main()
