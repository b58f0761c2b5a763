#!/usr/bin/env python3
"""Bags that a script writes, appends to, reads and inspects."""
import io
import os
import shutil
import sys
import tempfile

import genpy
import rosbag
import rospy
from geometry_msgs.msg import PoseStamped
from rosbag.bag import Bag
from sensor_msgs.msg import Image
from std_msgs.msg import Int32, String

folder = tempfile.mkdtemp()
path = os.path.join(folder, "it.bag")


def attempt(function, *args, **others):
    try:
        print(function(*args, **others), flush=True)
    except Exception as error:
        text = str(error).replace(folder, "FOLDER")
        kinds = [each.__name__ for each in type(error).__mro__ if each.__module__ != "object"]
        print("raises", kinds[0], [each for each in kinds if each.startswith("ROS")][-1:], flush=True)
        if "Errno" in text or not isinstance(error, rosbag.ROSBagException):
            print(text if "JSON" not in text else "", flush=True)


def show(bag, **options):
    for topic, message, stamp in bag.read_messages(**options):
        print(topic, message._type, str(message).replace("\n", " "), repr(stamp), stamp)


def inspect(bag):
    print(bag.get_message_count(), bag.get_start_time(), bag.get_end_time())
    print(bag.get_message_count("/number"), bag.get_message_count(["/number", "/text", "/none"]))
    info = bag.get_type_and_topic_info()
    print(info.msg_types)
    for topic in sorted(info.topics):
        print(topic, tuple(info.topics[topic]), info.topics[topic].frequency)
    print(tuple(bag.get_type_and_topic_info("/text").topics), bag.get_type_and_topic_info(["/no"]))
    print(bag.version, bag.options, bag.compression, bag.chunk_threshold, bag.mode)


def pose(seconds):
    message = PoseStamped()
    message.header.stamp = rospy.Time(seconds, 5)
    message.header.frame_id = "map"
    message.pose.orientation.w = 1.0
    return message


for compression in (rosbag.Compression.NONE, rosbag.Compression.BZ2, rosbag.Compression.LZ4):
    print("writing", compression)
    with rosbag.Bag(path, "w", compression=compression, chunk_threshold=1000) as bag:
        for number in range(20):
            stamp = rospy.Time(1000 + number // 2, number % 2 * 500000000)
            bag.write("/number", Int32(number), stamp)
            bag.write("/text", String("text %d" % number), stamp + rospy.Duration(0, 7))
            if number % 5 == 0:
                bag.write("/pose", pose(number), stamp + rospy.Duration(100))
        bag.write("/image", Image(width=4, height=2, encoding="rgb8", step=12, data=bytes(24)),
                  rospy.Time(1108))
    with rosbag.Bag(path) as bag:
        inspect(bag)
        print(bag.filename == path, bag.size == os.path.getsize(path))
        show(bag)
        print(bag.get_compression_info().compression)

print("selecting")
bag = rosbag.Bag(path)
for options in (
    {"topics": "/number"},
    {"topics": ["/pose", "/text"], "end_time": rospy.Time(1002)},
    {"start_time": rospy.Time(1008, 1), "end_time": genpy.Time(1009)},
    {"start_time": rospy.Time(0), "topics": ["/image"]},
    {"topics": []},
    {"topics": ["number"]},
    {"topics": "/pose/"},
):
    print(sorted(options))
    show(bag, **options)
show(bag, connection_filter=lambda topic, type_, md5sum, text, header: (
    type_ == "std_msgs/String" and md5sum and "string data" in text and header["topic"] == b"/text"
), end_time=rospy.Time(1001))
print(len(list(bag)))
print(type(bag.read_messages()).__name__)

print("raw")
for topic, raw, stamp in bag.read_messages(raw=True, topics=["/number", "/image"]):
    type_, data, md5sum, position, class_ = raw
    print(topic, type_, data, md5sum, len(position), class_._type, class_._md5sum == md5sum)
print("headers")
for found in bag.read_messages(return_connection_header=True, end_time=rospy.Time(1000)):
    print(found._fields, sorted(found.connection_header), found.connection_header["type"])
    print(found.topic, found.timestamp, type(found).__name__)
copy = os.path.join(folder, "copy.bag")
with rosbag.Bag(copy, "w", options={"compression": "lz4", "chunk_threshold": 500}) as out:
    for topic, raw, stamp in bag.read_messages(raw=True):
        out.write(topic, raw, stamp, raw=True)
    for topic, raw, stamp in bag.read_messages(raw=True, topics=["/text"]):
        out.write("/again", (raw[0], raw[1], raw[2], raw[4]), stamp, raw=True)
    out.write("/number", Int32(20), rospy.Time(2000))
bag.close()
bag.close()
with rosbag.Bag(copy) as bag:
    inspect(bag)
    show(bag, topics=["/again", "/pose"])

print("appending")
with rosbag.Bag(copy, "a") as bag:
    bag.write("/more", Int32(78), rospy.Time(5001))
    print(bag.mode)
with Bag(copy, "r") as bag:
    inspect(bag)
    show(bag, start_time=rospy.Time(1100))

print("streams")
with open(path, "rb") as stream:
    bag = rosbag.Bag(stream)
    print(bag.filename, bag.get_message_count())
    bag.close()
memory = io.BytesIO(open(path, "rb").read())
memory.mode = "rb"

print("headers of publishers")
with rosbag.Bag(copy, "w") as bag:
    header = {"topic": "/a", "type": Int32._type, "md5sum": Int32._md5sum,
              "message_definition": Int32._full_text, "callerid": "/talker", "latching": "1"}
    bag.write("/a", Int32(5), rospy.Time(1), connection_header=header)
with rosbag.Bag(copy) as bag:
    for found in bag.read_messages(return_connection_header=True):
        header = found.connection_header
        print(sorted(header), [header[each] for each in ("topic", "type", "callerid", "latching")])

print("errors")
attempt(rosbag.Bag, os.path.join(folder, "missing.bag"))
attempt(rosbag.Bag, "")
attempt(rosbag.Bag, path, "x")
attempt(rosbag.Bag, copy, "w", compression="zip")
attempt(rosbag.Bag, copy, "w", chunk_threshold=-1)
attempt(rosbag.Bag, copy, "w", options=5)
with rosbag.Bag(copy, "w") as bag:
    attempt(bag.write, "", Int32(1))
    attempt(bag.write, "/a", None)
    attempt(bag.write, "/a", (1, 2), raw=True)
    attempt(bag.write, "/a", ("no/Type", b"", "*", None), rospy.Time(1), raw=True)
    attempt(bag.get_start_time)
    bag.write("/a", Int32(1), rospy.Time(1))
attempt(bag.write, "/a", Int32(1))
attempt(bag.flush)
attempt(lambda: bag.size)
for content in (b"", b"nothing\n", b"#ROSBAG V1.1\n"):
    with open(copy, "wb") as file:
        file.write(content)
    attempt(rosbag.Bag, copy)
with open(path, "rb") as file:
    content = file.read()
with open(copy, "wb") as file:
    file.write(content[:-500])
attempt(rosbag.Bag, copy)
try:
    rosbag.Bag(copy)
except rosbag.ROSBagUnindexedException as error:
    print(error, error.value, error.args)
print(rosbag.ROSBagFormatException("text").value, rosbag.ROSBagException().value)
print(sorted(each for each in vars(rosbag.Compression) if not each.startswith("_")))
for each in ("ROSBagFormatException", "ROSBagUnindexedException", "ROSBagEncryptException",
             "ROSBagEncryptNotSupportedException"):
    print(each, getattr(rosbag.bag, each).__mro__[1].__name__)
shutil.rmtree(folder)
sys.exit(0)
