"""What holds where a tag stands: its namespace, arguments, remappings, variables."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from fibws import names
from fibws.ros1.launch.world import World
from fibws.suggestions import suggestion_or_known

PRIVATE = "~"


@dataclass
class Scope:
    """What holds in a file, a <group>, an <include> or a <node>, each of which sees its parent's.

    Attributes:
        file: the launch file, which ``$(dirname)`` tells of.
        namespace: a global name, ``/`` or ``/robot``.
        values: those of the arguments.
        declared: the arguments that an <arg> has named here.
        passes_all: whether all arguments were passed here, so that an <arg> may change one.
        names: those that ``$(anon)`` made.
        remaps: from and to.
        private: parameters of every node that follows, by their names in it.
        environment: variables of every node that follows.
    """

    world: World
    file: str
    namespace: str = "/"
    values: dict[str, str] = field(default_factory=dict)
    declared: set[str] = field(default_factory=set)
    passes_all: bool = False
    names: dict[str, str] = field(default_factory=dict)
    remaps: dict[str, str] = field(default_factory=dict)
    private: dict[str, Any] = field(default_factory=dict)
    environment: dict[str, str] = field(default_factory=dict)

    def inner(self, namespace: str | None = None) -> Scope:
        """The scope within this one, in a namespace that is relative to this one's, or global."""
        return replace(
            self,
            namespace=self.namespace if namespace is None else self.join(namespace),
            values=dict(self.values),
            declared=set(self.declared),
            passes_all=False,
            names=dict(self.names),
            remaps=dict(self.remaps),
            private=dict(self.private),
            environment=dict(self.environment),
        )

    def included(self, file: str, namespace: str | None, *, passes_all: bool) -> Scope:
        """The scope of a file that is included here; it has no arguments but all or none of these.

        Args:
            file: the launch file.
            namespace: as for `inner`.
            passes_all: whether it has all arguments that there are here.
        """
        inner = self.inner(namespace)
        values = inner.values if passes_all else {}
        return replace(
            inner, file=file, values=values, declared=set(), passes_all=passes_all, names={}
        )

    def join(self, name: str) -> str:
        """The global name that a name stands for in this namespace."""
        return name_of(name if name.startswith("/") else names.join(self.namespace, name))

    def remap(self, source: str, target: str) -> None:
        """Change a name for the nodes that follow."""
        self.remaps.pop(source, None)
        self.remaps[source] = target

    def argument(self, name: str) -> str:
        """The value of an argument; it raises `ValueError` if there is none."""
        if name in self.values:
            return self.values[name]
        if name in self.declared:
            raise ValueError(f"the arg {name} has no value: it must be given as {name}:=VALUE")
        known = sorted(self.declared)
        raise ValueError(f"no <arg> is called {name} here{suggestion_or_known(name, known)}")

    def anonymous(self, name: str) -> str:
        """The name that ``$(anon name)`` stands for, the same every time."""
        if name not in self.names:
            self.names[name] = self.world.anonymous(name)
        return self.names[name]


def name_of(name: str) -> str:
    """A name without slashes that mean nothing: ``/a//b/`` is ``/a/b``."""
    first = "/" if name.startswith("/") else ""
    return first + "/".join(part for part in name.split("/") if part)
