#!/usr/bin/env python3
import numpy
import rospy
from rospy.numpy_msg import numpy_msg
from rospy_tutorials.msg import Floats

rospy.init_node('floats_talker')
pub = rospy.Publisher('floats', numpy_msg(Floats), queue_size=10, latch=True)
pub.publish(numpy.array([1.0, 2.1, 3.5], dtype=numpy.float32))
print("ready")
rospy.spin()
