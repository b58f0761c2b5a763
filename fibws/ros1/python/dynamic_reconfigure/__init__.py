"""Parameters of running nodes that others change: http://wiki.ros.org/dynamic_reconfigure.

`server.Server` is for the node, `client.Client` for those that change its parameters, and
`parameter_generator_catkin` for ``.cfg`` files, which `catkin_make` turns into modules.
"""

from __future__ import annotations

from typing import Any

import rosservice

__all__ = [
    "DynamicReconfigureCallbackException",
    "DynamicReconfigureException",
    "DynamicReconfigureParameterException",
    "find_reconfigure_services",
    "get_parameter_names",
]

_SUFFIX = "/set_parameters"


class DynamicReconfigureException(Exception):
    """The base of the errors."""


class DynamicReconfigureParameterException(DynamicReconfigureException):
    """A parameter is unknown, or a value does not fit."""


class DynamicReconfigureCallbackException(DynamicReconfigureException):
    """A server's callback has failed, or has returned nothing."""


def find_reconfigure_services() -> list[str]:
    """Return the names of the servers, sorted: those of nodes, or namespaces in them."""
    services = rosservice.get_service_list()
    return sorted(name.removesuffix(_SUFFIX) for name in services if name.endswith(_SUFFIX))


def get_parameter_names(descr: Any) -> list[str]:
    """Return the names of the parameters of a module made from a .cfg file."""
    return list(descr.defaults.keys())
