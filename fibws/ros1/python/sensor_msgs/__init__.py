"""The modules of sensor_msgs besides its messages, which the import finder provides."""
