"""Which of two nodes of one name stays, by a clock of the test."""

from __future__ import annotations

from typing import cast

import pytest

from fibws.hub.federation.announced import PeerGraph
from fibws.hub.federation.precedence import SAME_AGE, Ages, NodeOffer
from fibws.hub.federation.records import HubInfo, NodeRecord


def offer(hub: str, since: int) -> NodeOffer:
    record = NodeRecord(path=(HubInfo(id=16 * hub, name=hub),), since=since)
    return NodeOffer(cast(PeerGraph, None), record, since)


@pytest.mark.parametrize("other", ["a", "c"])
@pytest.mark.parametrize("younger", [SAME_AGE, 2 * SAME_AGE])
def test_older_node_stays(other: str, younger: int) -> None:
    ages = Ages(16 * "b", now=lambda: 10**18)
    ages.note("nodes", "/robot", object())
    assert ages.is_own_older(offer(other, 10**18 + younger), "/robot")
    assert not ages.is_own_older(offer(other, 10**18 - younger), "/robot")


@pytest.mark.parametrize(("other", "is_own"), [("a", False), ("c", True)])
@pytest.mark.parametrize("difference", [1 - SAME_AGE, 0, SAME_AGE - 1])
def test_hub_decides_between_nodes_of_about_the_same_age(
    other: str, is_own: bool, difference: int
) -> None:
    ages = Ages(16 * "b", now=lambda: 10**18)
    ages.note("nodes", "/robot", object())
    assert ages.is_own_older(offer(other, 10**18 + difference), "/robot") is is_own
