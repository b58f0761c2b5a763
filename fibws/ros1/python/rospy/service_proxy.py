"""Calling a service."""

from __future__ import annotations

import re
from time import monotonic, sleep
from typing import TYPE_CHECKING, Any

from rospy import core, names
from rospy.arguments import args_kwds_to_message, serialized
from rospy.exceptions import ROSException, ROSInterruptException
from rospy.rostime import seconds_of
from rospy.service import ServiceEnd, ServiceException

if TYPE_CHECKING:
    from genpy import Message

    from rospy.rostime import Duration

LOOK = 0.3
"""Seconds between two looks for a service, by programs that are no node."""
MEANS_ANOTHER_TYPE = re.compile(r"request from \[[^]]*\]: md5sums do not match: \[")
"""How the hub refuses such a call. A handler's own text may hold the same, but further on."""
INTERRUPTED = "node shutdown interrupted service call"


class ServiceProxy(ServiceEnd):
    """Calls a service, as a function of its request or of the request's fields.

    It does so in programs that have not called `init_node`, too.

    Args:
        name: its name.
        service_class: its class.
        persistent: has no effect but for the header that says so.
        headers: what the service's handler finds in the request's ``_connection_header``.
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
        """Wait until somebody offers the service; see `wait_for_service`."""
        wait_for_service(self.resolved_name, timeout)

    def __call__(self, *args: Any, **kwds: Any) -> Any:
        """Call the service; see `call`."""
        return self.call(*args, **kwds)

    def call(self, *args: Any, **kwds: Any) -> Any:
        """Call the service with a request, or with its fields in order or by name.

        Raises:
            ServiceException: nobody offers it, it is of another type, or it failed.
            TypeError: fields both in order and by name, or a message of another class.
            genpy.SerializationError: a field does not fit the type.
            ROSInterruptException: the node ends.
        """
        from genpy import Message

        request = args_kwds_to_message(self.request_class, args, kwds)
        if not isinstance(request, Message):
            raise TypeError("request object is not a valid request message instance")
        if request._type != self.request_class._type:
            raise TypeError(
                f"request object type [{type(request)}] "
                f"does not match service type [{self.request_class}]"
            )
        response = self._answer(request)
        response._connection_header = {
            "service": self.resolved_name,
            "type": self.service_class._type,
            "md5sum": self.service_class._md5sum,
        }
        return response

    def close(self) -> None:
        """Has no effect: there is no connection of the proxy's own."""

    def _answer(self, request: Message) -> Any:
        from fibws.errors import (
            HubLost,
            HubUnreachable,
            InvalidMessage,
            InvalidName,
            ServiceError,
            ServiceLost,
            ServiceTimeout,
            UnknownService,
        )

        try:
            return self._ask(request)
        except ROSInterruptException:
            raise ROSInterruptException(INTERRUPTED) from None
        except HubUnreachable:
            raise ServiceException("unable to contact master") from None
        except (UnknownService, InvalidName):
            raise ServiceException(f"service [{self.resolved_name}] unavailable") from None
        except (ServiceLost, ServiceTimeout, HubLost) as error:
            text = f"transport error completing service call: {error}"
        except ServiceError as error:
            if MEANS_ANOTHER_TYPE.match(error.text):
                text = f"unable to connect to service: remote error reported: {error.text}"
            elif error.text.startswith(f"service [{self.resolved_name}] unavailable: "):
                text = f"transport error completing service call: {error.text}"
            else:
                said = str(error.text.encode())
                text = f"service [{self.resolved_name}] responded with an error: {said}"
        except InvalidMessage as error:
            request._check_types(error)
            raise
        # A node that calls itself may hear of its handler's end before that of the call.
        if core.is_shutdown():
            raise ROSInterruptException(INTERRUPTED)
        raise ServiceException(text)

    def _ask(self, request: Message) -> Any:
        if core.background.running:
            node = core.background.node
            return core.background.call(
                node.call(self.resolved_name, self.service_class, request, headers=self._headers)
            )
        from fibws.cli.link import Link

        with Link("unnamed") as link:
            serialized(request)  # It checks the fields, for which there is no node.
            fields = request.to_dict()
            values = link.call(self.resolved_name, fields, timeout=0, headers=self._headers)
        return self.response_class.from_dict(values)


def wait_for_service(service: str, timeout: float | Duration | None = None) -> None:
    """Wait until somebody offers a service; programs that are no node may do so, too.

    Args:
        service: its name.
        timeout: the most seconds to wait, or a `Duration`; None for ever.

    Raises:
        ValueError: the timeout is 0.
        ROSException: it has passed.
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
            _look_for(resolved, seconds)
    except WaitTimeout:
        raise ROSException(f"timeout exceeded while waiting for service {resolved}") from None


def _wait_in_node(service: str, timeout: float | None) -> None:
    """Wait as a node until the service is there, or raise `WaitTimeout`."""
    from fibws.errors import InvalidName, WaitTimeout

    node = core.background.node
    try:
        core.background.call(node.wait_for_service(service, timeout=timeout))
    except InvalidName:  # Nobody can ever offer it; ROS waits all the same.
        if core.wait_for_shutdown(timeout):
            raise ROSInterruptException("rospy shutdown") from None
        raise WaitTimeout from None


def _look_for(service: str, timeout: float | None) -> None:
    """Look for a service again and again, or raise `WaitTimeout`."""
    from fibws.cli.link import Link
    from fibws.errors import HubLost, HubUnreachable, ServiceError, WaitTimeout

    end = None if timeout is None else monotonic() + timeout
    has_warned = False
    while True:
        try:
            with Link("unnamed") as link:
                if link.call("/rosapi/service_type", {"service": service})["type"]:
                    return
        except (HubUnreachable, HubLost) as error:
            if not has_warned:
                from rospy import logwarn

                has_warned = True
                logwarn(f"wait_for_service({service}): {error}; will keep trying")
        except ServiceError:
            pass  # The hub is about to end.
        left = LOOK if end is None else min(LOOK, end - monotonic())
        if left <= 0:
            raise WaitTimeout
        sleep(left)
