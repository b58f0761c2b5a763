"""How long and how often to measure."""

from __future__ import annotations

from dataclasses import dataclass

HUB = "hub"
HUB_UVLOOP = "hub+uvloop"
HUBS = (HUB, HUB_UVLOOP)
RELAY = "relay"
NAIVE = "naive"


@dataclass(frozen=True)
class Plan:
    """The choices made on the command line."""

    reps: int = 5
    seconds: float = 3.0
    warm_seconds: float = 1.0
    uvloop: bool = False

    @property
    def hubs(self) -> tuple[str, ...]:
        """Return the names of the hubs to measure."""
        return HUBS if self.uvloop else (HUB,)


QUICK = Plan(reps=1, seconds=0.8, warm_seconds=0.3)
