#!/usr/bin/env python3
"""Calls a service with numbers and bytes that JSON has no values for."""

import struct

import rospy
from sensor_msgs.srv import SetCameraInfo, SetCameraInfoRequest, SetCameraInfoResponse

rospy.init_node("exact_services")
ODD_NAN = struct.unpack("<d", struct.pack("<Q", 0x7FF8000000000123))[0]


def bits(numbers):
    return [struct.pack(">d", each).hex() for each in numbers]


def set_info(request):
    info = request.camera_info
    print(bits(info.D), bits(info.K[:3]), info.header.stamp, repr(info.distortion_model))
    return SetCameraInfoResponse(True, info.header.frame_id)


rospy.Service("set_info", SetCameraInfo, set_info)
rospy.wait_for_service("set_info")
request = SetCameraInfoRequest()
info = request.camera_info
info.D = float("inf"), -float("inf"), ODD_NAN, -0.0, 5e-324
info.K = [float("nan"), -float("nan"), 0.1] * 3
info.header.stamp = rospy.Time(2**32 - 1, 999999999)
info.header.frame_id = "ü\U0001f600\0"
info.distortion_model = "\0\x7f"
response = rospy.ServiceProxy("set_info", SetCameraInfo)(request)
print(response.success, repr(response.status_message))
