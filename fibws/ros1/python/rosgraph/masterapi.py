"""What ROS's master is asked, asked of the hub."""

from __future__ import annotations

from typing import Any

from fibws.client.parameters import Parameters
from fibws.errors import FibwsError, HubUnreachable, ParameterNotSet, ServiceError
from rosgraph.names import GLOBALNS, get_ros_namespace, ns_join, resolve_name


class MasterException(Exception):
    """The base of what the master answers in vain."""


class MasterFailure(MasterException):
    """It could not do what it was asked for."""


class MasterError(MasterException):
    """It was asked for what is not there, or wrongly."""


Error = MasterError
Failure = MasterFailure
ROSMasterException = MasterException


def is_online(master_uri: str | None = None) -> bool:
    """Whether there is a hub."""
    return Master("rosgraph", master_uri).is_online()


class Master:
    """Asks the hub, over a connection that is made for each question.

    Names are global, or else relative to the namespace of ``caller_id``.

    Args:
        caller_id: the name of who asks.
        master_uri: has no effect: the hub is where $FIBWS_HUB says.

    Raises:
        OSError: there is no hub.
        MasterError: what is asked about is not there.
        MasterFailure: the hub refuses.
    """

    def __init__(self, caller_id: str, master_uri: str | None = None) -> None:
        self.caller_id = ns_join(get_ros_namespace(), caller_id)
        self.master_uri = master_uri

    def is_online(self) -> bool:
        """Whether there is a hub."""
        from fibws.client.hub_client import is_hub_running

        try:
            return is_hub_running(tool="rosgraph")
        except FibwsError:
            return False

    def getPid(self) -> int:
        """0: the hub does not tell; but it answers."""
        self.ask("get_time")
        return 0

    def getUri(self) -> str:
        """The hub's address."""
        from fibws.client.hub_client import (
            HubClient,  # It takes its time to load, and nodes never ask so.
        )

        try:
            with HubClient("rosgraph") as link:
                return link.url
        except FibwsError as error:
            raise ConnectionRefusedError(str(error)) from None

    def getParam(self, key: str) -> Any:
        """The value of a parameter, or of a namespace as a dict."""
        try:
            return self._parameters().get(self._global(key))
        except ParameterNotSet as error:
            raise MasterError(str(error)) from None

    def setParam(self, key: str, value: Any) -> int:
        """Set a parameter; 0."""
        self._parameters().set(self._global(key), value)
        return 0

    def hasParam(self, key: str) -> bool:
        """Whether there is such a parameter."""
        return self._parameters().has(self._global(key))

    def deleteParam(self, key: str) -> int:
        """Delete a parameter; 0."""
        name = self._global(key)
        if name == GLOBALNS:
            raise MasterError("cannot delete root of parameter tree")
        try:
            self._parameters().delete(name)
        except ParameterNotSet:
            raise MasterError(f"parameter [{name}] is not set") from None
        return 0

    def searchParam(self, key: str) -> str:
        """The global name of the parameter of that name that is nearest to who asks."""
        name = self._parameters().search(key)
        if name is None:
            raise MasterError(f"Cannot find parameter [{key}] in an upwards search")
        return name

    def getParamNames(self) -> list[str]:
        """The names of all parameters."""
        return self._parameters().names()

    def lookupNode(self, node_name: str) -> str:
        """The URI of a node."""
        name = self._global(node_name)
        for node in self.ask("graph")["nodes"]:
            if node["name"] == name:
                return _uri(node)
        raise MasterError(f"unknown node [{name}]")

    def lookupService(self, service: str) -> str:
        """The URI of the node that offers a service."""
        name = self._global(service)
        graph = self.ask("graph")
        nodes = {each["name"]: each for each in graph["nodes"]}
        for each in graph["services"]:
            if each["name"] == name:
                return _uri(nodes[each["node"]]).replace("http:", "rosrpc:")
        raise MasterError("no provider")

    def getPublishedTopics(self, subgraph: str) -> list[list[str]]:
        """The topics in a namespace that somebody publishes, as pairs of name and type."""
        above = f"{subgraph.rstrip('/')}/"
        return [
            [topic["name"], topic["type"]]
            for topic in self._topics()
            if topic.get("publishers", True) and topic["type"] and topic["name"].startswith(above)
        ]

    def getTopicTypes(self) -> list[list[str]]:
        """All topics whose type is known, as pairs of name and type."""
        return [[topic["name"], topic["type"]] for topic in self._topics() if topic["type"]]

    def getSystemState(self) -> list[list[list[Any]]]:
        """Who publishes, who subscribes, who offers services: each as pairs of name and nodes."""
        graph = self.ask("graph")
        services = [[each["name"], [each["node"]]] for each in graph["services"]]
        topics = graph["topics"]
        return [_nodes(topics, "publishers"), _nodes(topics, "subscriptions"), services]

    def ask(self, service: str, /, **request: Any) -> dict[str, Any]:
        """Call ``/rosapi/<service>`` with a request of these fields.

        Raises:
            OSError: there is no hub.
            MasterFailure: it refuses.
        """
        from fibws.client.hub_client import HubClient  # As for the URI.

        try:
            with HubClient("rosgraph") as link:
                return link.call(f"/rosapi/{service}", request)
        except HubUnreachable as error:
            raise ConnectionRefusedError(str(error)) from None
        except ServiceError as error:
            raise MasterFailure(error.text) from None
        except FibwsError as error:
            raise MasterFailure(str(error)) from None

    def _parameters(self) -> Parameters:
        return Parameters(lambda service, request: self.ask(service.rpartition("/")[2], **request))

    def _topics(self) -> list[dict[str, Any]]:
        """The topics, with who publishes them unless the hub is a rosbridge of ROS's own."""
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
    """The nodes of each topic that has some."""
    return [
        [topic["name"], list(dict.fromkeys(each["node"] for each in topic[key]))]
        for topic in topics
        if topic[key]
    ]


def _uri(node: dict[str, Any]) -> str:
    return f"http://{node['address'] or '127.0.0.1'}/"
