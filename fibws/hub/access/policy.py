"""The policy of a hub with authentication: granted and implied rights of principals.

Besides the rights that the operator grants, every principal has those without which no client of
ROS works: to call the hub's own services, whose answers hide what it may not see; to write log
lines; to serve the log levels of its own nodes; and to read the parameters that the hub sets. They
can be denied.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterable

from fibws.access.rights import Principal, Right, compile_globs
from fibws.hub.errors import NotAllowed
from fibws.hub.graph.action import CANCEL_SUFFIX
from fibws.hub.graph.graph import ROSBRIDGE

IMPLIED: dict[Right, re.Pattern[str]] = {
    "publish": compile_globs(["/rosout"]),
    # The services of other nodes would show that there are such nodes.
    "call": compile_globs(
        [f"{node}/get_loggers" for node in ("/rosout", ROSBRIDGE)] + ["/rosapi/*"]
    ),
    "param_read": compile_globs(
        [
            *("/run_id", "/rosdistro", "/rosversion", "/roslaunch/uris/*", "/use_sim_time"),
            *("/rosbridge_websocket/actual_port", "/rosbridge_websocket/actual_host"),
        ]
    ),
}
"""The rights of every principal."""
TOOL = re.compile(r"(/\w+)*/(fibws_[a-z_]+_\d+_\d+|page_[0-9a-f]+)", re.ASCII)
"""Names that fibws's commands and the page give themselves: everybody may use tools."""
FOR_ADMINS = ("/connected_clients",)
"""Topics with the addresses of clients."""
LOGGERS = ("get_loggers", "set_logger_level")
"""The services by which a ROS node shows and sets the levels of its log, below its name."""


class AccessPolicy:
    """Decides by principals; a `Policy`.

    A name of a node that some principal's ``node`` globs match is kept for those whose globs match
    it; only ``/**`` keeps none. Principals without such globs may use all other names. The names
    that tools give themselves are free for all.

    Args:
        known: the principals whose names are kept for them.
    """

    allows_all = False

    def __init__(self, known: Iterable[Principal] = ()) -> None:
        self._principals: dict[str, Principal] = {}
        """The principals of the connected nodes, by node."""
        self._kept: list[re.Pattern[str]] = []
        self.keep_names(known)

    def keep_names(self, known: Iterable[Principal]) -> None:
        """Set the principals whose nodes' names are kept for them."""
        self._kept = [
            compile_globs(set(each.rights.allow.get("node", ())) - {"/**", "**"}, each.name)
            for each in known
        ]

    def enter(
        self, node: str, principal: Principal | None, *, is_chosen: bool, is_taken: bool
    ) -> None:
        """Let a principal's client be a node; see `Policy.enter`."""
        if principal is None:
            raise NotAllowed(node, "node", node, f"missing token for {node}")
        # First the right: who may not have the name must not learn whether there is such a node.
        if is_chosen and not self._may_be(principal, node):
            raise NotAllowed(node, "node", node)
        owner = self._principals.get(node)
        if is_taken and not (owner is not None and owner.is_same(principal)):
            raise NotAllowed(node, "node", node, f"{node} is a node of another principal")
        self._principals[node] = principal

    def leave(self, node: str) -> None:
        """Forget the principal of a node, which has no rights then."""
        self._principals.pop(node, None)

    def may(self, node: str, right: Right, name: str) -> bool:
        """Return whether a node's principal may do this."""
        principal = self._principals.get(node)
        if principal is None:
            return False
        name = name.removesuffix(CANCEL_SUFFIX)
        if right in ("call", "provide"):
            owner, _, service = name.rpartition("/")
            if service in LOGGERS and self.is_same_owner(node, owner):
                return not principal.rights.denies(right, name)
            if right == "call" and service == LOGGERS[1] and not principal.rights.admin:
                return False
        if right == "subscribe" and name in FOR_ADMINS and not principal.rights.admin:
            return False
        implied = IMPLIED.get(right)
        if implied is not None and implied.fullmatch(name):
            return not principal.rights.denies(right, name)
        return principal.rights.allows(right, name)

    def is_admin(self, node: str) -> bool:
        """Return whether a node's principal is an admin."""
        principal = self._principals.get(node)
        return principal is not None and principal.rights.admin

    def owner(self, node: str) -> str:
        """Return the name of a node's principal; the node itself if it has none."""
        principal = self._principals.get(node)
        return principal.title if principal is not None else node

    def is_same_owner(self, node: str, other: str) -> bool:
        """Return whether two nodes belong to one principal."""
        principal, owner = self._principals.get(node), self._principals.get(other)
        if principal is None or owner is None:
            return False
        return node == other or principal.is_same(owner)

    def view(self, node: str) -> Hashable:
        """Return an equal value for all nodes of a principal; each anonymous node has its own."""
        principal = self._principals.get(node)
        if principal is None or not principal.is_same(principal):  # Anonymous ones are strangers.
            return node
        return principal.proof, principal.name, principal.rights.text

    def _may_be(self, principal: Principal, node: str) -> bool:
        rights = principal.rights
        if TOOL.fullmatch(node):
            return not rights.denies("node", node)
        if rights.admin or "node" in rights.allow:
            return rights.allows("node", node)
        is_kept = any(pattern.fullmatch(node) for pattern in self._kept)
        return not is_kept and not rights.denies("node", node)
