#!/usr/bin/env python3
import rospy
from geometry_msgs.msg import Point, Pose, PoseStamped, Twist, Vector3
from std_msgs.msg import ColorRGBA, Header, Int8, Int32, String

try:
    rospy.Publisher('early', String, queue_size=1).publish("too early")
except rospy.ROSException as e:
    print(type(e).__name__, e)
try:
    rospy.get_time()
except rospy.ROSInitException as e:
    print(type(e).__name__, e)
try:
    rospy.spin()
except rospy.ROSInitException as e:
    print(type(e).__name__, e)
for name in ("", "a/b"):
    try:
        rospy.init_node(name)
    except ValueError as e:
        print(type(e).__name__, e)

rospy.init_node('advanced_publish')
rospy.init_node('advanced_publish')
try:
    rospy.init_node('another')
except rospy.ROSException as e:
    print(type(e).__name__, str(e)[:62])
pub = rospy.Publisher("color", ColorRGBA, queue_size=10)


def attempt(publisher, *args, **kwargs):
    try:
        publisher.publish(*args, **kwargs)
        print("ok")
    except Exception as e:
        print(type(e).__name__, e)


while pub.get_num_connections() == 0:
    rospy.sleep(0.02)
attempt(pub, ColorRGBA(1, 2, 3, 4))
attempt(pub, 1, 2, 3, 0.5)
attempt(pub, r=1, g=2)
attempt(pub, a=1.0)
attempt(pub, 1, 2)
attempt(pub, 1, 2, 3, 4, 5)
attempt(pub, 1, a=2)
attempt(pub, x=1)
attempt(pub, String("hi"))
attempt(pub, "hi")
attempt(pub, r="red")
attempt(pub, Header())
print(ColorRGBA(1, 2, 3, 4))
print(ColorRGBA(b=1, a=0.25) == ColorRGBA(0, 0, 1, 0.25), ColorRGBA(1, 1, 1, 1) != ColorRGBA())
for make in (
    lambda: ColorRGBA(1, 2),
    lambda: ColorRGBA(1, 2, 3, 4, 5),
    lambda: ColorRGBA(nothing=1),
    lambda: Int32(1, data=2),
    lambda: setattr(Int32(), 'dat', 1),
):
    try:
        print(make())
    except Exception as e:
        print(type(e).__name__, str(e).removesuffix(" and no __dict__ for setting new attributes"))
print(repr(Int32(5)), Int32(), String("a: b\n'c' \"d\""), String(""), sep="\n")
print(Twist(Vector3(1, 2, 3), Vector3()))
pose = PoseStamped()
pose.header.stamp = rospy.Time(12, 34)
pose.header.frame_id = "map"
pose.pose.position = Point(1.5, -2, 1e-9)
print(pose)
print(PoseStamped._type, PoseStamped._md5sum, PoseStamped.__slots__, PoseStamped._slot_types)
print(PoseStamped._has_header, Pose._has_header, PoseStamped._full_text.count('MSG: '))
small = rospy.Publisher("small", Int8, queue_size=1)
attempt(small, 200)
attempt(small, 1.5)
pub.unregister()
attempt(pub, 1, 2, 3, 4)
for args in (("", String), ("x", None), ("x", int)):
    try:
        rospy.Publisher(*args, queue_size=1)
        print("ok")
    except Exception as e:
        print(type(e).__name__, e)
