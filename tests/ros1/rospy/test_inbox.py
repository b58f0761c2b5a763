"""Items are handled one after the other, in a thread of their own."""

from __future__ import annotations

import threading
from queue import SimpleQueue

import pytest
from rospy import core, log
from rospy.inbox import Inbox, call


def test_items_are_handled_in_order_in_a_thread_of_that_name() -> None:
    handled: SimpleQueue[tuple[int, str]] = SimpleQueue()
    inbox: Inbox[int] = Inbox(
        "/chatter", lambda item: handled.put((item, threading.current_thread().name))
    )
    for number in range(3):
        assert not inbox.put(number)
    assert [handled.get(timeout=60) for _ in range(3)] == [
        (0, "/chatter"),
        (1, "/chatter"),
        (2, "/chatter"),
    ]
    inbox.close()


def test_the_newest_items_wait_for_who_is_slow() -> None:
    handled: SimpleQueue[int] = SimpleQueue()
    begun, go_on = threading.Event(), threading.Event()

    def handle(item: int) -> None:
        begun.set()
        go_on.wait(60)
        handled.put(item)

    inbox = Inbox("slow", handle)
    inbox.put(0, 2)
    assert begun.wait(60)
    assert [inbox.put(number, 2) for number in range(1, 5)] == [False, False, True, True]
    assert len(inbox) == 2
    go_on.set()
    assert [handled.get(timeout=60) for _ in range(3)] == [0, 3, 4]
    inbox.close()


def test_what_is_closed_handles_nothing_more() -> None:
    handled: list[int] = []
    begun, go_on = threading.Event(), threading.Event()
    threads: list[threading.Thread] = []

    def handle(item: int) -> None:
        threads.append(threading.current_thread())
        begun.set()
        go_on.wait(60)
        handled.append(item)

    inbox = Inbox("closed", handle)
    inbox.put(1)
    inbox.put(2)
    assert begun.wait(60)
    inbox.close()
    go_on.set()
    threads[0].join(60)
    assert handled == [1]


def test_the_end_of_the_node_is_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(core, "_shutdown", True)
    handled: list[int] = []
    inbox = Inbox("over", handled.append)
    inbox.put(1)
    assert inbox._thread is not None
    inbox._thread.join(60)
    assert handled == []


def test_a_fault_goes_to_the_log(monkeypatch: pytest.MonkeyPatch) -> None:
    logged: list[str] = []
    monkeypatch.setattr("rospy.logerr", logged.append)

    def callback(number: int) -> None:
        raise ValueError(f"not {number}")

    call(callback, 5)
    (text,) = logged
    assert text.startswith(f"bad callback: {callback}\nTraceback (most recent call last):\n")
    assert text.endswith("ValueError: not 5\n")
    monkeypatch.setattr(core, "_shutdown", True)
    call(callback, 5)
    assert len(logged) == 1, "nobody minds what a callback does while all ends"
    assert log.logerr is not logged.append
