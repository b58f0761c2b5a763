"""The names of one graph as another hub sees them: below a prefix, and only those it may see."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from fibws.access.rights import compile_globs
from fibws.errors import InvalidName
from fibws.names import join, resolve_any


def level_of(name: str) -> str:
    """Return a text as one level of a name: ``robot_7`` for ``robot-7``."""
    level = re.sub(r"\W", "_", name, flags=re.ASCII) or "hub"
    return level if level[0].isalpha() else f"hub_{level}"


@dataclass(frozen=True)
class NameView:
    """Translates names between this hub's graph and a backplane, and filters them.

    On a backplane with a prefix one hub (the robot's, ``is_below``) has all its names below it, and
    the other (the fleet's) exchanges only what lies there. A node of the latter that lies elsewhere
    appears below the prefix and the name of its hub: ``/viewer`` of the hub ``cloud`` is
    ``/robot7/cloud/viewer`` there, and ``/cloud/viewer`` on the robot.

    Attributes:
        prefix: a global name; empty for none.
        is_below: whether all names of this hub lie below the prefix.
        hub: the name of this hub.
        exported: globs of this hub's names that the other hub gets: topics that are published
            here, services and actions that are served here, parameters.
        imported: globs of this hub's names that it takes from the other one.
    """

    prefix: str = ""
    is_below: bool = False
    hub: str = ""
    exported: Sequence[str] = ("/**",)
    imported: Sequence[str] = ("/**",)
    _exported: re.Pattern[str] = field(init=False, repr=False)
    _imported: re.Pattern[str] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_exported", compile_globs(self.exported))
        object.__setattr__(self, "_imported", compile_globs(self.imported))

    @property
    def is_filtered(self) -> bool:
        """Whether some names are neither exported nor imported."""
        return set(self.exported) != {"/**"} or set(self.imported) != {"/**"}

    def outward(self, name: str) -> str | None:
        """Return the name on the backplane of one of this hub; None if it has none there."""
        if self.is_below:
            return self.prefix + name
        return name if self._is_inside(name) else None

    def inward(self, name: str) -> str | None:
        """Return the name at this hub of one on the backplane; None if it may not be used."""
        if not self._is_inside(name):
            return None
        local = name[len(self.prefix) :] if self.is_below else name
        try:
            return local if resolve_any(local) == local else None
        except InvalidName:
            return None

    def node_outward(self, name: str) -> str:
        """Return the name on the backplane of a node of this hub."""
        return self.outward(name) or join(self.prefix, level_of(self.hub)) + name

    def own_node(self, name: str) -> str:
        """Return the node of this hub that has a name on the backplane; see `node_outward`."""
        hidden = join(self.prefix, level_of(self.hub))
        if self.prefix and not self.is_below and name.startswith(f"{hidden}/"):
            return name[len(hidden) :]
        return self.inward(name) or ""

    def may_export(self, name: str) -> bool:
        """Return whether a name of this hub is exported to the other one."""
        return self._exported.fullmatch(name) is not None

    def may_import(self, name: str) -> bool:
        """Return whether a name, as it is here, is imported from the other hub."""
        return self._imported.fullmatch(name) is not None

    def _is_inside(self, name: str) -> bool:
        return not self.prefix or name.startswith(f"{self.prefix}/")
