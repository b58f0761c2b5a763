"""The rosbridge v2.0 protocol: what travels on the wire, with no socket in sight.

https://github.com/RobotWebTools/rosbridge_suite/blob/ros1/ROSBRIDGE_PROTOCOL.md
"""
