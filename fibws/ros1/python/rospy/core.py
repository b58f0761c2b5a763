"""The state of the process's node: initialisation and shutdown."""

from __future__ import annotations

import atexit
import signal
import sys
import threading
from collections.abc import Callable, Coroutine
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from fibws.exit_signals import ExitSignals, end_at_once
from rospy.background import Background
from rospy.exceptions import ROSInterruptException
from rospy.names import get_caller_id
from rospy.wakeup import Wakeup

if TYPE_CHECKING:
    from fibws.node.peers import Peers

__all__ = [
    "Connection",
    "add_client_shutdown_hook",
    "add_preshutdown_hook",
    "add_shutdown_hook",
    "ask",
    "background",
    "get_caller_id",
    "get_node_uri",
    "has_noticed_shutdown",
    "is_initialized",
    "is_shutdown",
    "is_shutdown_requested",
    "on_start",
    "peer_names",
    "register",
    "register_signals",
    "signal_shutdown",
    "started",
    "wait_for_shutdown",
    "wakeup",
]

PATIENCE = 1.0
"""Most seconds to wait for a response of the hub, for example while there is none."""

T = TypeVar("T")

background = Background()
"""The node, on its loop."""

wakeup = Wakeup()
"""Wakes threads when the node ends, and when simulated time has changed."""

_lock = threading.RLock()
_initialized = False
_shutting_down = False
_shutdown = False
_thread = threading.local()
_starters: list[Callable[[], object]] = []
_client_hooks: list[Callable[[], object]] = []
_early_hooks: list[Callable[[str], object]] = []
_late_hooks: list[Callable[[str], object]] = []
_earlier_handlers: dict[int, Any] = {}


def is_initialized() -> bool:
    """Return whether `init_node` was called and has found its hub."""
    return _initialized


def is_shutdown() -> bool:
    """Return whether the node has ended."""
    if _shutdown:
        _thread.has_noticed = True
    return _shutdown


def has_noticed_shutdown() -> bool:
    """Return whether the node has ended, and this thread has learned that from `is_shutdown`.

    A thread that waited for something until the node's end has learned it, too.
    """
    return _shutdown and getattr(_thread, "has_noticed", False)


def is_shutdown_requested() -> bool:
    """Return whether the node has ended, or is about to."""
    return _shutting_down


def get_node_uri() -> str | None:
    """Return the node's address on its hub; None before `init_node`."""
    if not background.running:
        return None
    return f"{background.node.hub.rstrip('/')}/?node={background.node.name}"


def wait_for_shutdown(timeout: float | None = None) -> bool:
    """Wait until the node has ended; return whether it has.

    Args:
        timeout: the most seconds to wait.
    """
    return wakeup.wait(is_shutdown, timeout)


def on_start(function: Callable[[], object]) -> None:
    """Call a function when the node runs: at once if it does, else in `init_node`.

    Functions that wait for `init_node` are called in its thread, in the order of registration.
    """
    with _lock:
        if not background.running:
            _starters.append(function)
            return
    function()


def started() -> None:
    """Call the functions of `on_start`: the node runs."""
    global _initialized
    _initialized = True
    while True:
        with _lock:
            if not _starters:
                return
            function = _starters.pop(0)
        function()


def register(kind: str, name: str, registering: Coroutine[Any, Any, None]) -> None:
    """Register a topic or a service with the hub; as in ROS, an illegal name is only logged.

    Args:
        kind: ``publication``, ``subscription`` or ``service``.
        name: its global name.
        registering: registers it, in the node's loop.
    """
    from fibws.errors import InvalidName

    try:
        background.call(registering)
    except InvalidName as error:
        from rospy import logfatal

        logfatal(f"unable to register {kind} [{name}] with master: {error}")


def ask(question: Coroutine[Any, Any, T], default: T) -> T:
    """Return the hub's response, or the default if it does not respond in time, or refuses.

    Args:
        question: asks the hub.
        default: the default.
    """
    from fibws.errors import FibwsError

    try:
        return background.call(question, PATIENCE)
    except (FibwsError, TimeoutError, ROSInterruptException):
        return default


class Connection(NamedTuple):
    """A node at the other side of a topic, under the names of ROS's transports.

    Attributes:
        endpoint_id: the node's global name.
        callerid_pub: the publishing node's.
    """

    endpoint_id: str
    callerid_pub: str


def peer_names(peers: Peers, question: Coroutine[Any, Any, list[str]]) -> list[str]:
    """Return the nodes at the other side of a topic.

    Args:
        peers: the nodes as the hub reports them.
        question: asks a rosbridge_suite server for them, which does not report them.
    """
    if peers.known:
        question.close()
        return peers.names
    return ask(question, [])


def add_client_shutdown_hook(hook: Callable[[], object]) -> None:
    """Call a function when the node is about to end, while it can still publish.

    Raises:
        TypeError: it is not callable.
    """
    if not _keep(hook, _client_hooks):
        hook()


def add_preshutdown_hook(hook: Callable[[str], object]) -> None:
    """Call a function with the reason of the node's end, after those of the client.

    Raises:
        TypeError: it is not callable.
    """
    if not _keep(hook, _early_hooks):
        hook("already shutdown")


def add_shutdown_hook(hook: Callable[[str], object]) -> None:
    """Call a function with the reason of the node's end, once `is_shutdown` is true.

    Raises:
        TypeError: it is not callable.
    """
    if not _keep(hook, _late_hooks):
        hook("already shutdown")


def _keep(hook: Callable[..., object], hooks: list[Callable[..., object]]) -> bool:
    """Keep a hook for later; return False if the node has ended."""
    if not callable(hook):
        raise TypeError(
            f"shutdown hook [{hook}] must be a function or callable object: {type(hook)}"
        )
    with _lock:
        if not _shutdown:
            hooks.append(hook)
        return not _shutdown


def signal_shutdown(reason: str) -> None:
    """End the node: the hooks of `add_client_shutdown_hook` come first, then the flag is set.

    Called again, it does nothing.
    """
    if _begin_end(reason):
        background.stop()


def _begin_end(reason: str) -> bool:
    """Do everything except wait for the node's end; return False if it was begun before."""
    global _shutting_down, _shutdown
    with _lock:
        if _shutting_down:
            return False
        _shutting_down = True
    _call_all(_client_hooks)
    _call_all(_early_hooks, reason)
    _shutdown = True
    wakeup.wake_all()
    _call_all(_late_hooks, reason)
    background.stop(timeout=0)
    return True


def _call_all(hooks: list[Callable[..., object]], *arguments: str) -> None:
    """Call each hook once, including hooks that are added meanwhile."""
    while hooks:
        hook = hooks.pop(0)
        try:
            hook(*arguments)
        except (Exception, SystemExit):  # It must not keep the node from its end.
            import traceback

            traceback.print_exc()


def register_signals() -> None:
    """End the node on Ctrl-C and SIGTERM; call this in the main thread.

    A `ROSInterruptException` after that is not printed, and the exit code is 0.

    Raises:
        ValueError: this is another thread.
    """
    signals = ExitSignals(_on_signal, _on_later_signal)
    for number in (signal.SIGINT, signal.SIGTERM):
        earlier = signal.signal(number, signals.receive)
        _earlier_handlers[number] = signal.SIG_DFL if earlier is None else earlier
    background.loop_lock.allows_main_thread = True
    _silence_interruptions()


def _on_signal(number: int) -> None:
    """End the node; the main thread notices it through `is_shutdown`, or an exception.

    This does not wait for the node's end: the main thread may hold a lock that the node needs.
    """
    if background.loop_lock.defer(partial(_on_signal, number)):
        return
    background.loop_lock.allows_main_thread = False
    _begin_end(f"signal-{number}")
    earlier = _earlier_handlers.get(number)
    # Python's own only raises KeyboardInterrupt: catching that might catch a later signal's, too.
    if callable(earlier) and earlier is not signal.default_int_handler:
        try:
            earlier(number, None)
        except KeyboardInterrupt:
            pass


def _on_later_signal(number: int) -> None:
    """Handle a signal as if this were no node: that ends the process, unless the script differs."""
    for each, handler in _earlier_handlers.items():
        signal.signal(each, handler)
    earlier = _earlier_handlers[number]
    if callable(earlier):
        earlier(number, None)
    elif earlier != signal.SIG_IGN:
        end_at_once(number)


def _silence_interruptions() -> None:
    """Print no `ROSInterruptException` after the node's end, and exit with code 0."""
    show, show_in_thread = sys.excepthook, threading.excepthook

    def excepthook(kind: type[BaseException], error: BaseException, traceback: Any) -> None:
        if _shutdown and issubclass(kind, ROSInterruptException):
            raise SystemExit(0)  # An excepthook can set the exit code only this way.
        show(kind, error, traceback)

    def thread_excepthook(arguments: threading.ExceptHookArgs) -> None:
        if not (_shutdown and issubclass(arguments.exc_type, ROSInterruptException)):
            show_in_thread(arguments)

    sys.excepthook, threading.excepthook = excepthook, thread_excepthook


def _on_exit() -> None:
    signal_shutdown("atexit")
    background.stop()


atexit.register(_on_exit)

if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """Return functions and classes that rospy has here, too, such as ``rospy.core.logwarn``."""
        if not name.startswith("_"):
            for home in ("rospy.log", "rospy.names", "rospy.exceptions"):
                value = getattr(import_module(home), name, None)
                if callable(value):
                    return value
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
