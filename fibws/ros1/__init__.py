"""What stands in for an installed ROS 1, so that its programs run as they are.

bin/     commands for the PATH, each a thin door to ``fibws``: roscore, rosrun, rostopic ...
python/  modules for the PYTHONPATH, above all rospy, on top of the node library

Neither is on a path until somebody asks for it: by ``fibws setup``, ``fibws run`` or ``python -m
fibws.rospy``. A ROS that is installed is never shadowed unasked.
"""
