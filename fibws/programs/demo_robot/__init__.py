"""A simulated robot for ``fibws demo robot``: it drives by /cmd_vel, and has what robots have.

world        walls on a grid, rays, and a robot that cannot drive through them; no ROS in it
body         its description in URDF
robot_node   the topics: map, scan, camera, depths, odometry, tf, joints, markers, diagnostics,
             and an action
"""
