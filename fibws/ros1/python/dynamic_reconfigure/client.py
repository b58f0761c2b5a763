"""A client that reads and changes the parameters of a server."""

from __future__ import annotations

import ast
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import rospy
from rospy.service import ServiceException

from dynamic_reconfigure import (
    DynamicReconfigureCallbackException,
    DynamicReconfigureParameterException,
)
from dynamic_reconfigure.encoding import (
    Config,
    decode_config,
    decode_description,
    encode_config,
    extract_params,
)
from dynamic_reconfigure.msg import Config as ConfigMsg
from dynamic_reconfigure.msg import ConfigDescription as ConfigDescrMsg
from dynamic_reconfigure.srv import Reconfigure as ReconfigureSrv

_TYPES: dict[str, type] = {"int": int, "double": float, "str": str, "bool": bool}
_TRUE = ("yes", "true", "t", "1")

ConfigCallback = Callable[[Any], object]


class Client:
    """A client of one server.

    Args:
        name: the server's: its node, perhaps with a namespace.
        timeout: seconds to wait for the server; None or 0 to wait for ever.
        config_callback: called with each configuration.
        description_callback: called with the descriptions of the parameters.

    Raises:
        rospy.ROSException: the server did not appear in time.
    """

    def __init__(
        self,
        name: str,
        timeout: float | None = None,
        config_callback: ConfigCallback | None = None,
        description_callback: ConfigCallback | None = None,
    ) -> None:
        self.name = name
        self.config: Config | None = None
        self.param_description: list[Any] | None = None
        self.group_description: Config | None = None
        self._param_types: dict[str, type] = {}
        self._changed = threading.Condition()
        self._config_callback = config_callback
        self._description_callback = description_callback
        service = rospy.resolve_name(f"{name}/set_parameters")
        self._wait_for_service(service, timeout)
        self._set_service = rospy.ServiceProxy(service, ReconfigureSrv)
        self._subscribers = [
            rospy.Subscriber(rospy.resolve_name(f"{name}/{topic}"), type_, callback=callback)
            for topic, type_, callback in (
                ("parameter_descriptions", ConfigDescrMsg, self._description_arrived),
                ("parameter_updates", ConfigMsg, self._config_arrived),
            )
        ]

    def get_configuration(self, timeout: float | None = None) -> Config | None:
        """Return the newest configuration.

        Args:
            timeout: seconds to wait for one; None or 0 to wait for ever.

        Returns:
            None if none has arrived.
        """
        if not timeout and not self._wait(lambda: self.config is not None, 1.0):
            print("Waiting for configuration...", file=sys.stderr)
        self._wait(lambda: self.config is not None, timeout)
        return self.config

    def get_parameter_descriptions(self, timeout: float | None = None) -> list[Any] | None:
        """Return the descriptions of all parameters; arguments as of `get_configuration`."""
        self._wait(lambda: self.param_description is not None, timeout)
        return self.param_description

    def get_group_descriptions(self, timeout: float | None = None) -> Config | None:
        """Return the tree of groups; arguments as of `get_configuration`."""
        self._wait(lambda: self.group_description is not None, timeout)
        return self.group_description

    def update_configuration(self, changes: dict[str, Any]) -> Config:
        """Change some parameters; return the configuration that the server makes of them.

        Args:
            changes: values by name, or texts of them; for an enum the name of a constant, too.

        Raises:
            DynamicReconfigureParameterException: a parameter is unknown, or a value does not fit.
            DynamicReconfigureCallbackException: the server has failed.
        """
        descriptions = {each["name"]: each for each in self.get_parameter_descriptions() or ()}
        for name, value in list(changes.items()):
            if name != "groups":
                if name not in descriptions:
                    text = f"don't know parameter: {name}"
                    raise DynamicReconfigureParameterException(text)
                changes[name] = self._converted(descriptions[name], value)
        if "groups" in changes:
            changes["groups"] = self.update_groups(changes["groups"])
        try:
            message = self._set_service(encode_config(changes)).config
        except ServiceException:
            raise DynamicReconfigureCallbackException("service call failed") from None
        return decode_config(message, self.get_group_descriptions())

    def update_groups(self, changes: dict[str, bool]) -> Config | None:
        """Return the tree of groups with new states.

        Args:
            changes: states by the names of groups.
        """
        groups = self.get_group_descriptions()
        waiting = [groups] if groups is not None else []
        while waiting:
            for inside in waiting.pop()["groups"].values():
                if inside["name"] in changes:
                    inside["state"] = changes[inside["name"]]
                waiting.append(inside)
        return groups

    def close(self) -> None:
        """End the subscriptions."""
        for subscriber in self._subscribers:
            subscriber.unregister()

    @property
    def config_callback(self) -> ConfigCallback | None:
        """The function that is called with each configuration, and at once when it is set."""
        return self._config_callback

    @config_callback.setter
    def config_callback(self, value: ConfigCallback | None) -> None:
        self._config_callback = value
        if value is not None:
            value(self.config)

    @property
    def description_callback(self) -> ConfigCallback | None:
        """The function that is called with the descriptions, and at once when it is set."""
        return self._description_callback

    @description_callback.setter
    def description_callback(self, value: ConfigCallback | None) -> None:
        self._description_callback = value
        if value is not None:
            value(self.param_description)

    def get_config_callback(self) -> ConfigCallback | None:
        """Return `config_callback`."""
        return self.config_callback

    def set_config_callback(self, value: ConfigCallback | None) -> None:
        """Set `config_callback`."""
        self.config_callback = value

    def get_description_callback(self) -> ConfigCallback | None:
        """Return `description_callback`."""
        return self.description_callback

    def set_description_callback(self, value: ConfigCallback | None) -> None:
        """Set `description_callback`."""
        self.description_callback = value

    def _wait_for_service(self, service: str, timeout: float | None) -> None:
        if not timeout:
            try:
                rospy.wait_for_service(service, 1.0)
                return
            except rospy.ROSException:
                print(f"Waiting for service {service}...", file=sys.stderr)
        rospy.wait_for_service(service, timeout or None)

    def _wait(self, condition: Callable[[], bool], timeout: float | None) -> bool:
        """Wait until a condition holds, the time is over, or the node ends."""
        until = time.monotonic() + timeout if timeout else None
        with self._changed:
            while not condition():
                left = None if until is None else until - time.monotonic()
                if rospy.is_shutdown() or (left is not None and left <= 0):
                    return False
                self._changed.wait(0.5 if left is None else min(left, 0.5))  # It may be shut down.
        return True

    def _converted(self, description: Any, value: Any) -> Any:
        """Return a value as the type of its parameter."""
        type_ = self._param_types[description["name"]]
        if isinstance(value, str):
            if type_ is bool:
                return value.lower() in _TRUE
            for constant in _enum(description["edit_method"]):
                if value.lower() == constant["name"].lower():
                    return _type(constant["type"])(constant["value"])
        try:
            return type_(value)
        except ValueError as error:
            name = description["name"]
            text = f"can't set parameter '{name}' of {type_}: {error}"
            raise DynamicReconfigureParameterException(text) from None

    def _description_arrived(self, message: ConfigDescrMsg) -> None:
        groups = decode_description(message)
        parameters = extract_params(groups)
        types = {each["name"]: _type(each["type"]) for each in parameters}
        with self._changed:
            self.group_description, self.param_description = groups, parameters
            self._param_types = types
            self._changed.notify_all()
        if self._description_callback is not None:
            self._description_callback(parameters)

    def _config_arrived(self, message: ConfigMsg) -> None:
        config = decode_config(message, self.get_group_descriptions())
        with self._changed:
            self.config = config
            self._changed.notify_all()
        if self._config_callback is not None:
            self._config_callback(config)


def _type(name: str) -> type:
    if name not in _TYPES:
        text = f"parameter has unknown type: {name}. This is a bug in dynamic_reconfigure."
        raise DynamicReconfigureParameterException(text)
    return _TYPES[name]


def _enum(edit_method: str) -> list[Any]:
    """Return the constants of an enum; none for other parameters.

    The text is a literal; the original evaluates it as Python, which it may not be trusted to be.
    """
    try:
        found = ast.literal_eval(edit_method) if edit_method else {}
        return list(found.get("enum", ()))
    except (ValueError, SyntaxError, AttributeError, RecursionError):
        return []
