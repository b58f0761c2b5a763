"""Actions as Python classes, a module for each package.

    from fibws.action.actionlib_tutorials import Fibonacci

The messages of an action are in `fibws.msg`. What that says of the user's own packages holds here
too.
"""

import sys
from functools import partial

from fibws.msg._finder import action_class, no_such_package

__all__ = ["action_class"]

__getattr__ = partial(no_such_package, sys.modules[__name__])
