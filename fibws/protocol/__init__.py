"""The rosbridge v2.0 protocol and fibws.v1, without sockets: operations, messages, frames.

https://github.com/RobotWebTools/rosbridge_suite/blob/ros1/ROSBRIDGE_PROTOCOL.md
"""
