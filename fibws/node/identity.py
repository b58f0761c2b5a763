"""Who a node is: its name, and what other names mean to it."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from typing import Self

from fibws import names


@dataclass(frozen=True, slots=True)
class Identity:
    """A node's global name, the namespace where its relative names belong, and what is renamed."""

    name: str
    namespace: str
    remapping: names.Remapping

    @classmethod
    def choose(
        cls, name: str, *, anonymous: bool, namespace: str | None, remapping: names.Remapping
    ) -> Self:
        """Who a node is by its program, its command line and $ROS_NAMESPACE; see `Node`."""
        names.check_base(name)
        if remapping.node_name is not None:
            name = remapping.node_name
        elif anonymous:
            name = names.anonymous(name, pid=os.getpid(), milliseconds=time.time_ns() // 1_000_000)
        namespace = names.check_namespace(
            remapping.namespace or namespace or os.environ.get("ROS_NAMESPACE", "/")
        )
        return cls(names.resolve(name, namespace=namespace), namespace, remapping)

    def resolve(self, name: str) -> str:
        """The global name that ``name`` stands for, remappings included."""
        return self.remapping.apply(name, namespace=self.namespace, node=self.name)
