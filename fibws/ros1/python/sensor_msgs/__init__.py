"""What sensor_msgs has besides its messages, which the import finder brings."""
