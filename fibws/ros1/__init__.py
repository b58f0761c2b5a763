"""ROS 1's userland, so that programs for ROS 1 run unchanged.

python/     modules for the PYTHONPATH: rospy, actionlib and others, on top of the node library
shell/      commands for the PATH (roscore, rosrun, rostopic ...) and the environment they need
workspace/  packages, catkin_make and rosrun
launch/     launch files and the processes that they start

Neither folder is on a path until someone runs ``fibws setup``, ``fibws run`` or ``python -m
fibws.rospy``. An installed ROS is never hidden unless the user asks for it.
"""
