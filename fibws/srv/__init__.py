"""Services as Python classes, a module for each package.

    from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsRequest, AddTwoIntsResponse

What `fibws.msg` says of the user's own packages holds here too.
"""

from fibws.msg._finder import service_class

__all__ = ["service_class"]
