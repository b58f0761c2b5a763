"""Nothing that clients do makes them, or the hub, log an error."""

from __future__ import annotations

import pytest

from .casts import CASTS, Cast, marked
from .conftest import Observe

UNAVOIDABLE: dict[str, str | tuple[str, ...]] = {
    # roslib 2.1.0 of the answer to its own cancelAllGoals, which is a call without an id.
    "actions": "console.error: Received service response without ID",
    # roslibpy's ActionClient of a status that arrives before its constructor has ended.
    "actionlib": "'ActionClient' object has no attribute 'wait_status'",
    "tutorials": "'ActionClient' object has no attribute 'wait_status'",
    # Chromium of the time between two hubs, and of the first one's last moments.
    "reconnection": ("net::ERR_CONNECTION_REFUSED", "Unexpected response code: 503"),
}
"""Complaints of clients that also occur with rosbridge_suite."""


@pytest.mark.long  # It plays again what the other tests have seen, and listens for complaints.
@pytest.mark.parametrize(
    "cast", [marked(cast, id=f"{cast}: {cast.scenarios[0]}") for cast in CASTS]
)
def test_no_client_logs_an_error(cast: Cast, observe: Observe) -> None:
    observations = observe(cast)
    complaints = observations.complaints
    for each in cast.scenarios:
        expected = UNAVOIDABLE.get(each, ())
        complaints = [complaint for complaint in complaints if not complaint.endswith(expected)]
    assert (complaints, observations.faults) == ([], [])
