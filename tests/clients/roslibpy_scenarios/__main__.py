"""Runs scenarios in Python: python -m clients.roslibpy_scenarios URL SCENARIOS..."""

from __future__ import annotations

import importlib
import inspect
import logging
import os
import sys
import threading
import traceback
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from .world import World


class _Complaints(logging.Handler):
    """The warnings and errors that roslibpy, Twisted and asyncio log."""

    def __init__(self, world: World) -> None:
        super().__init__(logging.WARNING)
        self._world = world

    def emit(self, record: logging.LogRecord) -> None:
        self._world.report({"complaint": f"{record.name}: {self.format(record)}"})


def _play(world: World, scenario: Callable[[World], Any]) -> None:
    name = scenario.__name__.replace("_", " ")
    try:
        world.report({"scenario": name, "saw": scenario(world)})
    except Exception:
        world.report({"scenario": name, "failed": traceback.format_exc()})


def main(url: str, *modules: str) -> None:
    world = World(url)
    logging.getLogger().addHandler(_Complaints(world))
    threading.excepthook = lambda failed: world.report({"complaint": f"{failed.exc_value!r}"})
    scenarios = [
        scenario
        for name in modules
        for scenario in vars(importlib.import_module(f"{__package__}.{name}")).values()
        if inspect.isfunction(scenario)
        and not scenario.__name__.startswith("_")
        and scenario.__module__ == f"{__package__}.{name}"
    ]
    world.connect()  # Starts roslibpy's one event loop, which no two threads may start at once.
    with ThreadPoolExecutor(len(scenarios)) as pool:
        for scenario in scenarios:
            pool.submit(_play, world, scenario)
    world.report({"done": True})
    os._exit(0)  # A SimpleActionServer goes on publishing its status for ever.


main(*sys.argv[1:])
