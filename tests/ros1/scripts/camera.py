#!/usr/bin/env python3
import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Empty, Header


def to_msg(pixels):
    msg = Image(encoding='rgb8')
    msg.height, msg.width, channels = pixels.shape
    msg.step = msg.width * channels
    msg.data = pixels.tobytes()
    msg.header = Header(stamp=rospy.Time.now(), frame_id='cam')
    return msg


def wait_for(count):
    # viewer.py keeps one image, the newest
    while len(seen) < count:
        rospy.sleep(0.02)


rospy.init_node('camera')
seen = []
viewer = rospy.Subscriber('seen', Empty, seen.append)
pub = rospy.Publisher('image_raw', Image, queue_size=2)
info_pub = rospy.Publisher('camera_info', CameraInfo, queue_size=1)
small_pub = rospy.Publisher('image/compressed', CompressedImage, queue_size=1)
for each in (pub, info_pub, small_pub, viewer):
    while each.get_num_connections() < 1:
        rospy.sleep(0.02)
img = (np.arange(120 * 160 * 3) % 251).reshape(120, 160, 3).astype(np.uint8)
for i in range(3):
    pub.publish(to_msg(img[:, ::-1] if i % 2 else img))
    wait_for(i + 1)
info = CameraInfo(width=640, height=480, distortion_model='plumb_bob')
info.K = [1, 0, 320, 0, 1, 240, 0, 0, 1]
info.P = tuple(range(12))
info_pub.publish(info)
wait_for(4)
small = CompressedImage()
small.format = "jpeg"
small.data = np.arange(10, dtype=np.uint8).tobytes()
small_pub.publish(small)
wait_for(5)
info.K = [1, 2]
try:
    info_pub.publish(info)
except rospy.ROSSerializationException:
    print("K has nine numbers")
