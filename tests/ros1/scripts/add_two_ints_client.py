#!/usr/bin/env python3
import sys

import rospy
from rospy_tutorials.srv import *


def add_two_ints_client(x, y):
    rospy.wait_for_service('add_two_ints')
    try:
        add_two_ints = rospy.ServiceProxy('add_two_ints', AddTwoInts)
        print("Requesting %s+%s" % (x, y))
        resp1 = add_two_ints(x, y)
        resp2 = add_two_ints.call(AddTwoIntsRequest(x, y))
        resp3 = add_two_ints(a=x, b=y)
        if not resp1.sum == resp2.sum == resp3.sum == (x + y):
            raise Exception("test failure, returned sum was %s" % resp1.sum)
        print(resp1)
        print(repr(resp2))
        return resp1.sum
    except rospy.ServiceException as e:
        print("Service call failed: %s" % e)


def usage():
    return "%s [x y]" % sys.argv[0].rpartition("/")[2]


if __name__ == "__main__":
    argv = rospy.myargv()
    if len(argv) == 3:
        try:
            x = int(argv[1])
            y = int(argv[2])
        except ValueError:
            print(usage())
            sys.exit(1)
        print("%s + %s = %s" % (x, y, add_two_ints_client(x, y)))
    else:
        print(usage())
        sys.exit(1)
