"""What wakes the threads that sleep."""

from __future__ import annotations

import signal
import sys
import threading
from time import monotonic

import pytest
from rospy.bell import Bell


def test_who_waits_for_what_is_there_does_not_wait() -> None:
    assert Bell().wait(lambda: True)


def test_time_ends_the_waiting() -> None:
    began = monotonic()
    assert not Bell().wait(lambda: False, timeout=0.02)
    assert monotonic() - began >= 0.02


def test_a_ring_without_news_wakes_nobody() -> None:
    bell = Bell()
    asked = threading.Semaphore(0)
    news: list[str] = []

    def over() -> bool:
        asked.release()
        return bool(news)

    sleeper = threading.Thread(target=bell.wait, args=(over,))
    sleeper.start()
    asked.acquire()
    bell.ring()
    bell.ring()
    asked.acquire()
    assert sleeper.is_alive()
    news.append("it is over")
    bell.ring()
    sleeper.join(60)
    assert not sleeper.is_alive()


def test_it_rings_for_all() -> None:
    bell, over = Bell(), threading.Event()
    sleepers = [threading.Thread(target=bell.wait, args=(over.is_set,)) for _ in range(3)]
    for sleeper in sleepers:
        sleeper.start()
    over.set()
    bell.ring()
    for sleeper in sleepers:
        sleeper.join(60)
        assert not sleeper.is_alive()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no timer that sends signals")
def test_a_signal_may_ring_it() -> None:
    bell, rung = Bell(), threading.Event()

    def ring(number: int, frame: object) -> None:
        rung.set()
        bell.ring()

    earlier = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.01)
        assert bell.wait(rung.is_set, timeout=60)
    finally:
        signal.signal(signal.SIGALRM, earlier)
