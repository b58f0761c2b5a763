"""The requests that programs send to ROS's master, sent to the hub."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from fibws.client.parameters import HubParameters
from fibws.errors import FibwsError, HubUnreachable, ParameterNotSet, ServiceError
from rosgraph import parameter_values
from rosgraph.names import GLOBALNS, get_ros_namespace, ns_join, resolve_name


class MasterException(Exception):
    """The base of the master's errors."""


class MasterFailure(MasterException):
    """The hub could not handle a request."""


class MasterError(MasterException):
    """The request was invalid, or named something that does not exist."""


Error = MasterError
Failure = MasterFailure
ROSMasterException = MasterException


def is_online(master_uri: str | None = None) -> bool:
    """Return whether the hub can be reached."""
    return Master("rosgraph", master_uri).is_online()


@contextmanager
def reporting_no_master(error_class: type[Exception]) -> Iterator[None]:
    """Raise a tool's own error if the hub cannot be reached."""
    try:
        yield
    except (OSError, HubUnreachable) as error:
        raise error_class(f"Unable to communicate with master! {error}") from None


class Master:
    """Sends requests to the hub, each over a connection of its own.

    Names are global, or relative to the namespace of ``caller_id``.

    Args:
        caller_id: the name of the program.
        master_uri: ignored; $FIBWS_HUB has the hub's address.

    Raises:
        OSError: the hub cannot be reached.
        MasterError: a name is unknown.
        MasterFailure: the hub refuses.
    """

    def __init__(self, caller_id: str, master_uri: str | None = None) -> None:
        self.caller_id = ns_join(get_ros_namespace(), caller_id)
        self.master_uri = master_uri
        self._parameters = HubParameters(self.call)

    def is_online(self) -> bool:
        """Return whether the hub can be reached."""
        from fibws.client.hub_client import is_hub_running

        try:
            return is_hub_running(tool="rosgraph")
        except FibwsError:
            return False

    def getPid(self) -> int:
        """Return 0 if the hub can be reached; it does not report its process ID."""
        self.ask("get_time")
        return 0

    def getUri(self) -> str:
        """Return the hub's address."""
        from fibws.client.hub_client import HubClient  # Slow to load, and nodes do not need it.

        try:
            with HubClient("rosgraph") as client:
                return client.url
        except FibwsError as error:
            raise ConnectionRefusedError(str(error)) from None

    def getParam(self, key: str) -> Any:
        """Return the value of a parameter, or a namespace as a dict."""
        name = self._global(key)
        try:
            return parameter_values.native(self._parameters.get(name))
        except ParameterNotSet:
            raise MasterError(f"Parameter [{name}] is not set") from None
        except ServiceError as error:
            raise MasterFailure(error.text) from None

    def setParam(self, key: str, value: Any) -> int:
        """Set a parameter; return 0."""
        self._parameters.set(self._global(key), parameter_values.marked(value))
        return 0

    def hasParam(self, key: str) -> bool:
        """Return whether a parameter or a namespace exists."""
        return self._parameters.has(self._global(key))

    def deleteParam(self, key: str) -> int:
        """Delete a parameter; return 0."""
        name = self._global(key)
        if name == GLOBALNS:
            raise MasterError("cannot delete root of parameter tree")
        try:
            self._parameters.delete(name)
        except ParameterNotSet:
            raise MasterError(f"parameter [{name}] is not set") from None
        return 0

    def searchParam(self, key: str) -> str:
        """Return the global name of the nearest parameter of this name."""
        name = self._parameters.search(key)
        if name is None:
            raise MasterError(f"Cannot find parameter [{key}] in an upwards search")
        return name

    def getParamNames(self) -> list[str]:
        """Return the names of all parameters."""
        return self._parameters.names()

    def lookupNode(self, node_name: str) -> str:
        """Return the URI of a node."""
        name = self._global(node_name)
        for node in self.ask("graph")["nodes"]:
            if node["name"] == name:
                return _uri(node)
        raise MasterError(f"unknown node [{name}]")

    def lookupService(self, service: str) -> str:
        """Return the URI of the node that provides a service."""
        name = self._global(service)
        graph = self.ask("graph")
        nodes = {each["name"]: each for each in graph["nodes"]}
        for each in graph["services"]:
            if each["name"] == name:
                return _uri(nodes[each["node"]]).replace("http:", "rosrpc:")
        raise MasterError("no provider")

    def getPublishedTopics(self, subgraph: str) -> list[list[str]]:
        """Return the published topics in a namespace as pairs of name and type."""
        above = f"{subgraph.rstrip('/')}/"
        return [
            [topic["name"], topic["type"]]
            for topic in self._topics()
            if topic.get("publishers", True) and topic["type"] and topic["name"].startswith(above)
        ]

    def getTopicTypes(self) -> list[list[str]]:
        """Return all topics of known types as pairs of name and type."""
        return [[topic["name"], topic["type"]] for topic in self._topics() if topic["type"]]

    def getSystemState(self) -> list[list[list[Any]]]:
        """Return publishers, subscribers and service providers as pairs of name and nodes."""
        graph = self.ask("graph")
        services = [[each["name"], [each["node"]]] for each in graph["services"]]
        topics = graph["topics"]
        return [_nodes(topics, "publishers"), _nodes(topics, "subscriptions"), services]

    def ask(self, service: str, /, **request: Any) -> dict[str, Any]:
        """Call ``/rosapi/<service>`` with a request of these fields; see `call`."""
        return self.call(f"/rosapi/{service}", request)

    def call(self, service: str, request: dict[str, Any]) -> dict[str, Any]:
        """Call a service of the hub and return the response.

        Raises:
            OSError: the hub cannot be reached.
            MasterFailure: the hub refuses.
        """
        from fibws.client.hub_client import HubClient

        try:
            with HubClient("rosgraph") as client:
                return client.call(service, request)
        except HubUnreachable as error:
            raise ConnectionRefusedError(str(error)) from None
        except ServiceError as error:
            raise MasterFailure(error.text) from None
        except FibwsError as error:
            raise MasterFailure(str(error)) from None

    def _topics(self) -> list[dict[str, Any]]:
        """Return the topics, with their publishers unless the server is a rosbridge_suite."""
        try:
            return list(self.ask("graph")["topics"])
        except MasterFailure:
            found = self.ask("topics")
        return [
            {"name": name, "type": type_}
            for name, type_ in zip(found["topics"], found["types"], strict=False)
        ]

    def _global(self, name: str) -> str:
        return resolve_name(name, self.caller_id)


def _nodes(topics: list[dict[str, Any]], key: str) -> list[list[Any]]:
    """Return the nodes of each topic that has nodes in this role."""
    return [
        [topic["name"], list(dict.fromkeys(each["node"] for each in topic[key]))]
        for topic in topics
        if topic[key]
    ]


def _uri(node: dict[str, Any]) -> str:
    return f"http://{node['address'] or '127.0.0.1'}/"
