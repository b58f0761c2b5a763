"""The services of rosapi, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import rosapi

__all__ = [
    "DeleteParam",
    "DeleteParamRequest",
    "DeleteParamResponse",
    "GetActionServers",
    "GetActionServersRequest",
    "GetActionServersResponse",
    "GetParam",
    "GetParamNames",
    "GetParamNamesRequest",
    "GetParamNamesResponse",
    "GetParamRequest",
    "GetParamResponse",
    "GetTime",
    "GetTimeRequest",
    "GetTimeResponse",
    "HasParam",
    "HasParamRequest",
    "HasParamResponse",
    "MessageDetails",
    "MessageDetailsRequest",
    "MessageDetailsResponse",
    "NodeDetails",
    "NodeDetailsRequest",
    "NodeDetailsResponse",
    "Nodes",
    "NodesRequest",
    "NodesResponse",
    "Publishers",
    "PublishersRequest",
    "PublishersResponse",
    "SearchParam",
    "SearchParamRequest",
    "SearchParamResponse",
    "ServiceHost",
    "ServiceHostRequest",
    "ServiceHostResponse",
    "ServiceNode",
    "ServiceNodeRequest",
    "ServiceNodeResponse",
    "ServiceProviders",
    "ServiceProvidersRequest",
    "ServiceProvidersResponse",
    "ServiceRequestDetails",
    "ServiceRequestDetailsRequest",
    "ServiceRequestDetailsResponse",
    "ServiceResponseDetails",
    "ServiceResponseDetailsRequest",
    "ServiceResponseDetailsResponse",
    "ServiceType",
    "ServiceTypeRequest",
    "ServiceTypeResponse",
    "Services",
    "ServicesForType",
    "ServicesForTypeRequest",
    "ServicesForTypeResponse",
    "ServicesRequest",
    "ServicesResponse",
    "SetParam",
    "SetParamRequest",
    "SetParamResponse",
    "Subscribers",
    "SubscribersRequest",
    "SubscribersResponse",
    "TopicType",
    "TopicTypeRequest",
    "TopicTypeResponse",
    "Topics",
    "TopicsAndRawTypes",
    "TopicsAndRawTypesRequest",
    "TopicsAndRawTypesResponse",
    "TopicsForType",
    "TopicsForTypeRequest",
    "TopicsForTypeResponse",
    "TopicsRequest",
    "TopicsResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class DeleteParamRequest(ros.Message):
    """rosapi/DeleteParamRequest"""

    _type: ClassVar[str] = "rosapi/DeleteParamRequest"

    name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class DeleteParamResponse(ros.Message):
    """rosapi/DeleteParamResponse"""

    _type: ClassVar[str] = "rosapi/DeleteParamResponse"


class DeleteParam(ros.Service[DeleteParamRequest, DeleteParamResponse]):
    """rosapi/DeleteParam"""

    _type = "rosapi/DeleteParam"
    Request: TypeAlias = DeleteParamRequest
    Response: TypeAlias = DeleteParamResponse


@dataclass(slots=True, eq=False, repr=False)
class GetActionServersRequest(ros.Message):
    """rosapi/GetActionServersRequest"""

    _type: ClassVar[str] = "rosapi/GetActionServersRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetActionServersResponse(ros.Message):
    """rosapi/GetActionServersResponse"""

    _type: ClassVar[str] = "rosapi/GetActionServersResponse"

    action_servers: list[str] = field(default_factory=list)


class GetActionServers(ros.Service[GetActionServersRequest, GetActionServersResponse]):
    """rosapi/GetActionServers"""

    _type = "rosapi/GetActionServers"
    Request: TypeAlias = GetActionServersRequest
    Response: TypeAlias = GetActionServersResponse


@dataclass(slots=True, eq=False, repr=False)
class GetParamRequest(ros.Message):
    """rosapi/GetParamRequest"""

    _type: ClassVar[str] = "rosapi/GetParamRequest"

    name: str = ""
    default: str = ""


@dataclass(slots=True, eq=False, repr=False)
class GetParamResponse(ros.Message):
    """rosapi/GetParamResponse"""

    _type: ClassVar[str] = "rosapi/GetParamResponse"

    value: str = ""


class GetParam(ros.Service[GetParamRequest, GetParamResponse]):
    """rosapi/GetParam"""

    _type = "rosapi/GetParam"
    Request: TypeAlias = GetParamRequest
    Response: TypeAlias = GetParamResponse


@dataclass(slots=True, eq=False, repr=False)
class GetParamNamesRequest(ros.Message):
    """rosapi/GetParamNamesRequest"""

    _type: ClassVar[str] = "rosapi/GetParamNamesRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetParamNamesResponse(ros.Message):
    """rosapi/GetParamNamesResponse"""

    _type: ClassVar[str] = "rosapi/GetParamNamesResponse"

    names: list[str] = field(default_factory=list)


class GetParamNames(ros.Service[GetParamNamesRequest, GetParamNamesResponse]):
    """rosapi/GetParamNames"""

    _type = "rosapi/GetParamNames"
    Request: TypeAlias = GetParamNamesRequest
    Response: TypeAlias = GetParamNamesResponse


@dataclass(slots=True, eq=False, repr=False)
class GetTimeRequest(ros.Message):
    """rosapi/GetTimeRequest"""

    _type: ClassVar[str] = "rosapi/GetTimeRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetTimeResponse(ros.Message):
    """rosapi/GetTimeResponse"""

    _type: ClassVar[str] = "rosapi/GetTimeResponse"

    time: ros.Time = field(default_factory=ros.Time)


class GetTime(ros.Service[GetTimeRequest, GetTimeResponse]):
    """rosapi/GetTime"""

    _type = "rosapi/GetTime"
    Request: TypeAlias = GetTimeRequest
    Response: TypeAlias = GetTimeResponse


@dataclass(slots=True, eq=False, repr=False)
class HasParamRequest(ros.Message):
    """rosapi/HasParamRequest"""

    _type: ClassVar[str] = "rosapi/HasParamRequest"

    name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class HasParamResponse(ros.Message):
    """rosapi/HasParamResponse"""

    _type: ClassVar[str] = "rosapi/HasParamResponse"

    exists: bool = False


class HasParam(ros.Service[HasParamRequest, HasParamResponse]):
    """rosapi/HasParam"""

    _type = "rosapi/HasParam"
    Request: TypeAlias = HasParamRequest
    Response: TypeAlias = HasParamResponse


@dataclass(slots=True, eq=False, repr=False)
class MessageDetailsRequest(ros.Message):
    """rosapi/MessageDetailsRequest"""

    _type: ClassVar[str] = "rosapi/MessageDetailsRequest"

    type: str = ""


@dataclass(slots=True, eq=False, repr=False)
class MessageDetailsResponse(ros.Message):
    """rosapi/MessageDetailsResponse"""

    _type: ClassVar[str] = "rosapi/MessageDetailsResponse"

    typedefs: list[rosapi.TypeDef] = field(default_factory=list)


class MessageDetails(ros.Service[MessageDetailsRequest, MessageDetailsResponse]):
    """rosapi/MessageDetails"""

    _type = "rosapi/MessageDetails"
    Request: TypeAlias = MessageDetailsRequest
    Response: TypeAlias = MessageDetailsResponse


@dataclass(slots=True, eq=False, repr=False)
class NodeDetailsRequest(ros.Message):
    """rosapi/NodeDetailsRequest"""

    _type: ClassVar[str] = "rosapi/NodeDetailsRequest"

    node: str = ""


@dataclass(slots=True, eq=False, repr=False)
class NodeDetailsResponse(ros.Message):
    """rosapi/NodeDetailsResponse"""

    _type: ClassVar[str] = "rosapi/NodeDetailsResponse"

    subscribing: list[str] = field(default_factory=list)
    publishing: list[str] = field(default_factory=list)
    services: list[str] = field(default_factory=list)


class NodeDetails(ros.Service[NodeDetailsRequest, NodeDetailsResponse]):
    """rosapi/NodeDetails"""

    _type = "rosapi/NodeDetails"
    Request: TypeAlias = NodeDetailsRequest
    Response: TypeAlias = NodeDetailsResponse


@dataclass(slots=True, eq=False, repr=False)
class NodesRequest(ros.Message):
    """rosapi/NodesRequest"""

    _type: ClassVar[str] = "rosapi/NodesRequest"


@dataclass(slots=True, eq=False, repr=False)
class NodesResponse(ros.Message):
    """rosapi/NodesResponse"""

    _type: ClassVar[str] = "rosapi/NodesResponse"

    nodes: list[str] = field(default_factory=list)


class Nodes(ros.Service[NodesRequest, NodesResponse]):
    """rosapi/Nodes"""

    _type = "rosapi/Nodes"
    Request: TypeAlias = NodesRequest
    Response: TypeAlias = NodesResponse


@dataclass(slots=True, eq=False, repr=False)
class PublishersRequest(ros.Message):
    """rosapi/PublishersRequest"""

    _type: ClassVar[str] = "rosapi/PublishersRequest"

    topic: str = ""


@dataclass(slots=True, eq=False, repr=False)
class PublishersResponse(ros.Message):
    """rosapi/PublishersResponse"""

    _type: ClassVar[str] = "rosapi/PublishersResponse"

    publishers: list[str] = field(default_factory=list)


class Publishers(ros.Service[PublishersRequest, PublishersResponse]):
    """rosapi/Publishers"""

    _type = "rosapi/Publishers"
    Request: TypeAlias = PublishersRequest
    Response: TypeAlias = PublishersResponse


@dataclass(slots=True, eq=False, repr=False)
class SearchParamRequest(ros.Message):
    """rosapi/SearchParamRequest"""

    _type: ClassVar[str] = "rosapi/SearchParamRequest"

    name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class SearchParamResponse(ros.Message):
    """rosapi/SearchParamResponse"""

    _type: ClassVar[str] = "rosapi/SearchParamResponse"

    global_name: str = ""


class SearchParam(ros.Service[SearchParamRequest, SearchParamResponse]):
    """rosapi/SearchParam"""

    _type = "rosapi/SearchParam"
    Request: TypeAlias = SearchParamRequest
    Response: TypeAlias = SearchParamResponse


@dataclass(slots=True, eq=False, repr=False)
class ServiceHostRequest(ros.Message):
    """rosapi/ServiceHostRequest"""

    _type: ClassVar[str] = "rosapi/ServiceHostRequest"

    service: str = ""


@dataclass(slots=True, eq=False, repr=False)
class ServiceHostResponse(ros.Message):
    """rosapi/ServiceHostResponse"""

    _type: ClassVar[str] = "rosapi/ServiceHostResponse"

    host: str = ""


class ServiceHost(ros.Service[ServiceHostRequest, ServiceHostResponse]):
    """rosapi/ServiceHost"""

    _type = "rosapi/ServiceHost"
    Request: TypeAlias = ServiceHostRequest
    Response: TypeAlias = ServiceHostResponse


@dataclass(slots=True, eq=False, repr=False)
class ServiceNodeRequest(ros.Message):
    """rosapi/ServiceNodeRequest"""

    _type: ClassVar[str] = "rosapi/ServiceNodeRequest"

    service: str = ""


@dataclass(slots=True, eq=False, repr=False)
class ServiceNodeResponse(ros.Message):
    """rosapi/ServiceNodeResponse"""

    _type: ClassVar[str] = "rosapi/ServiceNodeResponse"

    node: str = ""


class ServiceNode(ros.Service[ServiceNodeRequest, ServiceNodeResponse]):
    """rosapi/ServiceNode"""

    _type = "rosapi/ServiceNode"
    Request: TypeAlias = ServiceNodeRequest
    Response: TypeAlias = ServiceNodeResponse


@dataclass(slots=True, eq=False, repr=False)
class ServiceProvidersRequest(ros.Message):
    """rosapi/ServiceProvidersRequest"""

    _type: ClassVar[str] = "rosapi/ServiceProvidersRequest"

    service: str = ""


@dataclass(slots=True, eq=False, repr=False)
class ServiceProvidersResponse(ros.Message):
    """rosapi/ServiceProvidersResponse"""

    _type: ClassVar[str] = "rosapi/ServiceProvidersResponse"

    providers: list[str] = field(default_factory=list)


class ServiceProviders(ros.Service[ServiceProvidersRequest, ServiceProvidersResponse]):
    """rosapi/ServiceProviders"""

    _type = "rosapi/ServiceProviders"
    Request: TypeAlias = ServiceProvidersRequest
    Response: TypeAlias = ServiceProvidersResponse


@dataclass(slots=True, eq=False, repr=False)
class ServiceRequestDetailsRequest(ros.Message):
    """rosapi/ServiceRequestDetailsRequest"""

    _type: ClassVar[str] = "rosapi/ServiceRequestDetailsRequest"

    type: str = ""


@dataclass(slots=True, eq=False, repr=False)
class ServiceRequestDetailsResponse(ros.Message):
    """rosapi/ServiceRequestDetailsResponse"""

    _type: ClassVar[str] = "rosapi/ServiceRequestDetailsResponse"

    typedefs: list[rosapi.TypeDef] = field(default_factory=list)


class ServiceRequestDetails(
    ros.Service[ServiceRequestDetailsRequest, ServiceRequestDetailsResponse]
):
    """rosapi/ServiceRequestDetails"""

    _type = "rosapi/ServiceRequestDetails"
    Request: TypeAlias = ServiceRequestDetailsRequest
    Response: TypeAlias = ServiceRequestDetailsResponse


@dataclass(slots=True, eq=False, repr=False)
class ServiceResponseDetailsRequest(ros.Message):
    """rosapi/ServiceResponseDetailsRequest"""

    _type: ClassVar[str] = "rosapi/ServiceResponseDetailsRequest"

    type: str = ""


@dataclass(slots=True, eq=False, repr=False)
class ServiceResponseDetailsResponse(ros.Message):
    """rosapi/ServiceResponseDetailsResponse"""

    _type: ClassVar[str] = "rosapi/ServiceResponseDetailsResponse"

    typedefs: list[rosapi.TypeDef] = field(default_factory=list)


class ServiceResponseDetails(
    ros.Service[ServiceResponseDetailsRequest, ServiceResponseDetailsResponse]
):
    """rosapi/ServiceResponseDetails"""

    _type = "rosapi/ServiceResponseDetails"
    Request: TypeAlias = ServiceResponseDetailsRequest
    Response: TypeAlias = ServiceResponseDetailsResponse


@dataclass(slots=True, eq=False, repr=False)
class ServiceTypeRequest(ros.Message):
    """rosapi/ServiceTypeRequest"""

    _type: ClassVar[str] = "rosapi/ServiceTypeRequest"

    service: str = ""


@dataclass(slots=True, eq=False, repr=False)
class ServiceTypeResponse(ros.Message):
    """rosapi/ServiceTypeResponse"""

    _type: ClassVar[str] = "rosapi/ServiceTypeResponse"

    type: str = ""


class ServiceType(ros.Service[ServiceTypeRequest, ServiceTypeResponse]):
    """rosapi/ServiceType"""

    _type = "rosapi/ServiceType"
    Request: TypeAlias = ServiceTypeRequest
    Response: TypeAlias = ServiceTypeResponse


@dataclass(slots=True, eq=False, repr=False)
class ServicesRequest(ros.Message):
    """rosapi/ServicesRequest"""

    _type: ClassVar[str] = "rosapi/ServicesRequest"


@dataclass(slots=True, eq=False, repr=False)
class ServicesResponse(ros.Message):
    """rosapi/ServicesResponse"""

    _type: ClassVar[str] = "rosapi/ServicesResponse"

    services: list[str] = field(default_factory=list)


class Services(ros.Service[ServicesRequest, ServicesResponse]):
    """rosapi/Services"""

    _type = "rosapi/Services"
    Request: TypeAlias = ServicesRequest
    Response: TypeAlias = ServicesResponse


@dataclass(slots=True, eq=False, repr=False)
class ServicesForTypeRequest(ros.Message):
    """rosapi/ServicesForTypeRequest"""

    _type: ClassVar[str] = "rosapi/ServicesForTypeRequest"

    type: str = ""


@dataclass(slots=True, eq=False, repr=False)
class ServicesForTypeResponse(ros.Message):
    """rosapi/ServicesForTypeResponse"""

    _type: ClassVar[str] = "rosapi/ServicesForTypeResponse"

    services: list[str] = field(default_factory=list)


class ServicesForType(ros.Service[ServicesForTypeRequest, ServicesForTypeResponse]):
    """rosapi/ServicesForType"""

    _type = "rosapi/ServicesForType"
    Request: TypeAlias = ServicesForTypeRequest
    Response: TypeAlias = ServicesForTypeResponse


@dataclass(slots=True, eq=False, repr=False)
class SetParamRequest(ros.Message):
    """rosapi/SetParamRequest"""

    _type: ClassVar[str] = "rosapi/SetParamRequest"

    name: str = ""
    value: str = ""


@dataclass(slots=True, eq=False, repr=False)
class SetParamResponse(ros.Message):
    """rosapi/SetParamResponse"""

    _type: ClassVar[str] = "rosapi/SetParamResponse"


class SetParam(ros.Service[SetParamRequest, SetParamResponse]):
    """rosapi/SetParam"""

    _type = "rosapi/SetParam"
    Request: TypeAlias = SetParamRequest
    Response: TypeAlias = SetParamResponse


@dataclass(slots=True, eq=False, repr=False)
class SubscribersRequest(ros.Message):
    """rosapi/SubscribersRequest"""

    _type: ClassVar[str] = "rosapi/SubscribersRequest"

    topic: str = ""


@dataclass(slots=True, eq=False, repr=False)
class SubscribersResponse(ros.Message):
    """rosapi/SubscribersResponse"""

    _type: ClassVar[str] = "rosapi/SubscribersResponse"

    subscribers: list[str] = field(default_factory=list)


class Subscribers(ros.Service[SubscribersRequest, SubscribersResponse]):
    """rosapi/Subscribers"""

    _type = "rosapi/Subscribers"
    Request: TypeAlias = SubscribersRequest
    Response: TypeAlias = SubscribersResponse


@dataclass(slots=True, eq=False, repr=False)
class TopicTypeRequest(ros.Message):
    """rosapi/TopicTypeRequest"""

    _type: ClassVar[str] = "rosapi/TopicTypeRequest"

    topic: str = ""


@dataclass(slots=True, eq=False, repr=False)
class TopicTypeResponse(ros.Message):
    """rosapi/TopicTypeResponse"""

    _type: ClassVar[str] = "rosapi/TopicTypeResponse"

    type: str = ""


class TopicType(ros.Service[TopicTypeRequest, TopicTypeResponse]):
    """rosapi/TopicType"""

    _type = "rosapi/TopicType"
    Request: TypeAlias = TopicTypeRequest
    Response: TypeAlias = TopicTypeResponse


@dataclass(slots=True, eq=False, repr=False)
class TopicsRequest(ros.Message):
    """rosapi/TopicsRequest"""

    _type: ClassVar[str] = "rosapi/TopicsRequest"


@dataclass(slots=True, eq=False, repr=False)
class TopicsResponse(ros.Message):
    """rosapi/TopicsResponse"""

    _type: ClassVar[str] = "rosapi/TopicsResponse"

    topics: list[str] = field(default_factory=list)
    types: list[str] = field(default_factory=list)


class Topics(ros.Service[TopicsRequest, TopicsResponse]):
    """rosapi/Topics"""

    _type = "rosapi/Topics"
    Request: TypeAlias = TopicsRequest
    Response: TypeAlias = TopicsResponse


@dataclass(slots=True, eq=False, repr=False)
class TopicsAndRawTypesRequest(ros.Message):
    """rosapi/TopicsAndRawTypesRequest"""

    _type: ClassVar[str] = "rosapi/TopicsAndRawTypesRequest"


@dataclass(slots=True, eq=False, repr=False)
class TopicsAndRawTypesResponse(ros.Message):
    """rosapi/TopicsAndRawTypesResponse"""

    _type: ClassVar[str] = "rosapi/TopicsAndRawTypesResponse"

    topics: list[str] = field(default_factory=list)
    types: list[str] = field(default_factory=list)
    typedefs_full_text: list[str] = field(default_factory=list)


class TopicsAndRawTypes(ros.Service[TopicsAndRawTypesRequest, TopicsAndRawTypesResponse]):
    """rosapi/TopicsAndRawTypes"""

    _type = "rosapi/TopicsAndRawTypes"
    Request: TypeAlias = TopicsAndRawTypesRequest
    Response: TypeAlias = TopicsAndRawTypesResponse


@dataclass(slots=True, eq=False, repr=False)
class TopicsForTypeRequest(ros.Message):
    """rosapi/TopicsForTypeRequest"""

    _type: ClassVar[str] = "rosapi/TopicsForTypeRequest"

    type: str = ""


@dataclass(slots=True, eq=False, repr=False)
class TopicsForTypeResponse(ros.Message):
    """rosapi/TopicsForTypeResponse"""

    _type: ClassVar[str] = "rosapi/TopicsForTypeResponse"

    topics: list[str] = field(default_factory=list)


class TopicsForType(ros.Service[TopicsForTypeRequest, TopicsForTypeResponse]):
    """rosapi/TopicsForType"""

    _type = "rosapi/TopicsForType"
    Request: TypeAlias = TopicsForTypeRequest
    Response: TypeAlias = TopicsForTypeResponse
