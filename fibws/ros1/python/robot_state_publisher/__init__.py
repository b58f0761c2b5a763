"""A program that publishes the frames of a robot: http://wiki.ros.org/robot_state_publisher."""
