#!/usr/bin/env python3
"""Calls of ROS's internal modules, which some scripts import."""
import io
import os
import socket
import sys

import genpy.dynamic
import rosgraph.network
import rosgraph.roslogging
import roslib.msgs
import roslib.names
import roslib.srvs
import rospy
from rospy.msg import deserialize_messages, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Header


def attempt(function, *args):
    try:
        print(function(*args), flush=True)
    except Exception as error:
        print(type(error).__name__, flush=True)


print("names")
for name in ("std_msgs/String", "String", "a/b/c", "", "1a", "a//b", "/a", "a b"):
    print(name, roslib.names.is_legal_resource_name(name))
    print(roslib.names.is_legal_resource_base_name(name))
    print(roslib.names.resource_name_base(name), roslib.names.resource_name_package(name))
    attempt(roslib.names.package_resource_name, name)
    print(roslib.names.resource_name("p", name, "q"), roslib.names.resource_name("p", name, "p"))
print(roslib.names.ns_join("/a", "b"), roslib.names.resolve_name("x", "/ns/node"))

print("messages")
for type_ in ("int8", "int8[]", "int8[3]", "a/B[2]", "Header", "B", "int8[][2]", "x[y]", "", "[3]"):
    print(type_, roslib.msgs.base_msg_type(type_), roslib.msgs.resolve_type(type_, "pkg"))
    attempt(roslib.msgs.parse_type, type_)
    print(roslib.msgs.is_valid_msg_type(type_), roslib.msgs.is_valid_constant_type(type_))
    print(roslib.msgs.is_header_type(type_), roslib.msgs.is_builtin(type_))
TEXT = """# A message
Header header
int32[3] three # numbers
Other[] others
geometry_msgs/Point point
uint8 ONE=1
string NAME= some # text
time stamp
"""
for context in ("", "pkg"):
    spec = roslib.msgs.load_from_string(TEXT, context, "pkg/Own", "Own")
    print(spec.types, spec.names, spec.constants, spec.has_header(), spec.fields())
    print(spec.full_name, spec.short_name, spec.package, spec.text == TEXT)
    print([(each.name, each.base_type, each.is_array, each.array_len, each.is_header)
           for each in spec.parsed_fields()], repr(spec), spec == spec)
    print([each.val_text for each in spec.constants])
attempt(roslib.msgs.load_from_string, "int32 a\nint32 a\n")
attempt(roslib.msgs.load_from_string, "int32\n")
attempt(roslib.msgs.load_from_string, "uint8 X=300\n")
service = roslib.srvs.load_from_string("int32 a\n---\nfloat32 b\n", "pkg", "pkg/S", "S")
print(repr(service), service.request.full_name, service.response.short_name)

print("addresses")
for url in ("http://robot:11311/", "http://robot", "robot", "", "http://", "http://[::1]:5"):
    attempt(rosgraph.network.parse_http_host_and_port, url)
for address in ("localhost", "127.0.0.5", "192.0.2.7", "no.such.host.invalid"):
    print(rosgraph.network.is_local_address(address), rosgraph.network.get_bind_address(address))
os.environ["ROS_HOSTNAME"] = "robot"
print(rosgraph.network.get_host_name(), rosgraph.network.get_local_address())
print(rosgraph.network.create_local_xmlrpc_uri(5), rosgraph.network.get_bind_address())
os.environ["ROS_IP"] = "127.0.0.9"
print(rosgraph.network.get_address_override())
del os.environ["ROS_HOSTNAME"]
print(rosgraph.network.get_address_override(), rosgraph.network.get_bind_address())
sys.argv.append("__ip:=10.0.0.1")
print(rosgraph.network.get_address_override(), rosgraph.network.use_ipv6())
sys.argv[-1] = "__ip:=a:=b"
attempt(rosgraph.network.get_address_override)
sys.argv.pop()

print("headers")
data = rosgraph.network.encode_ros_handshake_header({"topic": "/a", "callerid": "/n", "x": "a=b"})
print(data, rosgraph.network.decode_ros_handshake_header(data + b"more"))
for bad in (data[:-1], b"\x05\0\0\0\1\0\0\0x", b"\x04\0\0\0\0\0\0\0", b"\x05\0\0\0\x09\0\0\0x"):
    attempt(rosgraph.network.decode_ros_handshake_header, bad)
one, other = socket.socketpair()
print(rosgraph.network.write_ros_handshake_header(one, {"type": "*"}))
one.sendall(b"after")
one.close()
buffer = io.BytesIO()
print(rosgraph.network.read_ros_handshake_header(other, buffer, 3))
print(b"after".startswith(buffer.getvalue()))
attempt(rosgraph.network.read_ros_handshake_header, other, io.BytesIO(), 4096)

print("classes")
made = genpy.dynamic.generate_dynamic("sensor_msgs/JointState", JointState._full_text)
print(sorted(made), [made[each]._md5sum for each in sorted(made)])
written = io.BytesIO()
JointState(header=Header(seq=3, frame_id="map"), name=["a", "b"], position=[1.5]).serialize(written)
read = made["sensor_msgs/JointState"]().deserialize(written.getvalue())
print(read)
again = io.BytesIO()
read.serialize(again)
print(again.getvalue() == written.getvalue(), read._type, read.__slots__)
OWN = "Part[] parts\n" + "=" * 80 + "\nMSG: own/Part\nuint8 ONE=1\nfloat32 x\nHeader header\n"
OWN += "=" * 80 + "\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
made = genpy.dynamic.generate_dynamic("own/Whole", OWN)
print(sorted(made), made["own/Part"].ONE, made["own/Whole"]._md5sum, made["own/Whole"]._has_header)
print(made["own/Whole"]([made["own/Part"](x=2.5)]))

print("messages after their lengths")
buffer = io.BytesIO()
for number in range(4):
    serialize_message(buffer, number, JointState())
print(buffer.tell(), buffer.getvalue()[:12])
buffer.write(b"\x07\0\0\0ab")
found = []
deserialize_messages(buffer, found, JointState, max_msgs=2)
print([each.header.seq for each in found], buffer.tell())
deserialize_messages(buffer, found, JointState, queue_size=1)
print([each.header.seq for each in found], buffer.getvalue())
buffer.write(b"cdefg")
attempt(deserialize_messages, buffer, found, JointState)
deserialize_messages(io.BytesIO(), found, JointState)
print(len(found))

print("logs")
rosgraph.roslogging.configure_logging("internals", filename="internals-test.log")
print(os.path.basename(os.environ["ROS_LOG_FILENAME"]))
rospy.init_node("internals")
print(isinstance(rospy.get_name(), str))
