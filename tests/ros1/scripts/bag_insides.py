#!/usr/bin/env python3
"""Looks into a bag by the methods that many programs use though they are rosbag's own."""

import os
import tempfile

import rosbag
import rospy
from std_msgs.msg import Int32, String

folder = tempfile.mkdtemp()
os.chdir(folder)
with rosbag.Bag("a.bag", "w", compression="bz2") as bag:
    for number in range(50):
        bag.write("/numbers", Int32(number), rospy.Time(100 + number))
    bag.write("/text", String("x" * 100), rospy.Time(120, 5))
    print(sorted(each.topic for each in bag._get_connections()))


def chosen(topic, datatype, md5sum, msg_def, header):
    return datatype == "std_msgs/String"


KEYS = "duration", "topics", "topics[0]", "topics[0].type", "types[1].md5", "nothing", "topics[9]"
with rosbag.Bag("a.bag") as bag:
    lines = bag._get_yaml_info().splitlines()
    print([each for each in lines if not each.startswith(("size:", "uncom", "compressed:"))])
    for key in KEYS:
        print(key, repr(bag._get_yaml_info(key)))
    for each in bag._get_connections():
        print(each.id, each.topic, each.datatype, each.md5sum, each.msg_def.split())
        print(sorted((name, value.split()) for name, value in each.header.items()))
    print([each.topic for each in bag._get_connections("numbers")])
    print([each.topic for each in bag._get_connections(["/text", "/none"])])
    print([each.topic for each in bag._get_connections(connection_filter=chosen)])
with rosbag.Bag("a.bag", skip_index=True) as bag:
    print(bag._get_yaml_info("topics[0]"))
with rosbag.Bag("empty.bag", "w"):
    pass
with rosbag.Bag("empty.bag") as bag:
    print(bag._get_yaml_info())
