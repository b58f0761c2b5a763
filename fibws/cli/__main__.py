"""``python -m fibws.cli rostopic list``: a command of ROS 1, as ros1/shell/bin calls it."""

from __future__ import annotations

from fibws.__main__ import main

if __name__ == "__main__":
    main("fibws.cli.aliases")
