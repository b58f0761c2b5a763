"""How many random inputs tests try: by default few, which are the same in each run.

``--hypothesis-profile=thorough`` tries five times as many, others each time.
"""

from __future__ import annotations

from hypothesis import settings

EXAMPLES = settings().max_examples
"""The profile's number; import this after tests/conftest.py, as all test modules do."""


def examples(factor: float) -> settings:
    """Return settings for `factor` times as many examples as the profile has."""
    return settings(max_examples=times(factor))


def times(factor: float) -> int:
    """Return how often a hand-written loop over random inputs runs, at least once."""
    return max(1, round(factor * EXAMPLES))
