"""The public names, each loaded when it is first used; a new one is added here alone."""

from .client import (
    delete_param as delete_param,
    get_master as get_master,
    get_param as get_param,
    get_param_cached as get_param_cached,
    get_param_names as get_param_names,
    get_published_topics as get_published_topics,
    has_param as has_param,
    init_node as init_node,
    myargv as myargv,
    on_shutdown as on_shutdown,
    search_param as search_param,
    set_param as set_param,
    spin as spin,
)
from .core import (
    get_node_uri as get_node_uri,
    is_shutdown as is_shutdown,
    signal_shutdown as signal_shutdown,
)
from .exceptions import (
    ROSException as ROSException,
    ROSInitException as ROSInitException,
    ROSInternalException as ROSInternalException,
    ROSInterruptException as ROSInterruptException,
    ROSSerializationException as ROSSerializationException,
    ROSTimeMovedBackwardsException as ROSTimeMovedBackwardsException,
    TransportException as TransportException,
    TransportInitError as TransportInitError,
    TransportTerminated as TransportTerminated,
)
from .log import (
    DEBUG as DEBUG,
    ERROR as ERROR,
    FATAL as FATAL,
    INFO as INFO,
    WARN as WARN,
    logdebug as logdebug,
    logdebug_once as logdebug_once,
    logdebug_throttle as logdebug_throttle,
    logdebug_throttle_identical as logdebug_throttle_identical,
    logerr as logerr,
    logerr_once as logerr_once,
    logerr_throttle as logerr_throttle,
    logerr_throttle_identical as logerr_throttle_identical,
    logfatal as logfatal,
    logfatal_once as logfatal_once,
    logfatal_throttle as logfatal_throttle,
    logfatal_throttle_identical as logfatal_throttle_identical,
    loginfo as loginfo,
    loginfo_once as loginfo_once,
    loginfo_throttle as loginfo_throttle,
    loginfo_throttle_identical as loginfo_throttle_identical,
    logout as logout,
    logwarn as logwarn,
    logwarn_once as logwarn_once,
    logwarn_throttle as logwarn_throttle,
    logwarn_throttle_identical as logwarn_throttle_identical,
)
from .msg import AnyMsg as AnyMsg, Header as Header, Message as Message
from .msproxy import MasterProxy as MasterProxy
from .names import (
    get_caller_id as get_caller_id,
    get_name as get_name,
    get_namespace as get_namespace,
    remap_name as remap_name,
    resolve_name as resolve_name,
)
from .rostime import (
    Duration as Duration,
    Time as Time,
    get_rostime as get_rostime,
    get_time as get_time,
    sleep as sleep,
)
from .service import Service as Service, ServiceException as ServiceException
from .service_proxy import ServiceProxy as ServiceProxy, wait_for_service as wait_for_service
from .timer import Rate as Rate, Timer as Timer
from .topics import (
    Publisher as Publisher,
    SubscribeListener as SubscribeListener,
    Subscriber as Subscriber,
    wait_for_message as wait_for_message,
)

__all__: list[str]
