"""Services, under the name of rospy's module."""

from rospy.service import Service, ServiceException
from rospy.service_proxy import ServiceProxy, wait_for_service

__all__ = ["Service", "ServiceException", "ServiceProxy", "wait_for_service"]
