"""``python -m fibws.rospy SCRIPT``: runs a rospy script where no ROS is installed."""

from __future__ import annotations

import sys

from fibws.ros1.script import run_script

HELP = """\
Usage: python -m fibws.rospy SCRIPT [ARGUMENTS]...

Runs a rospy script as it is: it imports rospy and <package>.msg from fibws, and meets others at a
hub, which $FIBWS_HUB tells of, else ws://127.0.0.1:9090.

In a shell where `source <(fibws setup)` was typed, plain `python SCRIPT` does so, too.
"""


def main() -> None:
    """Run the script that the first argument names, with the rest of them."""
    match sys.argv[1:]:
        case ["-h" | "--help", *_]:
            print(HELP, end="")
        case [script, *arguments] if not script.startswith("-"):
            run_script(script, arguments)
        case _:
            print(HELP, end="", file=sys.stderr)
            sys.exit(2)


if __name__ == "__main__":
    main()
