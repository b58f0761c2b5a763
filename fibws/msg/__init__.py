"""Messages as Python classes, a module for each package.

    from fibws.msg.std_msgs import Int32

The standard packages are ordinary files here, which builds of fibws write, and imports in a
checkout (`fibws.interfaces.generated_modules`). A package of the user's own is written when it is
imported, from the folders that the environment variable ``FIBWS_INTERFACES`` names or that
`add_folder` was given; it then also goes before a standard one of its name.
"""

import sys
from functools import partial

from fibws.msg._finder import (
    ModuleFinder,
    add_folder,
    default_interfaces,
    message_class,
    no_such_package,
)

__all__ = ["add_folder", "default_interfaces", "message_class"]

if ModuleFinder not in sys.meta_path:
    sys.meta_path.insert(0, ModuleFinder)

__getattr__ = partial(no_such_package, sys.modules[__name__])
