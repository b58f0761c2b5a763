"""rosservice's functions for scripts: list, describe and call services."""

from __future__ import annotations

from typing import Any

import rosgraph
from rosgraph.masterapi import reporting_no_master
from rosgraph.names import make_global_ns, script_resolve_name

__all__ = [
    "ROSServiceException",
    "ROSServiceIOException",
    "call_service",
    "get_service_args",
    "get_service_class_by_name",
    "get_service_headers",
    "get_service_list",
    "get_service_node",
    "get_service_type",
    "get_service_uri",
    "has_service_args",
    "rosservice_find",
]


class ROSServiceException(Exception):
    """The base of rosservice's errors."""


class ROSServiceIOException(ROSServiceException):
    """The hub cannot be reached."""


def get_service_type(service_name: str) -> str | None:
    """Return the type of a service, such as ``std_srvs/Trigger``; None if it is unknown.

    Raises:
        ROSServiceIOException: the hub cannot be reached.
    """
    with reporting_no_master(ROSServiceIOException):
        response = _master().ask("service_type", service=_global(service_name))
    return response["type"] or None


def get_service_uri(service_name: str) -> str | None:
    """Return a service's URI, which cannot be used for calls; None if it is unknown.

    Raises:
        ROSServiceIOException: the hub cannot be reached.
    """
    with reporting_no_master(ROSServiceIOException):
        try:
            return _master().lookupService(_global(service_name))
        except rosgraph.MasterError:
            return None


def get_service_node(service_name: str) -> str | None:
    """Return the name of the node that provides a service; None if it is unknown.

    Raises:
        ROSServiceIOException: the hub cannot be reached.
    """
    with reporting_no_master(ROSServiceIOException):
        return _master().ask("service_node", service=_global(service_name))["node"] or None


def get_service_list(
    node: str | None = None, namespace: str | None = None, include_nodes: bool = False
) -> list[Any]:
    """Return the names of services.

    Args:
        node: the global name of their node; None for all nodes.
        namespace: their global namespace; None for all namespaces.
        include_nodes: return pairs of the name and a list of the node that provides it.

    Raises:
        ROSServiceIOException: the hub cannot be reached.
    """
    with reporting_no_master(ROSServiceIOException):
        services = _master().getSystemState()[2]
    if namespace:
        above = make_global_ns(namespace)
        services = [each for each in services if each[0] == namespace or each[0].startswith(above)]
    if node is not None:
        services = [each for each in services if node in each[1]]
    return services if include_nodes else [name for name, _ in services]


def rosservice_find(service_type: str) -> list[str]:
    """Return the names of the services of a type.

    Raises:
        ROSServiceIOException: the hub cannot be reached.
    """
    with reporting_no_master(ROSServiceIOException):
        return list(_master().ask("services_for_type", type=service_type)["services"])


def get_service_class_by_name(service_name: str) -> Any:
    """Return the class of a service that exists.

    Raises:
        ROSServiceException: the service is unknown, or its type is not defined here.
        ROSServiceIOException: the hub cannot be reached.
    """
    import genpy.message

    type_ = get_service_type(service_name)
    if type_ is None:
        raise ROSServiceException(f"Service [{service_name}] is not available.")
    service_class = genpy.message.get_service_class(type_)
    if service_class is None:
        package = type_.partition("/")[0]
        raise ROSServiceException(
            f"Unable to load type [{type_}].\nHave you typed 'catkin_make' in [{package}], "
            "and sourced its devel/setup.bash?"
        )
    return service_class


def get_service_headers(service_name: str, service_uri: str) -> dict[str, str]:
    """Return what a service tells its callers: its node, its type, and the md5 sum of that.

    Args:
        service_name: its name.
        service_uri: ignored.

    Raises:
        ROSServiceException: the service is unknown, or its type is not defined here.
        ROSServiceIOException: the hub cannot be reached.
    """
    service_class = get_service_class_by_name(service_name)
    return {
        "callerid": get_service_node(service_name) or "",
        "md5sum": service_class._md5sum,
        "service": _global(service_name),
        "type": service_class._type,
    }


def call_service(
    service_name: str, service_args: list[Any], service_class: Any = None
) -> tuple[Any, Any]:
    """Call a service with the values of its request's fields.

    This makes the program a node if it is not one yet.

    Args:
        service_name: the service.
        service_args: the values in order, or one dict of them.
        service_class: its class; found by the service's name if it is None.

    Returns:
        The request and the response.

    Raises:
        ROSServiceException: the call failed.
        ROSServiceIOException: the hub cannot be reached.
    """
    import genpy
    import genpy.message
    import rosmsg
    import rospy
    from std_msgs.msg import Header

    if not rospy.core.is_initialized():
        rospy.init_node("rosservice", anonymous=True)
    if service_class is None:
        service_class = get_service_class_by_name(service_name)
    request = service_class._request_class()
    now = rospy.get_rostime()
    try:
        keys = {"now": now, "auto": Header(stamp=now)}
        genpy.message.fill_message_args(request, service_args, keys=keys)
    except genpy.MessageException as error:
        arguments = genpy.message.get_printable_message_args(request)
        raise ROSServiceException(
            f"Incompatible arguments to call service:\n{error}\nProvided arguments are:\n"
            f"{_listed(service_args)}\n\nService arguments are: [{arguments}]"
        ) from None
    try:
        return request, rospy.ServiceProxy(service_name, service_class)(request)
    except rospy.ServiceException as error:
        raise ROSServiceException(str(error)) from None
    except (genpy.SerializationError, rospy.ROSSerializationException) as error:
        raise ROSServiceException(
            f"Unable to send request. One of the fields has an incorrect type:\n  {error}\n\n"
            f"srv file:\n{rosmsg.get_srv_text(service_class._type)}"
        ) from None


def has_service_args(service_name: str, service_class: Any = None) -> bool:
    """Return whether a service's request has fields; raises as `get_service_class_by_name`."""
    if service_class is None:
        service_class = get_service_class_by_name(service_name)
    return len(service_class._request_class.__slots__) > 0


def get_service_args(service_name: str) -> str:
    """Return the names of a request's fields; raises as `get_service_class_by_name`."""
    import genpy.message

    service_class = get_service_class_by_name(service_name)
    return genpy.message.get_printable_message_args(service_class._request_class())


def _listed(arguments: object) -> str:
    each = arguments if isinstance(arguments, list | tuple) else [arguments]
    return "\n".join(f" * {argument} (type {type(argument).__name__})" for argument in each)


def _global(name: str) -> str:
    return script_resolve_name("rosservice", name)


def _master() -> rosgraph.Master:
    return rosgraph.Master("/rosservice")
