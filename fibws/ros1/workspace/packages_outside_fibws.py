"""Dependencies that fibws does not contain: which are not needed, and how to install the others."""

from __future__ import annotations

import re

NOT_NEEDED = set(
    """
    catkin cmake_modules cpp_common desktop desktop_full gencpp geneus genlisp genmsg gennodejs
    message_generation message_runtime mk ros_base ros_comm ros_core rosbash rosboost_cfg rosbuild
    rosconsole roscpp roscpp_serialization roscpp_traits roscpp_tutorials roslang roslaunch roslisp
    roslint rosmake rosmaster rosout rostime common_msgs topic_tools rosbridge_library
    rosbridge_suite rqt rqt_common_plugins rqt_console rqt_graph rqt_gui rqt_plot
    cv_bridge joint_state_publisher robot_state_publisher rqt_reconfigure rqt_topic tf2 tf2_py
    tf2_ros web_video_server xmlrpcpp

    class_loader collada_parser collada_urdf eigen_conversions filters kdl_parser
    laser_filters nodelet nodelet_core orocos_kdl pcl_conversions pcl_ros pluginlib realtime_tools
    tf2_bullet tf2_eigen tf2_kdl tf2_tools urdf urdf_parser_plugin
    """.split()
)
"""Packages whose part fibws plays itself, or that only builds and C++ code use."""

_REPOSITORIES = {
    "ros/angles": "angles",
    "ros/diagnostics": "diagnostic_common_diagnostics",
    "ros/executive_smach": "smach smach_ros",
    "ros/joint_state_publisher": "joint_state_publisher_gui",
    "ros/ros_comm": "rosbag_storage roswtf",
    "ros-controls/ros_control": "controller_manager controller_manager_msgs ros_control",
    "ros-controls/ros_controllers": "joint_state_controller ros_controllers",
    "ros-drivers/ackermann_msgs": "ackermann_msgs",
    "ros-drivers/joystick_drivers": "joy joystick_drivers",
    "ros-drivers/rosserial": "rosserial rosserial_arduino rosserial_python",
    "ros-drivers/usb_cam": "usb_cam",
    "ros-geographic-info/geographic_info": "geodesy",
    "ros-geographic-info/unique_identifier": "unique_id",
    "ros-perception/image_common": "camera_info_manager camera_calibration_parsers polled_camera",
    "ros-perception/laser_geometry": "laser_geometry",
    "ros-perception/slam_gmapping": "gmapping slam_gmapping",
    "ros-perception/vision_msgs": "vision_msgs",
    "ros-perception/vision_opencv": "image_geometry vision_opencv",
    "ros-planning/moveit": "moveit_commander moveit_core moveit_ros",
    "ros-planning/navigation": "amcl move_base navigation costmap_2d",
    "ros-simulation/gazebo_ros_pkgs": "gazebo_plugins gazebo_ros gazebo_ros_pkgs",
    "ros-teleop/teleop_tools": "key_teleop mouse_teleop",
    "ros-teleop/teleop_twist_joy": "teleop_twist_joy",
    "ros-teleop/teleop_twist_keyboard": "teleop_twist_keyboard",
    "ros-visualization/python_qt_binding": "python_qt_binding",
    "ros-visualization/rqt": "rqt_gui_py rqt_py_common",
    "ros-visualization/rviz": "rviz",
    "ROBOTIS-GIT/turtlebot3": "turtlebot3_teleop turtlebot3_bringup turtlebot3_description",
    "ROBOTIS-GIT/turtlebot3_msgs": "turtlebot3_msgs",
}
REPOSITORIES = {
    name: f"https://github.com/{repository}"
    for repository, names in _REPOSITORIES.items()
    for name in names.split()
}
"""Where the source of common packages is."""

IN_CPP = set(
    """
    amcl cartographer_ros controller_manager costmap_2d depthimage_to_laserscan gazebo_plugins
    gazebo_ros gazebo_ros_pkgs gmapping hector_mapping image_proc joint_state_controller joy
    joystick_drivers laser_filters move_base moveit_commander moveit_core moveit_ros navigation
    nodelet pointcloud_to_laserscan robot_localization ros_control ros_controllers rosbag_storage
    rplidar_ros slam_gmapping stereo_image_proc urg_node usb_cam velodyne_pointcloud
    """.split()
)
"""Packages that many robots use, and that are in C++ or need it."""
CPP = "in C++, which fibws does not build; nodes of an installed ROS join a hub with --ros1"
"""What errors say of these packages."""

_ROS_ON_PYPI = {"xacro": "xacro", "urdfdom_py": "urdfdom-py", "urdf_parser_py": "urdf-parser-py"}
_KEYS_ON_PYPI = {
    "dateutil": "python-dateutil",
    "gnupg": "python-gnupg",
    "imaging": "pillow",
    "opencv": "opencv-python",
    "pil": "pillow",
    "serial": "pyserial",
    "skimage": "scikit-image",
    "sklearn": "scikit-learn",
    "usb": "pyusb",
    "websocket": "websocket-client",
    "yaml": "pyyaml",
    "zmq": "pyzmq",
}
_KEYS_ON_PYPI |= {
    name: name
    for name in """
    defusedxml empy evdev flask future gitpython lxml matplotlib mock netifaces networkx nose numba
    numpy pandas paramiko pexpect psutil pyaudio pydot pygame pygraphviz pymodbus pymongo pyproj
    requests rtree scipy setuptools shapely simplejson six sympy tensorflow termcolor torch tornado
    transforms3d twisted ujson
    """.split()
}
_PYTHON_KEY = re.compile(r"python3?-(?P<name>[a-z0-9.-]+?)(?P<pip>-pip)?")


def pip_name(dependency: str) -> str | None:
    """Return what ``pip install`` calls a dependency, or None if that is unknown.

    Args:
        dependency: a ROS package, or a key of rosdep as ``python3-numpy``.
    """
    if found := _PYTHON_KEY.fullmatch(dependency):
        name = found["name"]
        return _KEYS_ON_PYPI.get(name, name if found["pip"] else None)
    return _ROS_ON_PYPI.get(dependency)


def is_installed(pip_name: str) -> bool:
    """Return whether a package of PyPI is installed for this Python."""
    from importlib.metadata import PackageNotFoundError, distribution

    try:
        distribution(pip_name)
    except PackageNotFoundError:
        return False
    return True
