"""Items of a callback queue are handled one after the other, in a thread of its own."""

from __future__ import annotations

import threading
from queue import SimpleQueue

import pytest
from rospy import core, log
from rospy.callback_queue import CallbackQueue, call


def test_items_are_handled_in_order_in_a_thread_of_the_name() -> None:
    handled: SimpleQueue[tuple[int, str]] = SimpleQueue()
    queue: CallbackQueue[int] = CallbackQueue(
        "/chatter", lambda item: handled.put((item, threading.current_thread().name))
    )
    for number in range(3):
        assert not queue.put(number)
    assert [handled.get(timeout=60) for _ in range(3)] == [
        (0, "/chatter"),
        (1, "/chatter"),
        (2, "/chatter"),
    ]
    queue.close()


def test_oldest_items_are_dropped_when_queue_is_full() -> None:
    handled: SimpleQueue[int] = SimpleQueue()
    begun, go_on = threading.Event(), threading.Event()

    def handle(item: int) -> None:
        begun.set()
        go_on.wait(60)
        handled.put(item)

    queue = CallbackQueue("slow", handle)
    queue.put(0, 2)
    assert begun.wait(60)
    assert [queue.put(number, 2) for number in range(1, 5)] == [False, False, True, True]
    assert len(queue) == 2
    go_on.set()
    assert [handled.get(timeout=60) for _ in range(3)] == [0, 3, 4]
    queue.close()


def test_closed_queue_handles_no_more_items() -> None:
    handled: list[int] = []
    begun, go_on = threading.Event(), threading.Event()
    threads: list[threading.Thread] = []

    def handle(item: int) -> None:
        threads.append(threading.current_thread())
        begun.set()
        go_on.wait(60)
        handled.append(item)

    queue = CallbackQueue("closed", handle)
    queue.put(1)
    queue.put(2)
    assert begun.wait(60)
    queue.close()
    go_on.set()
    threads[0].join(60)
    assert handled == [1]


def test_no_item_is_handled_after_shutdown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(core, "_shutdown", True)
    handled: list[int] = []
    queue = CallbackQueue("over", handled.append)
    queue.put(1)
    assert queue._thread is not None
    queue._thread.join(60)
    assert handled == []


def test_error_of_a_callback_is_logged(monkeypatch: pytest.MonkeyPatch) -> None:
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
    assert len(logged) == 1, "errors during shutdown are not logged"
    assert log.logerr is not logged.append
