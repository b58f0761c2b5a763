"""ROS 2 nodes in the graph, by the key layout of rmw_zenoh."""
