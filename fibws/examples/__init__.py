"""Example nodes: a service, an action, and two rospy scripts."""
