"""Runs the hub as on a machine without uvloop: `python -m bench.plain --port 0`."""

import runpy
import sys

# An import of it fails from now on, as if it were not installed: Python's documented use of None,
# which the type of sys.modules does not know.
sys.modules["uvloop"] = None  # type: ignore[assignment]
runpy.run_module("fibws.hub", run_name="__main__", alter_sys=True)
