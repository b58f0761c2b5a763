"""Threads wait for conditions, and are woken to check them."""

from __future__ import annotations

import signal
import sys
import threading
from time import monotonic

import pytest
from rospy.wakeup import Wakeup


def test_true_condition_needs_no_wait() -> None:
    assert Wakeup().wait(lambda: True)


def test_wait_ends_after_its_timeout() -> None:
    began = monotonic()
    assert not Wakeup().wait(lambda: False, timeout=0.02)
    assert monotonic() - began >= 0.02


def test_thread_goes_on_waiting_while_its_condition_is_false() -> None:
    wakeup = Wakeup()
    checked = threading.Semaphore(0)
    news: list[str] = []

    def condition() -> bool:
        checked.release()
        return bool(news)

    sleeper = threading.Thread(target=wakeup.wait, args=(condition,))
    sleeper.start()
    checked.acquire()
    wakeup.wake_all()
    wakeup.wake_all()
    checked.acquire()
    assert sleeper.is_alive()
    news.append("true")
    wakeup.wake_all()
    sleeper.join(60)
    assert not sleeper.is_alive()


def test_all_threads_are_woken() -> None:
    wakeup, over = Wakeup(), threading.Event()
    sleepers = [threading.Thread(target=wakeup.wait, args=(over.is_set,)) for _ in range(3)]
    for sleeper in sleepers:
        sleeper.start()
    over.set()
    wakeup.wake_all()
    for sleeper in sleepers:
        sleeper.join(60)
        assert not sleeper.is_alive()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no timer that sends signals")
def test_signal_handler_may_wake_threads() -> None:
    wakeup, woken = Wakeup(), threading.Event()

    def ring(number: int, frame: object) -> None:
        woken.set()
        wakeup.wake_all()

    earlier = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.01)
        assert wakeup.wait(woken.is_set, timeout=60)
    finally:
        signal.signal(signal.SIGALRM, earlier)
