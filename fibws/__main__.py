"""``python -m fibws``: the command line."""

from __future__ import annotations

import sys
from importlib import import_module

from fibws.exit_signals import interrupt_once


def main(module: str = "fibws.cli.commands") -> None:
    """Run the ``main`` of a module, of which Ctrl-C may break off the import, too."""
    try:
        interrupt_once()
        import_module(module).main()
    except KeyboardInterrupt:
        sys.exit(130)  # As `fibws.cli.exit_handling` has it, which may not be there yet.


if __name__ == "__main__":
    main()
