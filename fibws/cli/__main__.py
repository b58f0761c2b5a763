"""``python -m fibws.cli rostopic list``: an alias, as ros1/shell/bin runs it."""

from __future__ import annotations

from fibws.__main__ import main

if __name__ == "__main__":
    main("fibws.cli.aliases")
