"""Example nodes: services, actions, and the first rospy scripts."""
