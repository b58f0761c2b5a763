#!/usr/bin/env python3
import rospy
from std_msgs.msg import String


def param_talker():
    rospy.init_node('param_talker')
    print("global %s" % rospy.get_param("/global_example", "unset"))
    rospy.set_param("/global_example", "global value")
    print(rospy.get_param("/global_example"))
    print(rospy.get_param('default_param', 'default_value'))
    rospy.set_param('~private_param', [1.0, 2, "three", True, {"four": 4}])
    print(rospy.get_param('~private_param'))
    print(rospy.get_param('/param_talker/private_param'))
    rospy.set_param('gains', {'p': 1, 'i': 2, 'd': {'slow': 3, 'fast': 4}})
    gains = rospy.get_param('gains')
    print(sorted(gains.items(), key=str), rospy.get_param('gains/d/fast'))
    rospy.set_param('gains', {'p': 5})
    print(rospy.get_param('gains'))
    rospy.set_param('to_delete', 'baz')
    print(rospy.has_param('to_delete'))
    rospy.delete_param('to_delete')
    print(rospy.has_param('to_delete'))
    try:
        rospy.delete_param('to_delete')
    except KeyError as e:
        print("KeyError", e)
    try:
        rospy.get_param('never_set')
    except KeyError as e:
        print("KeyError", e)
    print(rospy.search_param('global_example'), rospy.search_param('private_param'))
    print(rospy.search_param('never_set'))
    print(rospy.get_param_cached('gains/p'), rospy.get_param_cached('gains/p'))
    for bad in ("a b", "~"):
        try:
            print(repr(bad), rospy.get_param(bad, "default"))
        except Exception as e:
            print(repr(bad), type(e).__name__)
    print([name for name in sorted(rospy.get_param_names()) if 'param_talker' in name])
    print(rospy.resolve_name('a'), rospy.resolve_name('~a'), rospy.resolve_name('/a/b'))
    print(rospy.get_name(), rospy.get_namespace(), rospy.get_caller_id())


if __name__ == '__main__':
    param_talker()
