"""Expand a robot's description with xacro of PyPI, which finds the packages that rosrun finds.

xacro itself asks ROS 2's index of packages for ``$(find PACKAGE)``. This program answers instead.
"""

from __future__ import annotations

import sys
from importlib.util import find_spec
from types import ModuleType

from fibws.ros1.errors import PackageNotFound
from fibws.ros1.workspace.packages import Packages

INDEX = "ament_index_python"


def share_folder(package: str) -> str:
    """Return the folder of a package.

    Raises:
        xacro.XacroException: the name is unknown; the text suggests what to do.
    """
    from xacro import XacroException

    try:
        return str(Packages.from_environment().find(package).folder)
    except PackageNotFound as error:
        raise XacroException(str(error)) from None


def main() -> None:
    """Run xacro with the arguments of the command line."""
    if find_spec("xacro") is None:
        sys.exit("xacro is not installed; run pip install xacro")
    if find_spec(INDEX) is None:
        module = ModuleType(f"{INDEX}.packages")
        module.__dict__["get_package_share_directory"] = share_folder
        sys.modules[INDEX] = ModuleType(INDEX)
        sys.modules[f"{INDEX}.packages"] = module
    import xacro

    xacro.main()


if __name__ == "__main__":
    main()
