"""The state of the process's node: whether it is initialised, and how it comes to its end."""

from __future__ import annotations

import atexit
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from types import FrameType
from typing import Any

from rospy.background import Background

background = Background()
"""The node, on its loop."""

_lock = threading.RLock()
_shutting_down = False
_shutdown = threading.Event()
_hooks: list[Callable[[], object]] = []
_earlier_handlers: dict[int, Any] = {}


def is_initialized() -> bool:
    """Whether `init_node` was called and has found its hub."""
    return background.running


def is_shutdown() -> bool:
    """Whether the node has ended."""
    return _shutdown.is_set()


def is_shutdown_requested() -> bool:
    """Whether the node has ended, or is about to."""
    return _shutting_down


def wait_for_shutdown(timeout: float | None = None) -> bool:
    """Wait until the node has ended; tell whether it has.

    Args:
        timeout: the most seconds to wait.
    """
    return _shutdown.wait(timeout)


def add_client_shutdown_hook(hook: Callable[[], object]) -> None:
    """Have a function called when the node is about to end, while it can still publish."""
    with _lock:
        if not _shutting_down:
            _hooks.append(hook)
            return
    hook()


def signal_shutdown(reason: str) -> None:
    """End the node: the hooks of `add_client_shutdown_hook` come first, then the flag is set.

    Called again, it does nothing.
    """
    global _shutting_down
    with _lock:
        if _shutting_down:
            return
        _shutting_down = True
        hooks = list(_hooks)
    for hook in hooks:
        try:
            hook()
        except Exception:
            sys.stderr.write(f"signal_shutdown hook error[{hook}]\n")
            traceback.print_exc()
    _shutdown.set()
    background.stop()


def register_signals() -> None:
    """Have Ctrl-C and SIGTERM end the node; to be called in the main thread."""
    for number in (signal.SIGINT, signal.SIGTERM):
        _earlier_handlers[number] = signal.signal(number, _on_signal)


def _on_signal(number: int, frame: FrameType | None) -> None:
    signal_shutdown(f"signal-{number}")
    earlier = _earlier_handlers.get(number)
    if callable(earlier):
        try:
            earlier(number, frame)
        except KeyboardInterrupt:
            pass


def _on_exit() -> None:
    signal_shutdown("atexit")


atexit.register(_on_exit)
