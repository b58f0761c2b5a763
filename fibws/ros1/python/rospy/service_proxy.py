"""Service calls."""

from __future__ import annotations

from time import monotonic, sleep
from typing import TYPE_CHECKING, Any

from genpy.message import SerializationError

from rospy import core, names
from rospy.exceptions import ROSException, ROSInterruptException
from rospy.msg import Message, args_kwds_to_message, serialized
from rospy.rostime import seconds_of
from rospy.service import ServiceEnd, ServiceException

if TYPE_CHECKING:
    from fibws.client.hub_client import HubClient
    from rospy.rostime import Duration

POLL_INTERVAL = 0.3
"""Seconds between two checks whether a service exists, by programs that are not nodes."""
INTERRUPTED = "node shutdown interrupted service call"


class ServiceProxy(ServiceEnd):
    """Calls a service, as a function of its request or of the request's fields.

    Programs that have not called `init_node` may use it, too.

    Args:
        name: its name.
        service_class: its class.
        persistent: sets the header ``persistent``, and has no other effect.
        headers: fields for the request's ``_connection_header``, which the handler reads.
    """

    def __init__(
        self,
        name: str,
        service_class: Any,
        persistent: bool = False,
        headers: dict[str, str] | None = None,
    ) -> None:
        super().__init__(name, service_class)
        self.persistent = persistent
        self._headers = {"md5sum": service_class._md5sum}
        self._headers.update((name, str(value)) for name, value in (headers or {}).items())
        if persistent:
            self._headers["persistent"] = "1"

    def wait_for_service(self, timeout: float | Duration | None = None) -> None:
        """Wait until the service exists; see `wait_for_service`."""
        wait_for_service(self.resolved_name, timeout)

    def __call__(self, *args: Any, **kwds: Any) -> Any:
        """Call the service; see `call`."""
        return self.call(*args, **kwds)

    def call(self, *args: Any, **kwds: Any) -> Any:
        """Call the service with a request, or with its fields in order or by name.

        Raises:
            ServiceException: the service does not exist, has another type, or failed.
            TypeError: fields both in order and by name, or a message of another class.
            genpy.SerializationError: a field does not fit the type.
            ROSInterruptException: the node ends.
        """
        request = args_kwds_to_message(self.request_class, args, kwds)
        if not isinstance(request, Message):
            raise TypeError("request object is not a valid request message instance")
        if request._type != self.request_class._type:
            raise TypeError(
                f"request object type [{type(request)}] "
                f"does not match service type [{self.request_class}]"
            )
        response, header = self._checked_call(request)
        response._connection_header = {
            "service": self.resolved_name,
            "type": self.service_class._type,
            "md5sum": self.service_class._md5sum,
            **header,
        }
        return response

    def close(self) -> None:
        """Do nothing: a proxy has no connection of its own."""

    def _checked_call(self, request: Message) -> tuple[Any, dict[str, str]]:
        """Return the response and the server's header; raise as `call`."""
        from fibws.errors import (
            AccessDenied,
            HubLost,
            HubUnreachable,
            InvalidName,
            ServiceError,
            ServiceLost,
            ServiceTimeout,
            UnknownService,
        )

        try:
            return self._checked_request(request)
        except ROSInterruptException:
            raise ROSInterruptException(INTERRUPTED) from None
        except AccessDenied as error:
            raise ServiceException(str(error)) from None
        except HubUnreachable:
            raise ServiceException("unable to contact master") from None
        except (UnknownService, InvalidName):
            raise ServiceException(f"service [{self.resolved_name}] unavailable") from None
        except (ServiceLost, ServiceTimeout, HubLost) as error:
            text = f"transport error completing service call: {error}"
        except ServiceError as error:
            if error.code == "type_conflict":
                text = f"unable to connect to service: remote error reported: {error.text}"
            elif error.code in ("server_lost", "server_busy"):
                text = f"transport error completing service call: {error.text}"
            else:
                reason = str(error.text.encode())
                text = f"service [{self.resolved_name}] responded with an error: {reason}"
        # In a node that calls its own service, the handler may end before the call does.
        if core.is_shutdown():
            raise ROSInterruptException(INTERRUPTED)
        raise ServiceException(text)

    def _checked_request(self, request: Message) -> tuple[Any, dict[str, str]]:
        """Call the service; ROS refuses another type of service before it looks at the fields."""
        from fibws.errors import InvalidMessage, UnknownService

        try:
            return self._call(request)
        except (InvalidMessage, SerializationError) as error:
            type_ = self._find_type()
            if not type_:
                raise UnknownService(self.resolved_name, "it does not exist") from None
            if type_ != self.service_class._type:
                raise ServiceException(
                    f"unable to connect to service: [{self.resolved_name}] has type [{type_}], "
                    f"expected [{self.service_class._type}]"
                ) from None
            request._check_types(error)
            raise

    def _find_type(self) -> str | None:
        """Return the type of the service that the hub knows by this name."""
        if core.background.running:
            graph = core.background.node.graph
            return core.background.call(graph.service_type(self.resolved_name))
        from fibws.client.hub_client import HubClient

        with HubClient("unnamed") as client:
            return _service_type(client, self.resolved_name)

    def _call(self, request: Message) -> tuple[Any, dict[str, str]]:
        if core.background.running:
            node = core.background.node
            return core.background.call(
                node.call_with_header(
                    self.resolved_name, self.service_class, request, headers=self._headers
                )
            )
        from fibws.client.hub_client import HubClient

        with HubClient("unnamed") as client:
            serialized(request)  # Checks the fields, which otherwise the node does.
            fields = request.to_dict()
            values = client.call(self.resolved_name, fields, timeout=0, headers=self._headers)
        return self.response_class.from_dict(values), values.header


def wait_for_service(service: str, timeout: float | Duration | None = None) -> None:
    """Wait until a service exists; programs that are not nodes may do so, too.

    Args:
        service: its name.
        timeout: the most seconds to wait, or a `Duration`; None for ever.

    Raises:
        ValueError: the timeout is 0.
        ROSException: the service did not exist in time.
        ROSInterruptException: the node ends.
    """
    from fibws.errors import WaitTimeout

    seconds = seconds_of(timeout)
    if seconds == 0:
        raise ValueError("timeout must be non-zero")
    resolved = names.resolve_name(service)
    try:
        if seconds is not None and seconds < 0:
            raise WaitTimeout
        if core.background.running:
            _wait_in_node(resolved, seconds)
        else:
            _wait_outside_node(resolved, seconds)
    except WaitTimeout:
        raise ROSException(f"timeout exceeded while waiting for service {resolved}") from None


def _wait_in_node(service: str, timeout: float | None) -> None:
    """Wait as a node until the service is there, or raise `WaitTimeout`."""
    from fibws.errors import InvalidName, WaitTimeout

    node = core.background.node
    try:
        core.background.call(node.wait_for_service(service, timeout=timeout))
    except InvalidName:  # ROS waits even for a service with an invalid name.
        if core.wait_for_shutdown(timeout):
            raise ROSInterruptException("rospy shutdown") from None
        raise WaitTimeout from None


def _service_type(client: HubClient, service: str) -> str:
    """Return the type of a service; an empty text if it does not exist."""
    type_: str = client.call("/rosapi/service_type", {"service": service})["type"]
    return type_


def _wait_outside_node(service: str, timeout: float | None) -> None:
    """Check again and again whether a service exists, or raise `WaitTimeout`."""
    from fibws.client.hub_client import HubClient
    from fibws.errors import (
        HubLost,
        HubUnreachable,
        MissingRight,
        NotAuthorized,
        ServiceError,
        WaitTimeout,
    )

    end = None if timeout is None else monotonic() + timeout
    has_warned = False
    while True:
        try:
            with HubClient("unnamed") as client:
                if _service_type(client, service):
                    return
        except (NotAuthorized, MissingRight) as error:
            raise ROSException(str(error)) from None
        except (HubUnreachable, HubLost) as error:  # Also of a hub that has no room now.
            if not has_warned:
                from rospy import logwarn

                has_warned = True
                logwarn(f"wait_for_service({service}): {error}; will keep trying")
        except ServiceError:
            pass  # The hub is about to end.
        left = POLL_INTERVAL if end is None else min(POLL_INTERVAL, end - monotonic())
        if left <= 0:
            raise WaitTimeout
        sleep(left)
