#!/usr/bin/env python3
import rospy
import sensor_msgs.point_cloud2 as pc2
from sensor_msgs.msg import PointCloud2

rospy.init_node('cloud_listener')
cloud = rospy.wait_for_message('cloud', PointCloud2, timeout=60)
print(type(cloud.data).__name__, len(cloud.data), cloud.header.frame_id, cloud.header.seq)
for point in pc2.read_points(cloud):
    print(tuple(point))
print([tuple(p) for p in pc2.read_points(cloud, field_names=("z", "x"), skip_nans=True)])
print([p.x + p.y for p in pc2.read_points_list(cloud)])
