"""The server of a node's parameters."""

from __future__ import annotations

import copy
import threading
from collections.abc import Callable, Mapping
from typing import Any

import rospy

from dynamic_reconfigure import DynamicReconfigureCallbackException
from dynamic_reconfigure.encoding import (
    Config,
    decode_config,
    encode_config,
    encode_description,
    extract_params,
    get_tree,
    initial_config,
)
from dynamic_reconfigure.msg import Config as ConfigMsg
from dynamic_reconfigure.msg import ConfigDescription as ConfigDescrMsg
from dynamic_reconfigure.srv import Reconfigure as ReconfigureSrv

ALL_LEVELS = ~0


class Server:
    """Lets others change the parameters of this node.

    It serves ``set_parameters``, and publishes ``parameter_descriptions`` and
    ``parameter_updates``, both latched, in the node's namespace.

    Args:
        type: the module made from a .cfg file: ``from my_package.cfg import TutorialsConfig``.
        callback: called with a configuration, and with the levels of the parameters in it that
            differ from before, or -1 for the first time. It returns the configuration that is valid
            from now on, which may differ.
        namespace: a name below the node's.

    Raises:
        DynamicReconfigureCallbackException: the callback returned None.
    """

    def __init__(
        self, type: Any, callback: Callable[[Config, int], Config | None], namespace: str = ""
    ) -> None:
        self.mutex = threading.Lock()
        self.ns = "~"
        if namespace:
            namespace = namespace if namespace[0] in "/~" else f"~{namespace}"
            self.ns = f"{namespace}/".replace("//", "/")
        self.type = type
        self.callback = callback
        self.description = encode_description(type)
        self.config: Any = Config(type.defaults)
        self._read_parameters()
        self._clamp(self.config)
        self.config["groups"] = get_tree(self.description)
        self.config = initial_config(encode_config(self.config), type.config_description)
        options: dict[str, Any] = {"latch": True, "queue_size": 10}
        self.descr_topic = rospy.Publisher(
            self.ns + "parameter_descriptions", ConfigDescrMsg, **options
        )
        self.descr_topic.publish(self.description)
        self.update_topic = rospy.Publisher(self.ns + "parameter_updates", ConfigMsg, **options)
        self._change(self.config, ALL_LEVELS)
        self.set_service = rospy.Service(
            self.ns + "set_parameters", ReconfigureSrv, self._set_parameters
        )

    def update_configuration(self, changes: Mapping[str, Any]) -> Config:
        """Change some parameters; return the configuration that the callback makes of them.

        Raises:
            DynamicReconfigureCallbackException: the callback returned None.
        """
        with self.mutex:
            config = copy.deepcopy(self.config)
            config.update(changes)
            self._clamp(config)
            return self._change(config, self._levels(config, self.config))

    def _change(self, config: Any, level: int) -> Config:
        self.config = self.callback(config, level)
        if self.config is None:
            text = "Reconfigure callback should return a possibly updated configuration."
            rospy.logerr(text)
            raise DynamicReconfigureCallbackException(text)
        for parameter in self._parameters():
            name = parameter["name"]
            rospy.set_param(self.ns + name, self.config[name])
        self.update_topic.publish(encode_config(self.config))
        changed: Config = self.config
        return changed

    def _parameters(self) -> list[Any]:
        return extract_params(self.type.config_description)

    def _read_parameters(self) -> None:
        for parameter in self._parameters():
            name = parameter["name"]
            if rospy.has_param(self.ns + name):
                self.config[name] = rospy.get_param(self.ns + name)

    def _levels(self, config: Any, before: Any) -> int:
        level = 0
        for parameter in self._parameters():
            if config[parameter["name"]] != before[parameter["name"]]:
                level |= parameter["level"]
        return level

    def _clamp(self, config: Any) -> None:
        """Bring values into the range of their parameters; texts have none."""
        for parameter in self._parameters():
            name = parameter["name"]
            least, most = self.type.min[name], self.type.max[name]
            if most != "" and config[name] > most:
                config[name] = most
            elif least != "" and config[name] < least:
                config[name] = least

    def _set_parameters(self, request: Any) -> ConfigMsg:
        changes = decode_config(request.config, self.type.config_description)
        return encode_config(self.update_configuration(changes))
