#!/usr/bin/env python3
import rospy
from rospy.numpy_msg import numpy_msg
from rospy_tutorials.msg import Floats

rospy.init_node('floats_listener')
msg = rospy.wait_for_message('floats', numpy_msg(Floats), timeout=60)
print(type(msg.data).__name__, msg.data.dtype, msg.data.tolist(), msg.data.sum())
plain = rospy.wait_for_message('floats', Floats, timeout=60)
print(type(plain.data).__name__, plain.data)
raw = rospy.wait_for_message('floats', rospy.AnyMsg, timeout=60)
print(type(raw._buff).__name__, raw._buff.hex(), raw._connection_header['type'])
