"""How a program becomes a node."""

from __future__ import annotations

import logging
import os
import re
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import genpy
from rosgraph.names import PRIV_NAME, REMAP, is_legal_base_name, is_legal_remap, ns_join
from roslib import is_interactive

from rospy import console, core, names, rostime
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
    """The program was ended while it waited for its hub."""


def myargv(argv: Sequence[str] | None = None) -> list[str]:
    """The command line without what is ROS's: remappings and parameters."""
    return [each for each in (sys.argv if argv is None else argv) if not is_legal_remap(each)]


def load_command_line_node_params(argv: Sequence[str]) -> dict[str, Any]:
    """The node's own parameters that the command line sets, ``_x:=1``, with YAML values.

    Raises:
        ROSInitException: a value is no YAML.
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

    Called again with the same arguments, it does nothing.

    Args:
        name: a name with no namespace in it; ``__name:=`` goes before it.
        argv: the command line, if it is not the process's.
        anonymous: make the name one that no other node has.
        log_level: which lines are logged from then on, such as `rospy.DEBUG`; else from INFO on.
        disable_rostime: ignore the graph's simulated time.
        disable_rosout: do not publish what is logged.
        disable_signals: leave Ctrl-C to the program; needed outside of the main thread.
        xmlrpc_port: has no effect.
        tcpros_port: has no effect.

    Raises:
        ValueError: the name is not legal.
        ROSException: it was called with other arguments before.
        ROSInitException: the program was ended meanwhile, or the hub will not have the node.
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
    name, namespace = _named(name, anonymous), names.get_namespace()
    params = load_command_line_node_params(argv)
    logger = _logger(log_level)
    if not disable_signals:
        core.register_signals()
    full_name = ns_join(namespace, name)
    names._set_caller_id(full_name)
    names.initialize_mappings(full_name)

    def node() -> fibws.Node:
        import fibws

        return fibws.Node(name, namespace=namespace, log=logger, rosout=not disable_rosout)

    _start(node)
    _arguments = arguments
    for key, value in params.items():
        logdebug("setting param %s to %s", key, value)
        set_param(PRIV_NAME + key, value)
    if not disable_rostime:
        _use_simulated_time()
    rostime.set_rostime_initialized(True)
    core.started()
    logdebug("init_node, name[%s], pid[%s]", full_name, os.getpid())


def on_shutdown(h: Callable[[], object]) -> None:
    """Have a function called when the node is about to end, while it can still publish.

    Raises:
        TypeError: it is none.
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
    """The topics that somebody publishes, as pairs of name and type.

    Args:
        namespace: only those in it.

    Raises:
        ROSException: the hub refuses.
    """
    code, text, topics = get_master().getPublishedTopics(namespace)
    if code != 1:
        raise ROSException(f"unable to get published topics: {text}")
    return list(topics)


def get_master(env: object = None) -> MasterProxy:
    """The hub, in the place of ROS's master.

    Args:
        env: has no effect: the hub is where $FIBWS_HUB says.
    """
    global _master
    if _master is None:
        from rospy.msproxy import MasterProxy

        _master = MasterProxy()
    return _master


def get_param(param_name: str, default: Any = _MISSING) -> Any:
    """The value of a parameter, or all of a namespace as a dict; or else the default.

    Raises:
        KeyError: there is neither.
    """
    try:
        return get_master()[param_name]
    except KeyError:
        if default is _MISSING:
            raise
        return default


def get_param_cached(param_name: str, default: Any = _MISSING) -> Any:
    """The same as `get_param`: the hub answers fast, and nobody sees an old value."""
    return get_param(param_name, default)


def get_param_names() -> list[str]:
    """The names of all parameters."""
    return list(get_master())


def set_param(param_name: str, param_value: Any) -> None:
    """Set a parameter; a dict takes the place of a whole namespace.

    Raises:
        TypeError, ValueError: JSON cannot hold the value, or something in it is None.
        ROSException: the hub refuses.
    """
    names.warn_unless_legal(param_name, stacklevel=3)
    get_master()[param_name] = param_value


def delete_param(param_name: str) -> None:
    """Delete a parameter, or all of a namespace.

    Raises:
        KeyError: there is none.
    """
    del get_master()[param_name]


def has_param(param_name: str) -> bool:
    """Whether there is a parameter or a namespace of this name."""
    return param_name in get_master()


def search_param(param_name: str) -> str | None:
    """The global name of the parameter of this name that is nearest, if there is one.

    It is looked for in the node's own namespace (``/robot/talker``), then in each above.
    """
    return get_master().search_param(param_name)


def _named(name: str, anonymous: bool) -> str:
    """What the node is called, with no namespace."""
    from fibws.names import anonymous as anonymous_name
    from fibws.names import check_base

    if remapped := names.get_mappings().get("__name"):
        return check_base(remapped)
    if not is_legal_base_name(name):
        name = _mended(name)
    if anonymous:
        name = anonymous_name(name, pid=os.getpid(), random=os.urandom(8))
    return check_base(name)


def _mended(name: str) -> str:
    """A legal name in the place of one that ROS only warns of; the hub would not have it."""
    legal = re.sub(r"\W", "_", name, flags=re.ASCII)
    legal = legal if legal[0].isalpha() else f"node_{legal.lstrip('_')}"
    warnings.warn(
        f"'{name}' is not a legal ROS base name. This may cause problems with other ROS tools. "
        f"Here the node is called '{legal}'.",
        stacklevel=4,
    )
    return legal


def _logger(log_level: int | None) -> logging.Logger:
    """The logger of the node, which begins to write."""
    logger = logging.getLogger("rosout")
    logger.setLevel(logging.INFO if log_level is None else PYTHON_LEVELS[log_level])
    if not logger.propagate:
        return logger  # An earlier call has done the rest, but found no hub that would have it.
    logger.propagate = False  # A root logger that writes to the console would say all twice.
    logger.addHandler(console.Console())
    logger.addFilter(_say_roscore)
    if path := names.get_mappings().get("__log"):
        logger.addHandler(console.log_file(path))
    return logger


def _say_roscore(record: logging.LogRecord) -> bool:
    """Who runs a script of ROS knows the hub by the name that it has there."""
    if isinstance(record.msg, str):
        record.msg = record.msg.replace("python -m fibws.hub", "roscore")
    return True


def _start(node: Callable[[], fibws.Node]) -> None:
    from fibws.errors import NodeError

    try:
        core.background.start(node, _ended)
    except ROSInterruptException:
        raise _InitInterrupted("init_node interrupted before it could complete") from None
    except NodeError as error:
        raise ROSInitException(str(error)) from None


def _use_simulated_time() -> None:
    """Follow the topic /clock if the parameter /use_sim_time says so; the time is 0 at first."""
    if get_param("/use_sim_time", False):
        rostime.set_rostime(genpy.Time())
        core.background.begin(_follow_clock(core.background.node))


async def _follow_clock(node: fibws.Node) -> None:
    clock: fibws.Subscription[Any] = node.subscribe("/clock", "rosgraph_msgs/Clock", queue_size=1)
    async for message in clock:
        rostime.set_rostime(genpy.Time(message.clock.secs, message.clock.nsecs))


def _ended(fault: Exception) -> None:
    """End the program's node in good order, since the hub has ended it."""
    from fibws.errors import NodeKilled, NodeReplaced

    if isinstance(fault, NodeReplaced):
        reason = f"[{names.get_name()}] Reason: new node registered with same name"
    elif isinstance(fault, NodeKilled):
        reason = "user request"
    else:
        reason = str(fault)
    print(f"shutdown request: {reason}", flush=True)
    core.signal_shutdown(f"external shutdown request: [{reason}]")
