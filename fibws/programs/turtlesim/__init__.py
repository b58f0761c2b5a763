"""turtlesim, the simulator of ROS's tutorials: http://wiki.ros.org/turtlesim.

    turtlesim_node ── field (turtles and what their pens draw; no node) ── canvas (its pixels)
    teleop_key, draw_square and mimic command turtles over topics.

The hub's page shows the turtles, from their poses and from the picture that the node publishes.
"""
