"""A program that publishes positions of joints: http://wiki.ros.org/joint_state_publisher."""
