"""Services, by the name of the module that they have in rospy."""

from rospy.service import Service, ServiceException
from rospy.service_proxy import ServiceProxy, wait_for_service

__all__ = ["Service", "ServiceException", "ServiceProxy", "wait_for_service"]
