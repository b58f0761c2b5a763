"""Starting a node, and its parameters."""

from __future__ import annotations

import logging
import os
import re
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import genpy
from rosgraph.names import PRIV_NAME, REMAP, is_legal_base_name, is_legal_remap, ns_join
from roslib import is_interactive

from rospy import core, names, rostime
from rospy.exceptions import ROSException, ROSInitException, ROSInterruptException
from rospy.log import DEBUG, ERROR, FATAL, INFO, PYTHON_LEVELS, WARN, logdebug

if TYPE_CHECKING:
    import fibws
    from rospy.msproxy import MasterProxy

__all__ = [
    "DEBUG",
    "ERROR",
    "FATAL",
    "INFO",
    "WARN",
    "delete_param",
    "get_master",
    "get_param",
    "get_param_cached",
    "get_param_names",
    "get_published_topics",
    "has_param",
    "init_node",
    "load_command_line_node_params",
    "myargv",
    "on_shutdown",
    "search_param",
    "set_param",
    "spin",
]

_MISSING: Any = object()

_arguments: tuple[Any, ...] | None = None
_master: MasterProxy | None = None


class _InitInterrupted(ROSInitException, ROSInterruptException):
    """The program was interrupted while it waited for its hub."""


def myargv(argv: Sequence[str] | None = None) -> list[str]:
    """Return the command line without ROS's arguments: remappings and parameters."""
    return [each for each in (sys.argv if argv is None else argv) if not is_legal_remap(each)]


def load_command_line_node_params(argv: Sequence[str]) -> dict[str, Any]:
    """Return the node's parameters on the command line, ``_x:=1``; their values are YAML.

    Raises:
        ROSInitException: a value is invalid YAML.
    """
    params = {}
    for argument in argv:
        if not is_legal_remap(argument):
            continue
        name, _, value = (part.strip() for part in argument.partition(REMAP))
        if len(name) < 2 or not value or not name.startswith("_") or name.startswith("__"):
            continue
        import yaml

        try:
            params[name[1:]] = yaml.safe_load(value)
        except yaml.YAMLError as error:
            raise ROSInitException(f"invalid command-line parameters: {error}") from None
    return params


def init_node(
    name: str,
    argv: Sequence[str] | None = None,
    anonymous: bool = False,
    log_level: int | None = None,
    disable_rostime: bool = False,
    disable_rosout: bool = False,
    disable_signals: bool = False,
    xmlrpc_port: int = 0,
    tcpros_port: int = 0,
) -> None:
    """Make this process a node, and wait until its hub answers.

    Further calls with the same arguments do nothing.

    Args:
        name: the node's name without a namespace; ``__name:=`` overrides it.
        argv: the command line; by default the process's.
        anonymous: make the name unique.
        log_level: the lowest level to log, such as `rospy.DEBUG`; by default INFO.
        disable_rostime: ignore simulated time.
        disable_rosout: do not publish the log.
        disable_signals: do not handle Ctrl-C; required outside of the main thread.
        xmlrpc_port: has no effect.
        tcpros_port: has no effect.

    Raises:
        ValueError: the name is not legal.
        ROSException: it was called with different arguments before.
        ROSInitException: the program was interrupted, or the hub refuses the node.
    """
    global _arguments
    if argv is None:
        argv = sys.argv
    else:
        names.reload_mappings(argv)
    if not name:
        raise ValueError("name must not be empty")
    if "/" in name:
        raise ValueError("namespaces are not allowed in node names")
    disable_signals = disable_signals or is_interactive()
    arguments = (name, argv, anonymous, log_level, disable_rostime, disable_signals)
    if _arguments is not None:
        if _arguments != arguments:
            raise ROSException(
                f"rospy.init_node() has already been called with different arguments: {_arguments}"
            )
        return
    name, namespace = _node_name(name, anonymous), names.get_namespace()
    params = load_command_line_node_params(argv)
    logger = _logger(ns_join(namespace, name), log_level)
    if not disable_signals:
        core.register_signals()
    full_name = ns_join(namespace, name)
    names._set_caller_id(full_name)
    names.initialize_mappings(full_name)

    def node() -> fibws.Node:
        import fibws

        class Node(fibws.Node):
            _needs_legal_names = False

        return Node(
            name,
            namespace=namespace,
            log=logger,
            rosout=not disable_rosout,
            use_sim_time=False,  # `_use_simulated_time` does it for rospy's own clock.
        )

    _start(node)
    _arguments = arguments
    with _refusals():
        for key, value in params.items():
            logdebug("setting param %s to %s", key, value)
            set_param(PRIV_NAME + key, value)
        if not disable_rostime:
            _use_simulated_time()
    rostime.set_rostime_initialized(True)
    core.started()
    logdebug("init_node, name[%s], pid[%s]", full_name, os.getpid())


def on_shutdown(h: Callable[[], object]) -> None:
    """Call a function when the node is about to end, while it can still publish.

    Raises:
        TypeError: it is not callable.
    """
    core.add_client_shutdown_hook(h)


def spin() -> None:
    """Wait until the node ends; Ctrl-C ends it.

    Raises:
        ROSInitException: `init_node` has not been called.
    """
    if not core.is_initialized():
        raise ROSInitException("client code must call rospy.init_node() first")
    uri = core.get_node_uri()
    logdebug("node[%s, %s] entering spin(), pid[%s]", names.get_name(), uri, os.getpid())
    try:
        core.wait_for_shutdown()
    except KeyboardInterrupt:
        logdebug("keyboard interrupt, shutting down")
        core.signal_shutdown("keyboard interrupt")


def get_published_topics(namespace: str = "/") -> list[list[str]]:
    """Return the published topics as pairs of name and type.

    Args:
        namespace: their namespace.

    Raises:
        ROSException: the hub refuses.
    """
    code, text, topics = get_master().getPublishedTopics(namespace)
    if code != 1:
        raise ROSException(f"unable to get published topics: {text}")
    return list(topics)


def get_master(env: object = None) -> MasterProxy:
    """Return the hub as a substitute for ROS's master.

    Args:
        env: ignored; $FIBWS_HUB has the hub's address.
    """
    global _master
    if _master is None:
        from rospy.msproxy import MasterProxy

        _master = MasterProxy()
    return _master


def get_param(param_name: str, default: Any = _MISSING) -> Any:
    """Return the value of a parameter, a namespace as a dict, or the default.

    Raises:
        KeyError: the parameter is not set, and there is no default.
    """
    try:
        return get_master()[param_name]
    except KeyError:
        if default is _MISSING:
            raise
        return default


def get_param_cached(param_name: str, default: Any = _MISSING) -> Any:
    """Return the same as `get_param`; there is no cache, as the hub answers fast."""
    return get_param(param_name, default)


def get_param_names() -> list[str]:
    """Return the names of all parameters."""
    return list(get_master())


def set_param(param_name: str, param_value: Any) -> None:
    """Set a parameter; a dict replaces a namespace.

    Raises:
        TypeError: a parameter cannot have this value, such as None.
        ROSException: the hub refuses.
    """
    names.warn_unless_legal(param_name, stacklevel=3)
    get_master()[param_name] = param_value


def delete_param(param_name: str) -> None:
    """Delete a parameter or a namespace.

    Raises:
        KeyError: it is not set.
    """
    del get_master()[param_name]


def has_param(param_name: str) -> bool:
    """Return whether a parameter or a namespace exists."""
    return param_name in get_master()


def search_param(param_name: str) -> str | None:
    """Return the global name of the nearest parameter of this name, or None.

    It is searched in the node's own namespace (``/robot/talker``), then in each parent.
    """
    return get_master().search_param(param_name)


def _node_name(name: str, anonymous: bool) -> str:
    """Return the node's name without a namespace."""
    from fibws.names import anonymous as anonymous_name
    from fibws.names import check_base

    remapped = names.get_mappings().get("__name")
    name = remapped or name
    if "/" in name:
        check_base(name)
    if not is_legal_base_name(name):
        name = _possible_name(name)
    if anonymous and not remapped:
        name = anonymous_name(name, pid=os.getpid(), random=os.urandom(8))
    return name


def _possible_name(name: str) -> str:
    """Warn about a name that is not legal, and return one that the hub accepts.

    It refuses whitespace and control characters, and # in the node's services.
    """
    possible = re.sub(r"^~|[\s#]", "_", name)
    possible = "".join(each if each.isprintable() else "_" for each in possible)
    changed = f" The node's name is '{possible}'." if possible != name else ""
    warnings.warn(
        f"'{name}' is not a legal ROS base name. This may cause problems with other ROS tools."
        + changed,
        stacklevel=4,
    )
    return possible


def _logger(name: str, log_level: int | None) -> logging.Logger:
    """Set up and return the node's logger."""
    logger = logging.getLogger("rosout")
    logger.setLevel(logging.INFO if log_level is None else PYTHON_LEVELS[log_level])
    if not logger.propagate:
        return logger  # An earlier call did this, but its node was refused.
    from rospy import console  # It loads the node library, which every node needs.

    logger.propagate = False  # A root logger for the console would print all lines twice.
    logger.addHandler(console.Console())
    path = names.get_mappings().get("__log")
    file = console.log_file(path or _default_log_file(name))
    if path:
        logger.addHandler(file)
    # As in ROS, other loggers print nothing, neither by themselves nor by `basicConfig`.
    root = logging.getLogger()
    root.setLevel(logging.INFO)
    root.addHandler(file)
    return logger


def _default_log_file(name: str) -> str:
    import rospkg

    return os.path.join(rospkg.get_log_dir(), f"{name.strip('/').replace('/', '_')}.log")


def _start(node: Callable[[], fibws.Node]) -> None:
    try:
        with _refusals():
            core.background.start(node, _ended)
    except ROSInterruptException:
        raise _InitInterrupted("init_node interrupted before it could complete") from None


@contextmanager
def _refusals() -> Iterator[None]:
    """Raise `ROSInitException` if the hub refuses the node, which may be during its first calls."""
    from fibws.errors import NodeError, ServiceError

    try:
        yield
    except ServiceError:
        raise  # A parameter is at fault.
    except NodeError as error:
        raise ROSInitException(str(error)) from None


def _use_simulated_time() -> None:
    """Follow the topic /clock if the parameter /use_sim_time is true; the time starts at 0."""
    if get_param("/use_sim_time", False):
        rostime.set_rostime(genpy.Time())
        core.background.begin(_follow_clock(core.background.node))


async def _follow_clock(node: fibws.Node) -> None:
    from fibws.node.clock import CLOCK_QUEUE

    def take(message: Any) -> None:
        rostime.set_rostime(genpy.Time(message.clock.secs, message.clock.nsecs))

    clock: fibws.Subscription[Any] = node.subscribe(
        "/clock", "rosgraph_msgs/Clock", queue_size=CLOCK_QUEUE
    )
    clock._hand_to(take)  # In the order in which the hub sent it among all messages.
    async for _ in clock:
        pass


def _ended(fault: Exception) -> None:
    """Shut the program's node down after the hub has ended it."""
    from fibws.errors import NodeKilled, NodeReplaced

    if isinstance(fault, NodeReplaced):
        reason = f"[{names.get_name()}] Reason: new node registered with same name"
    elif isinstance(fault, NodeKilled):
        reason = "user request"
    else:
        reason = str(fault)
    print(f"shutdown request: {reason}", flush=True)
    core.signal_shutdown(f"external shutdown request: [{reason}]")
