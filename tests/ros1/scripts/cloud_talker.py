#!/usr/bin/env python3
import rospy
import sensor_msgs.point_cloud2 as pc2
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header

rospy.init_node('cloud_talker')
pub = rospy.Publisher('cloud', PointCloud2, queue_size=2, latch=True)
header = Header(frame_id="/map")
points = [[0.5 * i, float(i), -0.25 * i] for i in range(4)]
cloud = pc2.create_cloud_xyz32(header, points)
print(cloud.width, cloud.height, cloud.point_step, cloud.row_step, cloud.is_dense, len(cloud.data))
print([(f.name, f.offset, f.datatype, f.count) for f in cloud.fields])
pub.publish(cloud)
print("ready")
rospy.spin()
