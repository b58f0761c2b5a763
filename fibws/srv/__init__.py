"""Services as Python classes, a module for each package.

    from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsRequest, AddTwoIntsResponse

What `fibws.msg` says of the user's own packages holds here too.
"""

import sys
from functools import partial

from fibws.msg._finder import no_such_package, service_class

__all__ = ["service_class"]

__getattr__ = partial(no_such_package, sys.modules[__name__])
