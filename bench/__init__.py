"""Benchmarks of the hub against a relay in C, a simple Python hub and a real ROS, in one run."""
