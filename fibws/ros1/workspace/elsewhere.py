"""Names that a package may speak of without there being such a package here."""

from __future__ import annotations

PROVIDED = {
    *("actionlib", "catkin", "genmsg", "genpy", "message_filters", "message_generation"),
    *("message_runtime", "rosbash", "rosgraph", "roslaunch", "roslib", "rosmaster", "rosmsg"),
    *("rosnode", "rosparam", "rospy", "rosservice", "rostopic", "std_srvs", "rosbridge_server"),
    *("rosapi", "rosbridge_library", "rosbridge_suite", "ros_comm", "ros_base"),
    *("ros_core", "roscpp_tutorials", "rospy_tutorials", "topic_tools", "rosout", "cmake_modules"),
    *("tf", "tf2", "tf2_ros", "tf2_msgs", "tf2_py", "rqt_graph", "rqt_plot", "rqt_console", "rqt"),
    *("std_msgs", "common_msgs", "geneus", "gencpp", "genlisp", "gennodejs"),
}
"""Packages of ROS whose part is played here, or needs no player."""

ELSEWHERE = {
    *(
        "amcl",
        "angles",
        "camera_info_manager",
        "controller_manager",
        "cv_bridge",
        "eigen_conversions",
    ),
    *("gazebo_msgs", "gazebo_plugins", "gazebo_ros", "gmapping", "hector_gazebo_plugins"),
    *("image_geometry", "image_transport", "interactive_markers", "joint_state_controller"),
    *("joint_state_publisher", "joint_state_publisher_gui", "joy", "kdl_parser", "laser_geometry"),
    *(
        "map_server",
        "move_base",
        "move_base_msgs",
        "moveit_commander",
        "nodelet",
        "pcl_conversions",
    ),
    *("pcl_ros", "pluginlib", "robot_state_publisher", "ros_control", "ros_controllers", "rosbag"),
    *("roslint", "rosserial_arduino", "rosserial_python", "rostest", "rosunit", "rqt_gui"),
    *(
        "rqt_gui_py",
        "rviz",
        "serial",
        "smach",
        "smach_ros",
        "teleop_twist_keyboard",
        "tf_conversions",
    ),
    *("tf2_eigen", "tf2_geometry_msgs", "tf2_sensor_msgs", "turtle_tf", "turtlebot3_msgs"),
    *("turtlebot3_teleop", "urdf", "urdf_parser_plugin", "usb_cam", "web_video_server", "xacro"),
    *("dynamic_reconfigure", "ackermann_msgs", "control_msgs", "diagnostic_updater", "gtest"),
    *("object_recognition_msgs", "octomap_msgs", "python_qt_binding", "rosconsole", "roscpp"),
    *("rostime", "roscpp_serialization", "roscpp_traits", "cpp_common", "class_loader"),
}
"""Packages of ROS that many packages name and that are not here: what they are for is missing."""

MODULES = {"boost", "eigen3", "opencv", "pcl", "threads", "pythoninterp", "pythonlibs", "yaml-cpp"}
MODULES |= {"eigen", "qt5", "pkgconfig", "openmp", "cuda", "opengl", "python3", "python", "bullet"}
"""What find_package() finds of the system's, in lower case; nothing here has a use for it."""
