"""Parameters over the hub's rosapi services."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, TypeAlias

from fibws.errors import ParameterError, ParameterNotSet, ServiceError

UNSET: dict[str, Any] = {"$unset": []}
"""The default for `HubParameters.get`, a value that no parameter has; NaN is null."""
ROOT = "/"
"""The namespace of all parameters."""

Call: TypeAlias = Callable[[str, dict[str, Any]], dict[str, Any]]


class HubParameters:
    """The parameters of a hub; a dict is a namespace. All names are global.

    Args:
        call: calls a service with a request and returns its response, as `HubClient.call` does.

    Raises:
        ParameterError: the hub refused a call.
        ServiceError: the hub did not respond, or is another kind of server.
    """

    def __init__(self, call: Call) -> None:
        self._call = call

    def get(self, name: str) -> Any:
        """Return the value of a parameter, or a namespace as a dict.

        NaN is None; bytes and dates are dicts, as the hub keeps them.

        Raises:
            ParameterNotSet: the parameter is not set.
        """
        service = "/rosapi/get_param"
        text = self._ask(service, {"name": name, "default": json.dumps(UNSET)})["value"]
        try:
            value = json.loads(text)
        except ValueError:
            fault = f"{service} returned {text[:40]!r}, which is invalid JSON: this may be another"
            raise ServiceError(service, f"{fault} kind of hub") from None
        if value == UNSET:
            raise ParameterNotSet(name)
        return value

    def set(self, name: str, value: Any) -> None:
        """Set a parameter; a dict replaces a namespace.

        Args:
            value: a JSON value; numbers may be infinite, or NaN.

        Raises:
            TypeError: the value is not a JSON value.
        """
        self.set_json(name, json.dumps(value, ensure_ascii=False))

    def set_json(self, name: str, text: str) -> None:
        """Set a parameter to a value in JSON."""
        self._ask("/rosapi/set_param", {"name": name, "value": text})

    def has(self, name: str) -> bool:
        """Return whether a parameter or a namespace exists."""
        return bool(self._ask("/rosapi/has_param", {"name": name})["exists"])

    def delete(self, name: str) -> None:
        """Delete a parameter or a namespace; for the root, all parameters.

        Raises:
            ParameterNotSet: it does not exist.
        """
        if name == ROOT:
            self.set_json(ROOT, "{}")
        elif self.has(name):
            self._ask("/rosapi/delete_param", {"name": name})
        else:
            raise ParameterNotSet(name)

    def search(self, name: str) -> str | None:
        """Return the global name of the nearest parameter of this name, or None."""
        found = self._ask("/rosapi/search_param", {"name": name})["global_name"]
        return str(found) or None

    def names(self) -> list[str]:
        """Return the names of all parameters, without namespaces."""
        return list(self._ask("/rosapi/get_param_names", {})["names"])

    def _ask(self, service: str, request: dict[str, Any]) -> dict[str, Any]:
        try:
            return self._call(service, request)
        except ServiceError as error:
            if type(error) is not ServiceError:
                raise
            raise ParameterError(error.text) from None  # The text names the parameter.
