"""The public names, each loaded when it is first used; a new one is added here alone."""

from . import action as action, hub as hub, msg as msg, srv as srv, tf as tf
from .errors import (
    AccessDenied as AccessDenied,
    AccessError as AccessError,
    ActionError as ActionError,
    AlreadyOffered as AlreadyOffered,
    FibwsError as FibwsError,
    HubLimitReached as HubLimitReached,
    HubUnreachable as HubUnreachable,
    InterfaceError as InterfaceError,
    InvalidAddress as InvalidAddress,
    InvalidMessage as InvalidMessage,
    InvalidName as InvalidName,
    MessageTooLarge as MessageTooLarge,
    MissingRight as MissingRight,
    NodeClosed as NodeClosed,
    NodeError as NodeError,
    NodeKilled as NodeKilled,
    NodeReplaced as NodeReplaced,
    NotAuthorized as NotAuthorized,
    OperationRejected as OperationRejected,
    ParameterNotSet as ParameterNotSet,
    ServiceError as ServiceError,
    ServiceLost as ServiceLost,
    ServiceTimeout as ServiceTimeout,
    UnknownService as UnknownService,
    WaitTimeout as WaitTimeout,
)
from .hub.embedded import Hub as Hub
from .hub.settings import Settings as Settings
from .interfaces import (
    Action as Action,
    Duration as Duration,
    Message as Message,
    Service as Service,
    Time as Time,
)
from .names import Remapping as Remapping, parse_remappings as parse_remappings
from .node.actions.actions import Over as Over
from .node.actions.client import ActionClient as ActionClient, ClientGoal as ClientGoal
from .node.actions.server import (
    ActionServer as ActionServer,
    Execute as Execute,
    ServerGoal as ServerGoal,
)
from .node.graph import Graph as Graph, NodeDetails as NodeDetails
from .node.node import Node as Node
from .node.params import Params as Params
from .node.peers import Peers as Peers
from .node.program import run as run
from .node.publisher import Publisher as Publisher
from .node.clock import Rate as Rate
from .node.services import (
    Handler as Handler,
    HeaderHandler as HeaderHandler,
    ServiceServer as ServiceServer,
)
from .node.subscription import Subscription as Subscription
from .protocol.goals import GoalStatus as GoalStatus

__all__: list[str]
__version__: str
