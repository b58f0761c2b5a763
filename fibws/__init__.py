"""The ROS graph over WebSockets."""

__version__ = "0.1.0"
