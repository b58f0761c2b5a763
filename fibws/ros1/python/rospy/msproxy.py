"""The hub as a substitute for ROS's master, which `rospy.get_master` returns."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from rosgraph.masterapi import Master, MasterError, MasterFailure

from rospy import core, names
from rospy.exceptions import ROSException

TYPES = {
    "/rosapi/delete_param": "rosapi/DeleteParam",
    "/rosapi/get_param": "rosapi/GetParam",
    "/rosapi/get_param_names": "rosapi/GetParamNames",
    "/rosapi/get_time": "rosapi/GetTime",
    "/rosapi/graph": "fibws_msgs/GetGraph",
    "/rosapi/has_param": "rosapi/HasParam",
    "/rosapi/search_param": "rosapi/SearchParam",
    "/rosapi/set_param": "rosapi/SetParam",
    "/rosapi/topics": "rosapi/Topics",
}
"""The types of the hub's services that are called here."""

_CODES = {MasterError: -1, MasterFailure: 0}


class MasterProxy:
    """Sends requests to the hub; a mapping of all parameters.

    The methods of `rosgraph.Master` are available, too. They resolve names as the node does, and
    return what ROS's master did: 1, a text and the value; or -1 or 0, an error text and 0.

    Args:
        uri: ignored; $FIBWS_HUB has the hub's address.
    """

    def __init__(self, uri: str | None = None) -> None:
        self.target = _Master(names.get_name(), uri)

    def __getattr__(self, key: str) -> Callable[..., tuple[int, str, Any]]:
        method = getattr(self.target, key)

        def ask(*arguments: Any) -> tuple[int, str, Any]:
            try:
                resolved = [names.resolve_name(name) for name in arguments[:1]]
                return 1, "", method(*resolved, *arguments[1:])
            except (MasterError, MasterFailure) as error:
                return _CODES[type(error)], str(error), 0

        return ask

    def __getitem__(self, key: str) -> Any:
        try:
            return self.target.getParam(names.resolve_name(key))
        except MasterError:
            raise KeyError(key) from None

    def __setitem__(self, key: str, val: Any) -> None:
        try:
            self.target.setParam(names.resolve_name(key), val)
        except MasterFailure as error:
            raise ROSException(f"cannot set parameter: {error}") from None

    def __delitem__(self, key: str) -> None:
        try:
            self.target.deleteParam(names.resolve_name(key))
        except MasterError:
            raise KeyError(key) from None
        except MasterFailure as error:
            raise ROSException(f"cannot delete parameter: {error}") from None

    def __contains__(self, key: str) -> bool:
        return self.target.hasParam(names.resolve_name(key))

    def __iter__(self) -> Iterator[str]:
        return iter(self.target.getParamNames())

    def search_param(self, key: str) -> str | None:
        """Return the global name of the nearest parameter of this name, or None.

        Raises:
            ROSException: the name is invalid.
        """
        if not key:
            return None  # As in ROS.
        try:
            return self.target.searchParam(names.get_mappings().get(key, key))
        except MasterError:
            return None
        except MasterFailure as error:
            raise ROSException(f"cannot search for parameter: {error}") from None


class _Master(Master):
    """Sends requests through the process's node while it runs."""

    def call(self, service: str, request: dict[str, Any]) -> dict[str, Any]:
        if not core.background.running or core.is_shutdown():
            return super().call(service, request)
        from fibws.errors import ServiceError, ServiceLost

        node = core.background.node
        while True:
            call = node.call(service, TYPES[service], request)
            try:
                response = core.background.call(call)
            except ServiceLost:
                continue  # The next call waits until the hub is back; these may be repeated.
            except ServiceError as error:
                raise MasterFailure(error.text) from None
            fields: dict[str, Any] = response.to_dict()
            return fields
