"""The profiles of random inputs."""

from __future__ import annotations

import pytest
from hypothesis import settings
from random_inputs import EXAMPLES, examples, times

LANDING, THOROUGH = settings.get_profile("landing"), settings.get_profile("thorough")


def test_default_inputs_are_the_same_in_each_run(request: pytest.FixtureRequest) -> None:
    chosen = request.config.getoption("--hypothesis-profile")
    assert settings.get_current_profile_name() == (chosen or "landing")
    assert LANDING.derandomize


def test_thorough_profile_tries_five_times_as_many_random_inputs() -> None:
    assert THOROUGH.max_examples == 5 * LANDING.max_examples
    assert not THOROUGH.derandomize
    assert THOROUGH.database is not None


def test_numbers_of_examples_follow_the_profile() -> None:
    assert EXAMPLES == settings().max_examples
    assert examples(0.5).max_examples == times(0.5) == EXAMPLES // 2
