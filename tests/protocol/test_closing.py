"""Why the hub closes a connection."""

from __future__ import annotations

import pytest
from websockets.frames import Close

from fibws.protocol import closing
from fibws.protocol.closing import Closing

CLOSINGS = {name: each for name, each in vars(closing).items() if isinstance(each, Closing)}


@pytest.mark.parametrize("closing", CLOSINGS.values(), ids=CLOSINGS)
def test_every_closing_fits_into_a_close_frame(closing: Closing) -> None:
    close = Close(closing.code, closing.reason)
    close.check()
    assert len(close.serialize()) <= 125


def test_no_two_closings_give_the_same_reason() -> None:
    assert len({each.reason for each in CLOSINGS.values()}) == len(CLOSINGS) > 0
