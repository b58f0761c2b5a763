"""Images as numpy's arrays, which OpenCV takes: http://wiki.ros.org/cv_bridge.

It needs numpy, and OpenCV or Pillow only for compressed images.
"""

from cv_bridge.core import CvBridge, CvBridgeError, cvtColor2, getCvType

__all__ = ["CvBridge", "CvBridgeError", "cvtColor2", "getCvType"]
