#!/usr/bin/env python3
import zlib

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Empty


def callback(data):
    im = np.frombuffer(data.data, dtype=np.uint8).reshape(data.height, data.width, -1)
    print(data.header.seq, data.header.frame_id, im.shape, data.step, zlib.crc32(im.tobytes()))
    seen.publish()


def on_info(m):
    print(m.K, m.D, m.P, m.roi.do_rectify)
    seen.publish()


def on_small(m):
    print(m.format, np.frombuffer(m.data, np.uint8))
    seen.publish()


rospy.init_node('viewer')
seen = rospy.Publisher('seen', Empty, queue_size=10)
rospy.Subscriber('image_raw', Image, callback, queue_size=1, buff_size=2**24)
rospy.Subscriber('camera_info', CameraInfo, on_info)
rospy.Subscriber('image/compressed', CompressedImage, on_small)
print('ready')
rospy.spin()
