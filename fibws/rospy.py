"""``python -m fibws.rospy SCRIPT``: runs a rospy script without ROS."""

from __future__ import annotations

import sys

from fibws.ros1.script import run_script

HELP = """\
Usage: python -m fibws.rospy SCRIPT [ARGUMENTS]...

Runs an unmodified rospy script: it imports rospy and <package>.msg from fibws, and connects to the
hub at $FIBWS_HUB, by default ws://127.0.0.1:9090.

After `source <(fibws setup)`, plain `python SCRIPT` works, too.
"""


def main() -> None:
    """Run the script in the first argument with the other arguments."""
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
