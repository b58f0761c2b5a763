"""Commands of ROS 1 in a shell: aliases on the PATH, and the environment that they need."""
