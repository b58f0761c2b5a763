"""ROS 1's userland, in which programs for ROS 1 run unmodified.

python/     modules for the PYTHONPATH: rospy, actionlib and others, on top of the node library
fallback/   modules that are used only where PyPI's are not installed: rospkg
shell/      commands for the PATH (roscore, rosrun, rostopic ...) and the environment they need
workspace/  packages, catkin_make and rosrun
launch/     launch files and the processes that they start

Neither folder is on a path before ``fibws setup``, ``fibws run`` or ``python -m fibws.rospy``. An
installed ROS is never hidden unless the user requests it.
"""
