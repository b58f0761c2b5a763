"""Actions as Python classes, a module for each package.

    from fibws.action.actionlib_tutorials import Fibonacci

The messages of an action are in `fibws.msg`. What that says of the user's own packages holds here
too.
"""

from fibws.msg._finder import action_class

__all__ = ["action_class"]
