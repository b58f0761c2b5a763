"""``python -m fibws.ros1 rostopic list``: a command of ROS 1, as the doors in bin/ call it."""

from __future__ import annotations

from fibws.__main__ import main

if __name__ == "__main__":
    main("fibws.cli.door")
