"""The bytes of latched messages and wills of all nodes together."""

from __future__ import annotations

from fibws.hub.graph.latched import LatchQuota, LatchTotal


class Latching:
    """A source with a latched message of so many bytes."""

    def __init__(self, quota: LatchQuota, size: int, name: str = "/a") -> None:
        self.name = name
        self.quota = quota
        self.size = size
        self.quota.latched[self] = None
        self.quota.add(size)

    @property
    def is_kept(self) -> bool:
        return self in self.quota.latched

    def forget_latched(self) -> None:
        del self.quota.latched[self]
        self.quota.add(-self.size)


class Node:
    """A node with a quota in a total."""

    def __init__(self) -> None:
        self.reports: list[str] = []
        self.grown: list[int] = []
        self.total = LatchTotal()
        self.total.on_grow = self.grown.append
        self.quota = LatchQuota(None, self.total, "/a", self.reports.append)

    def latch(self, *sizes: int) -> list[Latching]:
        return [Latching(self.quota, size, f"/t{number}") for number, size in enumerate(sizes)]


def test_oldest_messages_are_dropped_until_the_rest_fits() -> None:
    node = Node()
    messages = node.latch(250, 250, 250)
    node.quota.shorten(500, "it is too much")
    assert [each.is_kept for each in messages] == [False, True, True]
    assert (node.total.used, node.total.dropped) == (500, 1)
    assert node.reports == ["the message of /t0 is not latched any more: it is too much"]


def test_much_is_dropped_with_one_report() -> None:
    node = Node()
    node.latch(*[1] * 5000)
    node.quota.shorten(100, "it is too much")
    assert (node.total.used, node.total.dropped) == (100, 4900)
    [report] = node.reports
    assert "/t0 and of 4899 more topics" in report


def test_wills_stay() -> None:
    node = Node()
    node.quota.add(700)
    node.latch(200)
    node.quota.shorten(0, "it is too much")
    assert (node.total.used, list(node.total.quotas)) == (700, [node.quota])


def test_nothing_is_reported_if_nothing_is_dropped() -> None:
    node = Node()
    node.latch(200)
    node.quota.shorten(200, "it is too much")
    assert (node.reports, node.total.dropped) == ([], 0)


def test_bytes_that_are_gone_do_not_count() -> None:
    node = Node()
    for _ in range(5):
        [each] = node.latch(900)
        each.forget_latched()
    assert (node.total.used, node.total.quotas) == (0, {})
    assert node.grown == [900] * 5
