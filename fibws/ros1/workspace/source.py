"""A package as a workspace has it: its folder, its manifest, its recipe."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from fibws.ros1.workspace.manifest import Manifest
from fibws.ros1.workspace.recipe import Recipe


@dataclass
class Source:
    """One package to be built.

    Attributes:
        folder: where it is.
        manifest: what its package.xml says.
        recipe: what its CMakeLists.txt asks for.
    """

    folder: Path
    manifest: Manifest
    recipe: Recipe

    @property
    def name(self) -> str:
        """The package's name."""
        return self.manifest.name

    @cached_property
    def depends(self) -> set[str]:
        """The packages that are to be built before it."""
        return {*self.manifest.direct, *self.recipe.components, *self.recipe.message_packages}
