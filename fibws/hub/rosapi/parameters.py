"""rosapi's services for parameters, whose values are JSON texts so that they may have any type.

The rules are those of rosapi's params.py: a parameter that is not set has the caller's default, and
to delete it is not an error.
"""

from __future__ import annotations

import re
from typing import Any

from pydantic_core import from_json, to_json

from fibws import names
from fibws.errors import OperationError, ParameterNotSet
from fibws.hub.errors import ParametersFull
from fibws.hub.graph.graph import ROSBRIDGE, Graph
from fibws.hub.graph.parameters import Parameters
from fibws.hub.graph.service import Function, Response
from fibws.hub.log.audit import Audit

ROSDISTRO = "noetic\n"
ROSVERSION = "1.16.0\n"
"""Both end with a newline, as roscore sets them."""


def set_defaults(
    parameters: Parameters, *, run_id: str, host: str, port: int, address: str
) -> None:
    """Set the parameters that roscore and rosbridge_websocket set at their start.

    Args:
        run_id: a UUID of this run of the hub.
        host: the name or the address by which the hub is reached.
        port: the port that it listens on.
        address: the address that it listens on.
    """
    label = re.sub("[^a-z0-9]", "_", host.lower())
    uri_host = f"[{host}]" if ":" in host else host
    parameters.set("/run_id", run_id)
    parameters.set("/rosdistro", ROSDISTRO)
    parameters.set("/rosversion", ROSVERSION)
    parameters.set(f"/roslaunch/uris/host_{label}__{port}", f"http://{uri_host}:{port}/")
    parameters.set(f"{ROSBRIDGE}/actual_port", port)
    parameters.set(f"{ROSBRIDGE}/actual_host", address)


class ParameterServices:
    """The services that read and change the parameters."""

    def __init__(self, graph: Graph, audit: Audit) -> None:
        self._graph = graph
        self._audit = audit

    def services(self) -> dict[str, tuple[str, Function]]:
        """Return all services by their global names, each with its type and handler."""
        return {
            "/rosapi/get_param": ("rosapi/GetParam", self.get),
            "/rosapi/set_param": ("rosapi/SetParam", self.set),
            "/rosapi/has_param": ("rosapi/HasParam", self.has),
            "/rosapi/delete_param": ("rosapi/DeleteParam", self.delete),
            "/rosapi/search_param": ("rosapi/SearchParam", self.search),
            "/rosapi/get_param_names": ("rosapi/GetParamNames", self.names),
        }

    def get(self, request: dict[str, Any], caller: str) -> Response:
        """Return a value as JSON, or the default, which is taken for a string if it is not JSON."""
        try:
            text = self._graph.view(caller).parameter(_global(request["name"], caller))
        except ParameterNotSet:
            text = _default(request["default"])
        return {"value": text.decode()}

    def set(self, request: dict[str, Any], caller: str) -> Response:
        """Set a parameter to the value of a JSON text.

        As for Python, and so for rosbridge_suite, NaN, Infinity and -Infinity are values.
        ``{"$binary": "<base64>"}`` stands for bytes, and ``{"$date": ...}`` for a date.

        Raises:
            OperationError: the text is not JSON, or the policy forbids it.
            ParameterError: the value cannot be a parameter's, or there is no room.
        """
        text, most = request["value"], self._graph.parameters.max_bytes
        if len(text) > most:  # Decoding it first would only take time.
            raise ParametersFull(request["name"], len(text), most)
        try:
            value = from_json(text)
        except ValueError as error:
            raise OperationError(
                "Due to the type flexibility of the ROS parameter server, the value argument to "
                f"set_param must be a JSON-formatted string. ({error})"
            ) from None
        name = _global(request["name"], caller)
        self._graph.set_parameter(caller, name, value)
        self._audit.parameter_written(name, node=caller)
        return {}

    def has(self, request: dict[str, Any], caller: str) -> Response:
        """Return whether there is a parameter of that name, or a namespace."""
        name = _global(request["name"], caller)
        return {"exists": self._graph.view(caller).has_parameter(name)}

    def delete(self, request: dict[str, Any], caller: str) -> Response:
        """Delete a parameter, whether or not it was there."""
        name = _global(request["name"], caller)
        self._graph.delete_parameter(caller, name)
        self._audit.parameter_written(name, node=caller, deleted=True)
        return {}

    def search(self, request: dict[str, Any], caller: str) -> Response:
        """Return the name of the parameter nearest to the caller, or an empty string."""
        found = self._graph.view(caller).search_parameter(request["name"], caller)
        return {"global_name": found or ""}

    def names(self, request: dict[str, Any], caller: str) -> Response:
        """Return the names of all parameters."""
        return {"names": self._graph.view(caller).parameters()}


def _global(name: str, caller: str) -> str:
    """Resolve a name for the caller; a global one is not checked, as in ROS."""
    return name if name.startswith("/") else names.resolve(name, node=caller)


def _default(text: str) -> bytes:
    if not text:
        return b"null"
    try:
        return to_json(from_json(text, allow_inf_nan=False), inf_nan_mode="null")
    except ValueError:
        return to_json(text)
