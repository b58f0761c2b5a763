#!/usr/bin/env python3
import zlib

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image


def callback(data):
    im = np.frombuffer(data.data, dtype=np.uint8).reshape(data.height, data.width, -1)
    print(data.header.seq, data.header.frame_id, im.shape, data.step, zlib.crc32(im.tobytes()))


def on_info(m):
    print(m.K, m.D, m.P, m.roi.do_rectify)


rospy.init_node('viewer')
rospy.Subscriber('image_raw', Image, callback, queue_size=1, buff_size=2**24)
rospy.Subscriber('camera_info', CameraInfo, on_info)
rospy.Subscriber('image/compressed', CompressedImage,
                 lambda m: print(m.format, np.frombuffer(m.data, np.uint8)))
print('ready')
rospy.spin()
