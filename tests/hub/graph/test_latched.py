"""The bytes of latched messages and wills of all nodes together."""

from __future__ import annotations

from fibws.hub.graph.latched import LatchQuota, LatchTotal


class Latching:
    """A source with a latched message of so many bytes."""

    def __init__(self, node: Node, size: int, name: str = "/a") -> None:
        self.name = name
        self.quota = node.quota
        self.size = size
        self.quota.latched[self] = None
        self.quota.add(size)
        self.quota.total.make_room()

    @property
    def is_kept(self) -> bool:
        return self in self.quota.latched

    def forget_latched(self) -> None:
        del self.quota.latched[self]
        self.quota.add(-self.size)


class Node:
    """A node, whose owner is the first part of its name."""

    def __init__(self, total: LatchTotal, name: str) -> None:
        self.reports: list[str] = []
        self.quota = LatchQuota(None, total, name, self.reports.append)

    def latch(self, *sizes: int) -> list[Latching]:
        return [Latching(self, size, f"/t{number}") for number, size in enumerate(sizes)]


def total_of(limit: int) -> LatchTotal:
    return LatchTotal(limit, lambda node: node.split("/")[1])


def test_oldest_message_of_the_node_with_most_is_dropped() -> None:
    total = total_of(1000)
    small, large = Node(total, "/a"), Node(total, "/b")
    [first] = small.latch(300)
    kept = large.latch(250, 250, 250)
    assert [each.is_kept for each in (first, *kept)] == [True, False, True, True]
    assert (total.used, total.dropped) == (800, 1)
    [report] = large.reports
    assert "/t0" in report and "--max-total-latched-bytes" in report and "1000" in report
    assert small.reports == []


def test_owner_with_most_pays_by_its_largest_node() -> None:
    total = total_of(1600)
    robot = Node(total, "/robot")
    [map_] = robot.latch(600)
    pages = [Node(total, f"/pages/{number}") for number in range(4)]
    for number, page in enumerate(pages):
        page.latch(200 + 40 * number)
    assert map_.is_kept
    assert [len(page.reports) for page in pages] == [0, 0, 0, 1]


def test_much_is_dropped_in_one_go_with_one_report() -> None:
    total = total_of(10_000)
    node = Node(total, "/a")
    node.latch(*[1] * 5000, 5001)
    assert total.used <= 10_000 - 10_000 // 16
    assert total.dropped == 10_001 - total.used
    [report] = node.reports
    assert f"{total.dropped - 1} more topics" in report


def test_wills_stay_and_latched_messages_make_room_for_them() -> None:
    total = total_of(1000)
    willing, latching = Node(total, "/a"), Node(total, "/b")
    willing.quota.add(700)
    [first] = latching.latch(200)
    assert total.has_room(250)
    assert not first.is_kept
    willing.quota.add(250)
    [second] = latching.latch(100)
    assert not second.is_kept
    assert not total.has_room(100)


def test_will_that_never_fits_drops_nothing() -> None:
    total = total_of(1000)
    [latched] = Node(total, "/a").latch(500)
    assert not total.has_room(2000)
    assert latched.is_kept


def test_bytes_that_are_gone_do_not_count() -> None:
    total = total_of(1000)
    node = Node(total, "/a")
    for _ in range(5):
        [each] = node.latch(900)
        each.forget_latched()
    assert (total.used, total.dropped, total._quotas) == (0, 0, {})


def test_nodes_outside_of_the_hub_count_for_themselves() -> None:
    total = total_of(1000)
    robots = [Node(total, "") for _ in range(3)]
    messages = [Latching(each, size) for each, size in zip(robots, (300, 400, 310), strict=True)]
    assert [each.is_kept for each in messages] == [True, False, True]
