"""What a check has found."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal, TypeAlias

Verdict: TypeAlias = Literal["ok", "warning", "wrong"]


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at: how it is and, if that may not be, what to do."""

    check: str
    verdict: Verdict
    text: str
    advice: str = ""

    def as_json(self) -> dict[str, Any]:
        """All of it, fit for JSON."""
        return asdict(self)


def ok(check: str, text: str) -> Finding:
    """It is as it should be."""
    return Finding(check, "ok", text)


def warning(check: str, text: str, advice: str) -> Finding:
    """It may be meant to be so, or not."""
    return Finding(check, "warning", text, advice)


def wrong(check: str, text: str, advice: str) -> Finding:
    """So it cannot work."""
    return Finding(check, "wrong", text, advice)


def listed(names: list[str], most: int = 5) -> str:
    """The first of some names, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
