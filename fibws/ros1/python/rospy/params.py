"""The parameters that all nodes share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rospy import names

if TYPE_CHECKING:
    from rospy.msproxy import MasterProxy

_MISSING: Any = object()

_master: MasterProxy | None = None


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
