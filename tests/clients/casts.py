"""Which client plays which scenarios, and where."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import pytest

ROSLIB_1, ROSLIB_2, FOXGLOVE, FOXGLOVE_PROTOCOL, ROSLIBPY = (
    "roslib 1.4.1",
    "roslib 2.1.0",
    "foxglove/roslibjs",
    "foxglove/ws-protocol",
    "roslibpy",
)


@dataclass(frozen=True)
class Program:
    """A program of ours that serves clients, from when this service is there."""

    command: tuple[str, ...]
    service: str


PROGRAMS = (
    Program(("fibws.programs.tf2_web_republisher",), "/republish_tfs"),
    Program(("fibws.examples.add_two_ints_server",), "/add_two_ints"),
    Program(("fibws.examples.action_server", "--rate", "5"), "/fibonacci/_action/cancel_goal"),
)


@dataclass(frozen=True)
class Cast:
    """A client library with its runtime, its scenarios and the programs that they need.

    The hub may want a token, which is in the URL that the client is given.
    """

    library: str
    runtime: str
    scenarios: tuple[str, ...]
    programs: tuple[Program, ...] = ()
    wants_token: bool = False

    def __str__(self) -> str:
        return f"{self.library} in {self.runtime}"


_COMMON = ("topics", "services", "parameters", "introspection", "actionlib")
_JAVASCRIPT = (*_COMMON, "statuses", "encodings", "actionlib_js")
_ROSLIB = (*_JAVASCRIPT, "png", "typedefs")
_SCENARIOS = {
    ROSLIB_1: _ROSLIB,
    ROSLIB_2: (*_ROSLIB, "fragments", "promises", "actions"),
    FOXGLOVE: _JAVASCRIPT,
    ROSLIBPY: _COMMON,
}
_RUNTIMES = {
    ROSLIB_1: ("Node", "Chromium"),
    ROSLIB_2: ("Node", "Chromium"),
    FOXGLOVE: ("Node", "Chromium"),
    ROSLIBPY: ("twisted", "asyncio"),
}
_WITH_PROGRAMS = {
    ROSLIB_1: ("tutorials", "tf", "tf_service"),
    ROSLIB_2: ("tutorials", "tf", "tf_operations", "tutorial_actions"),
    ROSLIBPY: ("tutorials", "tf_service", "tutorial_actions"),
}


def _casts() -> Iterable[Cast]:
    for library, runtimes in _RUNTIMES.items():
        for runtime in runtimes:
            yield Cast(library, runtime, _SCENARIOS[library])
            yield Cast(library, runtime, ("reconnection",))
            yield Cast(library, runtime, ("tokens",), wants_token=True)
            if library in _WITH_PROGRAMS:
                yield Cast(library, runtime, _WITH_PROGRAMS[library], PROGRAMS)
    yield Cast(FOXGLOVE, "Node", ("foxglove",))
    yield Cast(FOXGLOVE_PROTOCOL, "Node", ("foxglove_protocol", "foxglove_schemas"))
    yield Cast(FOXGLOVE_PROTOCOL, "Chromium", ("foxglove_protocol",))


CASTS = tuple(_casts())


def playing(scenarios: str) -> pytest.MarkDecorator:
    """Run a module's tests for each client that plays these scenarios."""
    casts = [cast for cast in CASTS if scenarios in cast.scenarios]
    return pytest.mark.parametrize("cast", [marked(cast, id=str(cast)) for cast in casts])


def marked(cast: Cast, id: str) -> Any:
    """Return a test parameter with the marks that the client requires."""
    marks = {"Node": [pytest.mark.npm], "Chromium": [pytest.mark.npm, pytest.mark.browser]}
    return pytest.param(cast, id=id, marks=marks.get(cast.runtime, []))
