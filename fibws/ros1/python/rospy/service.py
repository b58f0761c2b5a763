"""Services that the process provides."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable, Iterator
from types import TracebackType
from typing import TYPE_CHECKING, Any

from rospy import core, names
from rospy.impl.tcpros_base import DEFAULT_BUFF_SIZE
from rospy.msg import Message, serialized

if TYPE_CHECKING:
    import asyncio

    import fibws

_provided: dict[str, Service] = {}
_lock = threading.RLock()


class ServiceException(Exception):
    """A service call failed, or a service cannot be provided."""


class ServiceEnd:
    """The base of `Service` and `ServiceProxy`: a service's name and classes."""

    def __init__(self, name: str, service_class: Any) -> None:
        self.resolved_name = names.resolve_name(name)
        self.service_class = service_class
        self.request_class: type[Message] = service_class._request_class
        self.response_class: type[Message] = service_class._response_class


class Service(ServiceEnd):
    """Provides a service; handles each call in a thread of its own.

    Args:
        name: its name.
        service_class: its class.
        handler: takes the request and returns the response: whole, or its fields as a dict, a
            tuple or a list, or the value of its only field.
        buff_size: has no effect.
        error_handler: called if the handler raises, with the exception, its class, the exception
            again and the traceback; by default, they are logged.

    Raises:
        ValueError: the name is invalid.
        ServiceException: this node provides a service of the name already.
    """

    def __init__(
        self,
        name: str,
        service_class: Any,
        handler: Callable[[Any], Any],
        buff_size: int = DEFAULT_BUFF_SIZE,
        error_handler: Callable[..., object] | None = None,
    ) -> None:
        super().__init__(name, service_class)
        if not name or not isinstance(name, str):
            raise ValueError("service name is not a non-empty string")
        names.warn_unless_legal(name, stacklevel=3)
        self.handler = handler
        self.error_handler = error_handler or _log_error
        self.buff_size = buff_size
        self.done = False
        self._server: fibws.ServiceServer[Any, Any] | None = None
        with _lock:
            if self.resolved_name in _provided:
                raise ServiceException(f"service [{self.resolved_name}] already registered")
            _provided[self.resolved_name] = self
        core.on_start(self._register)

    def shutdown(self, reason: str = "") -> None:
        """Stop providing the service; calls that are being handled are finished.

        Args:
            reason: has no effect.
        """
        with _lock:
            if _provided.get(self.resolved_name) is self:
                del _provided[self.resolved_name]
        self.done = True
        core.wakeup.wake_all()
        core.background.soon(self._close)

    def spin(self) -> None:
        """Wait until the service or the node ends."""
        try:
            core.wakeup.wait(lambda: self.done or core.is_shutdown())
        except KeyboardInterrupt:
            pass

    def _register(self) -> None:
        if not self.done:
            core.register("service", self.resolved_name, self._provide())

    async def _provide(self) -> None:
        node = core.background.node
        self._server = await node.service(
            self.resolved_name, self.service_class, self._respond, headers=True
        )

    def _close(self) -> None:
        if self._server is not None:
            self._server.close()

    async def _respond(self, request: Any, header: dict[str, str]) -> Any:
        """Handle a call in a thread, which the handler may block."""
        import asyncio

        request._connection_header = {
            "service": self.resolved_name,
            "md5sum": self.service_class._md5sum,
            **header,
        }
        response: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        thread = threading.Thread(
            target=self._handle,
            args=(request, response),
            name=self.resolved_name,
            daemon=True,
        )
        thread.start()
        return await response

    def _handle(self, request: Any, future: asyncio.Future[Any]) -> None:
        from fibws.errors import CallRefused

        outcome: Any
        outcome = CallRefused("error processing request: its thread has ended")
        try:
            response = convert_return_to_response(self.handler(request), self.response_class)
            _keep_iterators(response)
            serialized(response)  # Checks the fields here, where the error handler can be called.
            outcome = response
        except ServiceException as error:
            outcome = CallRefused(f"service cannot process request: {error}")
        except Exception as error:
            outcome = CallRefused(f"error processing request: {error}")
            if not core.is_shutdown():
                self.error_handler(error, type(error), error, error.__traceback__)
        finally:
            core.background.soon(_settle, future, outcome)


def _log_error(
    error: Exception, kind: type[Exception], value: Exception, tb: TracebackType | None
) -> None:
    """Log a handler's exception."""
    from rospy import logerr

    logerr(f"Error processing request: {error}\n{traceback.format_exception(kind, value, tb)}")


def _settle(future: asyncio.Future[Any], outcome: Any) -> None:
    if future.done():
        return
    if isinstance(outcome, Exception):
        future.set_exception(outcome)
    else:
        future.set_result(outcome)


def _keep_iterators(response: Message) -> None:
    """Replace fields that can be read only once, such as ``map(...)``, by lists."""
    for name in response.__slots__:
        value = getattr(response, name)
        if isinstance(value, Iterator):
            setattr(response, name, list(value))


def convert_return_to_response(response: Any, response_class: type[Message]) -> Message:
    """Return a handler's result as a response.

    Raises:
        ServiceException: it cannot be converted.
    """
    if isinstance(response, Message) and response._type == response_class._type:
        return response
    if response is None:
        raise ServiceException("service handler returned None")
    if type(response) is dict:
        try:
            return response_class(**response)
        except AttributeError as error:
            raise ServiceException(f"handler returned invalid value: {error}") from None
    several = type(response) in (list, tuple)
    try:
        return response_class(*(response if several else (response,)))
    except TypeError as error:
        fault = "wrong number of values" if several else "invalid value"
        raise ServiceException(f"handler returned {fault}: {error}") from None
