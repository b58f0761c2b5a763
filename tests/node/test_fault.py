"""How a node raises what ended it."""

from __future__ import annotations

import traceback

import pytest

from fibws.errors import NodeClosed
from fibws.node.fault import throw


def test_a_traceback_does_not_grow() -> None:
    fault = NodeClosed("the node has ended")
    lengths = set()
    for _ in range(3):
        with pytest.raises(NodeClosed):
            throw(fault)
        lengths.add(len(traceback.extract_tb(fault.__traceback__)))
    assert len(lengths) == 1
