#!/usr/bin/env python3
import rospy

rospy.init_node('logs', log_level=rospy.DEBUG)
rospy.sleep(1)  # Until those who listen to /rosout are connected.
print("ready")
rospy.logdebug("debug %d", 1)
rospy.loginfo("info %s %s", "a", "b")
rospy.loginfo({"a": 1})
rospy.loginfo("100%")
rospy.logwarn("warn")
rospy.logerr("error")
rospy.logfatal("fatal")
for i in range(3):
    rospy.loginfo_once("once %d", i)
    rospy.loginfo_throttle(60, "throttled %d" % i)
    rospy.logwarn_throttle(60, "throttled warning")
    rospy.logerr_throttle_identical(60, "identical %d" % (i // 2))
rospy.loginfo("to a logger of its own", logger_name="mine")
rospy.loginfo("two\nlines")
rospy.loginfo("umlauts: äöü €")
rospy.loginfo("exception", exc_info=False)
print(rospy.DEBUG, rospy.INFO, rospy.WARN, rospy.ERROR, rospy.FATAL)
rospy.sleep(0.5)
