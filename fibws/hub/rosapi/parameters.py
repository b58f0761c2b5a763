"""The parameters as rosapi serves them: as JSON texts, so that they may have any type.

The rules are those of rosapi's params.py: who asks for what is not set gets the default, and who
deletes it need not care.
"""

from __future__ import annotations

import re
from typing import Any

from pydantic_core import from_json, to_json

from fibws import names
from fibws.errors import OperationError, ParameterNotSet, ParametersFull
from fibws.hub.graph.parameters import Parameters
from fibws.hub.graph.service import Answer, Function

ROSDISTRO = "noetic\n"
ROSVERSION = "1.16.0\n"
"""Both end their line, as the output of the program does that ROS's roscore takes them from."""


def set_defaults(parameters: Parameters, *, run_id: str, host: str, port: int) -> None:
    """Set the parameters that are there from the start, as roscore does.

    Args:
        run_id: a UUID of this run of the hub.
        host: the name or the address by which the hub is reached.
    """
    label = re.sub("[^a-z0-9]", "_", host.lower())
    address = f"[{host}]" if ":" in host else host
    parameters.set("/run_id", run_id)
    parameters.set("/rosdistro", ROSDISTRO)
    parameters.set("/rosversion", ROSVERSION)
    parameters.set(f"/roslaunch/uris/host_{label}__{port}", f"http://{address}:{port}/")


class ParameterServices:
    """The services that read and change the parameters."""

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters

    def services(self) -> dict[str, tuple[str, Function]]:
        """All by their global names, each with its type and what answers it."""
        return {
            "/rosapi/get_param": ("rosapi/GetParam", self.get),
            "/rosapi/set_param": ("rosapi/SetParam", self.set),
            "/rosapi/has_param": ("rosapi/HasParam", self.has),
            "/rosapi/delete_param": ("rosapi/DeleteParam", self.delete),
            "/rosapi/search_param": ("rosapi/SearchParam", self.search),
            "/rosapi/get_param_names": ("rosapi/GetParamNames", self.names),
        }

    def get(self, request: dict[str, Any], caller: str) -> Answer:
        """A value as JSON text, or the default, which is JSON text or else a text itself."""
        try:
            text = self._parameters.text(_global(request["name"], caller))
        except ParameterNotSet:
            text = _default(request["default"])
        return {"value": text.decode()}

    def set(self, request: dict[str, Any], caller: str) -> Answer:
        """Give a parameter the value that a JSON text stands for.

        Raises:
            OperationError: the text is not JSON.
            ParameterError: the value is nothing that a parameter can be, or there is no room.
        """
        text, most = request["value"], self._parameters.max_bytes
        if len(text) > most:
            # To read it first would only take time.
            raise ParametersFull(request["name"], len(text), most)
        try:
            value = from_json(text, allow_inf_nan=False)
        except ValueError as error:
            raise OperationError(
                "Due to the type flexibility of the ROS parameter server, the value argument to "
                f"set_param must be a JSON-formatted string. ({error})"
            ) from None
        self._parameters.set(_global(request["name"], caller), value)
        return {}

    def has(self, request: dict[str, Any], caller: str) -> Answer:
        """Whether there is a parameter of that name, or a namespace."""
        return {"exists": self._parameters.has(_global(request["name"], caller))}

    def delete(self, request: dict[str, Any], caller: str) -> Answer:
        """Have a parameter be no more, whether or not it was there."""
        name = _global(request["name"], caller)
        if self._parameters.has(name):
            self._parameters.delete(name)
        return {}

    def search(self, request: dict[str, Any], caller: str) -> Answer:
        """The name of the parameter nearest to the caller, or an empty text if there is none."""
        return {"global_name": self._parameters.search(request["name"], caller) or ""}

    def names(self, request: dict[str, Any], caller: str) -> Answer:
        """The names of all parameters."""
        return {"names": self._parameters.names()}


def _global(name: str, caller: str) -> str:
    """The name that the caller means; what a global one is made of, ROS does not check."""
    return name if name.startswith("/") else names.resolve(name, node=caller)


def _default(text: str) -> bytes:
    if not text:
        return b"null"
    try:
        return to_json(from_json(text, allow_inf_nan=False), inf_nan_mode="null")
    except ValueError:
        return to_json(text)
