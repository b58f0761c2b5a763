"""Packages in the shapes of those that are common in ROS 1."""

from __future__ import annotations

from dataclasses import dataclass, field

PROGRAM = "#!/usr/bin/env python\nprint('hello')\n"
CONFIG = """\
#!/usr/bin/env python
from dynamic_reconfigure.parameter_generator_catkin import *

gen = ParameterGenerator()
gen.add("size", int_t, 1, "A size", 5, 0, 10)
exit(gen.generate("reconfigured", "node", "Tutorials"))
"""
SETUP = """\
from distutils.core import setup
from catkin_pkg.python_setup import generate_distutils_setup

d = generate_distutils_setup(packages=['{name}'], package_dir={{'': 'src'}}{more})
setup(**d)
"""


@dataclass(frozen=True)
class Shape:
    """One package.

    Attributes:
        cmake: its CMakeLists.txt after find_package().
        components: what find_package(catkin) looks for.
        depends: its dependencies.
        manifest: elements of its package.xml.
        format: the format of that.
        files: its files; those that begin with #! are executable.
        programs: what is in devel/lib/<package>.
        imports: statements that import its messages and modules.
    """

    cmake: str
    components: str = ""
    depends: tuple[str, ...] = ()
    manifest: str = ""
    format: int = 2
    files: dict[str, str] = field(default_factory=dict)
    programs: tuple[str, ...] = ()
    imports: str = ""

    def package_xml(self, name: str) -> str:
        """Return its package.xml."""
        tags = ("depend",) if self.format > 1 else ("build_depend", "run_depend")
        depends = "\n  ".join(f"<{tag}>{each}</{tag}>" for each in self.depends for tag in tags)
        head = "<package>" if self.format == 1 else f'<package format="{self.format}">'
        return f"""\
<?xml version="1.0"?>
{head}
  <name>{name}</name>
  <version>1.14.2</version>
  <description>A package with <b>nodes</b>.</description>
  <maintainer email="maintainer@example.org">The Maintainer</maintainer>
  <license>BSD</license>
  <url type="website">http://wiki.example.org/{name}</url>
  <author>An Author</author>
  <buildtool_depend>catkin</buildtool_depend>
  {depends}
  {self.manifest}
</package>
"""

    def cmake_lists(self, name: str) -> str:
        """Return its CMakeLists.txt."""
        find = f"find_package(catkin REQUIRED{self.components and ' COMPONENTS '}{self.components})"
        return f"cmake_minimum_required(VERSION 3.0.2)\nproject({name})\n\n{find}\n{self.cmake}"


SHAPES = {
    "turtlesim": Shape(
        """
find_package(Qt5Widgets REQUIRED)
include_directories(include ${catkin_INCLUDE_DIRS} ${Boost_INCLUDE_DIRS})
add_message_files(DIRECTORY msg FILES
                  Color.msg Pose.msg)
add_service_files(DIRECTORY srv FILES Spawn.srv)
generate_messages(DEPENDENCIES geometry_msgs std_msgs std_srvs)
catkin_package(CATKIN_DEPENDS geometry_msgs message_runtime)
set(node_SRCS
  src/node.cpp
)
qt5_wrap_cpp(node_MOCS include/turtlesim/frame.h)
add_executable(turtlesim_node ${node_SRCS} ${node_MOCS})
target_link_libraries(turtlesim_node Qt5::Widgets ${catkin_LIBRARIES})
add_dependencies(turtlesim_node turtlesim_gencpp)
install(TARGETS turtlesim_node RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
""",
        "geometry_msgs message_generation rosconsole roscpp roscpp_serialization rostime",
        ("geometry_msgs", "qtbase5-dev", "roscpp", "std_srvs"),
        files={
            "msg/Color.msg": "uint8 r\nuint8 g\nuint8 b\n",
            "msg/Pose.msg": "float32 x\nfloat32 y\nfloat32 theta\nfloat32 shade\n",
            "srv/Spawn.srv": "float32 x\nstring name # optional\n---\nstring name\n",
        },
        imports="from turtlesim.msg import Pose; Pose().shade; from turtlesim.srv import Spawn",
    ),
    "rospy_tutorials": Shape(
        """
add_message_files(DIRECTORY msg FILES Floats.msg)
add_service_files(DIRECTORY srv FILES AddTwoInts.srv)
generate_messages(DEPENDENCIES std_msgs)
catkin_package(CATKIN_DEPENDS message_runtime std_msgs)
# one folder for each tutorial
catkin_install_python(PROGRAMS
  001_talker/talker
  001_talker/talker.py
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/001_talker
)
install(FILES 001_talker/talker.launch
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/001_talker)
if(CATKIN_ENABLE_TESTING)
  find_package(rostest)
  foreach(T test/a.launch test/b.launch)
    add_rostest(${T})
  endforeach()
endif()
""",
        "message_generation std_msgs",
        ("std_msgs", "rospy", "message_generation", "message_runtime"),
        "<test_depend>rostest</test_depend><test_depend>roscpp_tutorials</test_depend>",
        files={
            "msg/Floats.msg": "float32[] data\n",
            "srv/AddTwoInts.srv": "int64 a\nint64 b\n---\nint64 sum\n",
            "001_talker/talker": PROGRAM,
            "001_talker/talker.py": PROGRAM,
            "001_talker/talker.launch": "<launch/>",
        },
        imports="from rospy_tutorials.msg import Floats; from rospy_tutorials.srv import *",
    ),
    "actionlib_tutorials": Shape(
        """
find_package(Boost REQUIRED COMPONENTS system thread)
add_action_files(DIRECTORY action FILES Fibonacci.action)
generate_messages(DEPENDENCIES std_msgs actionlib_msgs)
catkin_package(CATKIN_DEPENDS message_runtime roscpp actionlib DEPENDS Boost)
add_executable(fibonacci_server src/fibonacci_server.cpp)
if(catkin_EXPORTED_TARGETS)
  add_dependencies(fibonacci_server ${catkin_EXPORTED_TARGETS})
endif()
add_dependencies(fibonacci_server ${${PROJECT_NAME}_EXPORTED_TARGETS})
install(PROGRAMS
  scripts/fibonacci_client.py
  scripts/fibonacci_server.py
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(TARGETS fibonacci_server
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
""",
        "actionlib message_generation",
        ("actionlib", "std_msgs", "roscpp"),
        format=1,
        files={
            "action/Fibonacci.action": "int32 order\n---\nint32[] all\n---\nint32[] some\n",
            "scripts/fibonacci_client.py": PROGRAM,
            "scripts/fibonacci_server.py": PROGRAM,
        },
        programs=("fibonacci_client.py", "fibonacci_server.py"),
        imports="from actionlib_tutorials.msg import FibonacciFeedback as F; F().some",
    ),
    "teleop_keyboard": Shape(
        """
catkin_package()
install(PROGRAMS
  teleop_keyboard.py
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION}
)
""",
        depends=("geometry_msgs", "rospy"),
        files={"teleop_keyboard.py": PROGRAM},
        programs=("teleop_keyboard.py",),
    ),
    "joint_publisher": Shape(
        """
catkin_package()
install(PROGRAMS joint_publisher/joint_publisher DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
if(CATKIN_ENABLE_TESTING)
  find_package(rostest)
  add_rostest(test/test_mimic.launch)
  unset(PYTHON_EXECUTABLE CACHE)
  find_package(PythonInterp 3 REQUIRED)
  add_test(NAME syntax COMMAND "${PYTHON_EXECUTABLE}" "-m" "flake8" "--select" "E999")
endif()
""",
        depends=("rospy", "sensor_msgs"),
        manifest=(
            '<exec_depend condition="$ROS_PYTHON_VERSION == 2">python-yaml</exec_depend>'
            '<exec_depend condition="$ROS_PYTHON_VERSION == 3">python3-yaml</exec_depend>'
        ),
        format=3,
        files={"joint_publisher/joint_publisher": PROGRAM},
        programs=("joint_publisher",),
    ),
    "rqt_plugin": Shape(
        """
catkin_package()
catkin_python_setup()

install(FILES plugin.xml
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}
)
install(DIRECTORY resource
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}
)
catkin_install_python(PROGRAMS scripts/rqt_plugin
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION}
)
""",
        depends=("rospy", "rqt_gui"),
        manifest='<export><rqt_gui plugin="${prefix}/plugin.xml"/></export>',
        files={
            "setup.py": SETUP.format(name="rqt_plugin", more=", scripts=['scripts/rqt_plugin']"),
            "src/rqt_plugin/__init__.py": "",
            "src/rqt_plugin/view.py": "NAME = 'view'\n",
            "scripts/rqt_plugin": PROGRAM,
            "plugin.xml": "<library/>",
        },
        programs=("rqt_plugin",),
        imports="from rqt_plugin.view import NAME",
    ),
    "measurement_msgs": Shape(
        """
add_message_files(DIRECTORY msg)
add_service_files()
generate_messages(DEPENDENCIES geometry_msgs)
catkin_package(CATKIN_DEPENDS geometry_msgs message_runtime)
install(FILES migration_rules/a.bmr DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
""",
        "geometry_msgs message_generation std_msgs",
        ("geometry_msgs", "std_msgs"),
        "<build_depend>message_generation</build_depend>"
        "<exec_depend>message_runtime</exec_depend>"
        '<export><rosbag migration_rule_file="migration_rules/a.bmr"/></export>',
        files={
            "msg/Measurement.msg": "std_msgs/Header header\ngeometry_msgs/Point point\n",
            "msg/Measurements.msg": "Measurement[] all\nuint8 GOOD=1\n",
            "srv/Measure.srv": "---\nMeasurements found\n",
        },
        imports="from measurement_msgs.msg import Measurements; from measurement_msgs.srv import *",
    ),
    "measurements": Shape(
        "catkin_metapackage()\n",
        manifest=(
            "<exec_depend>measurement_msgs</exec_depend><exec_depend>laser_pipe</exec_depend>"
            "<export><metapackage/></export>"
        ),
    ),
    "nodelets": Shape(
        """
include_directories(${catkin_INCLUDE_DIRS})
catkin_package(
  LIBRARIES nodelets_math
  CATKIN_DEPENDS nodelet roscpp std_msgs
)
add_library(nodelets_math src/plus.cpp)
target_link_libraries(nodelets_math ${catkin_LIBRARIES})
install(TARGETS nodelets_math
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
install(FILES nodelets.xml plus.launch
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
""",
        "nodelet roscpp std_msgs",
        ("nodelet", "roscpp", "std_msgs", "pluginlib"),
        manifest='<export><nodelet plugin="${prefix}/nodelets.xml"/></export>',
        files={"nodelets.xml": "<library/>", "plus.launch": "<launch/>"},
    ),
    "reconfigured": Shape(
        """
catkin_python_setup()
generate_dynamic_reconfigure_options(
  cfg/Tutorials.cfg
)
catkin_package(CATKIN_DEPENDS dynamic_reconfigure rospy)
add_executable(${PROJECT_NAME}_node src/server.cpp)
add_dependencies(${PROJECT_NAME}_node ${PROJECT_NAME}_gencfg)
catkin_install_python(PROGRAMS nodes/server.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
""",
        "rospy dynamic_reconfigure",
        ("rospy", "dynamic_reconfigure"),
        files={
            "setup.py": SETUP.format(name="reconfigured", more=""),
            "src/reconfigured/__init__.py": "",
            "cfg/Tutorials.cfg": CONFIG,
            "nodes/server.py": PROGRAM,
        },
        programs=("server.py",),
        imports="import reconfigured, reconfigured.cfg.TutorialsConfig",
    ),
    "python_only": Shape(
        """
catkin_python_setup()
catkin_package()
file(GLOB SCRIPTS RELATIVE "${CMAKE_CURRENT_SOURCE_DIR}"
  "${CMAKE_CURRENT_SOURCE_DIR}/scripts/*")
install(PROGRAMS ${SCRIPTS}
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
if(CATKIN_ENABLE_TESTING)
  catkin_add_nosetests(test)
endif()
""",
        depends=("rospy",),
        files={
            "setup.py": (
                "from setuptools import setup\nd = generate_distutils_setup()\n"
                "d['packages'] = ['python_only', 'python_only.parts']\n"
                "d['package_dir'] = {'': 'src'}\nd['scripts'] = [s for s in ()]\nsetup(**d)\n"
            ),
            "src/python_only/__init__.py": "",
            "src/python_only/parts/__init__.py": "PART = 1\n",
            "scripts/one": PROGRAM,
            "scripts/two.py": PROGRAM,
            "scripts/three.sh": "#!/bin/sh\n",
        },
        programs=("one", "two.py"),
        imports="from python_only.parts import PART",
    ),
    "mixed": Shape(
        """
set(CMAKE_CXX_FLAGS "${CMAKE_CXX_FLAGS} -std=c++14")
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
if(CMAKE_VERSION VERSION_LESS "3.1" AND (UNIX OR APPLE))
  message(WARNING "An old (CMake)")
endif()
set(MESSAGES State.msg)
list(APPEND MESSAGES Command.msg)
set(MESSAGE_DEPENDENCIES std_msgs measurement_msgs)
add_message_files(FILES ${MESSAGES})
generate_messages(DEPENDENCIES ${MESSAGE_DEPENDENCIES})
catkin_python_setup()
catkin_package(
  INCLUDE_DIRS include
  LIBRARIES ${PROJECT_NAME}
  CATKIN_DEPENDS roscpp ${MESSAGE_DEPENDENCIES}
  DEPENDS Eigen3
)
file(GLOB_RECURSE ${PROJECT_NAME}_SRCS src/*.cpp)
add_library(${PROJECT_NAME} SHARED ${${PROJECT_NAME}_SRCS})
add_library(${PROJECT_NAME}_headers INTERFACE)
add_executable(driver src/driver.cpp)
set_target_properties(driver PROPERTIES OUTPUT_NAME "mixed driver" PREFIX "")
macro(install_node name)
  install(PROGRAMS ${name} DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
endmacro()
install_node(nodes/node.py)
catkin_install_python(PROGRAMS nodes/node.py DESTINATION lib/${PROJECT_NAME})
""",
        "roscpp rospy message_generation std_msgs measurement_msgs",
        ("roscpp", "rospy", "std_msgs", "measurement_msgs", "eigen", "cmake_modules"),
        files={
            "setup.py": SETUP.format(name="mixed", more=""),
            "src/mixed/__init__.py": "SPEED = 1\n",
            "src/mixed/core.py": "from mixed.msg import State\n",
            "msg/State.msg": "Header header\nmeasurement_msgs/Measurement last\n",
            "msg/Command.msg": "float64 speed\n",
            "nodes/node.py": PROGRAM,
        },
        programs=("node.py",),
        imports="from mixed.msg import State; import mixed.core; mixed.SPEED; State().last.header",
    ),
    "beginner_tutorials": Shape(
        """
## Generate messages in the 'msg' folder
add_message_files(
  FILES
  Num.msg
#   Message2.msg
)
## Generate services in the 'srv' folder
add_service_files(
  FILES
  AddTwoInts.srv
)
# add_action_files(
#   FILES
#   Action1.action
# )
generate_messages(
  DEPENDENCIES
  std_msgs  # Or other packages containing msgs
)
catkin_package(
#  INCLUDE_DIRS include
#  CATKIN_DEPENDS roscpp rospy std_msgs
)
include_directories(
# include
  ${catkin_INCLUDE_DIRS}
)
add_executable(talker src/talker.cpp)
target_link_libraries(talker ${catkin_LIBRARIES})
add_dependencies(talker beginner_tutorials_generate_messages_cpp)
catkin_install_python(PROGRAMS scripts/talker.py scripts/listener.py
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION}
)
""",
        "\n  roscpp\n  rospy\n  std_msgs\n  message_generation\n",
        ("roscpp", "rospy", "std_msgs"),
        files={
            "msg/Num.msg": "int64 num\n",
            "srv/AddTwoInts.srv": "int64 a\nint64 b\n---\nint64 sum\n",
            "scripts/talker.py": PROGRAM,
            "scripts/listener.py": PROGRAM,
        },
        programs=("talker.py", "listener.py"),
        imports="from beginner_tutorials.msg import Num; from beginner_tutorials.srv import *",
    ),
    "laser_pipe": Shape(
        """
find_package(Boost REQUIRED COMPONENTS system signals)
add_service_files(FILES AssembleScans.srv)
generate_messages(DEPENDENCIES sensor_msgs std_msgs)
catkin_package(
    CATKIN_DEPENDS message_runtime sensor_msgs roscpp tf
    DEPENDS Boost
    INCLUDE_DIRS include
)
add_executable(scan_assembler src/scan_assembler.cpp)
if(CATKIN_ENABLE_TESTING)
  find_package(rostest)
  catkin_add_executable_with_gtest(publisher test/publisher.cpp)
  add_rostest(test/test.launch)
endif()
install(DIRECTORY examples/ DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/examples
  PATTERN ".svn" EXCLUDE)
""",
        "message_generation sensor_msgs message_filters tf roscpp rostest filters laser_geometry",
        ("message_filters", "roscpp", "sensor_msgs", "tf"),
        files={
            "srv/AssembleScans.srv": "time begin\ntime end\n---\nsensor_msgs/PointCloud cloud\n"
        },
        imports="from laser_pipe.srv import AssembleScans, AssembleScansResponse as R; R().cloud",
    ),
    "robot_description": Shape(
        """
catkin_package()
foreach(dir config launch meshes urdf)
  install(DIRECTORY ${dir}/
    DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/${dir})
endforeach()
if (CATKIN_ENABLE_TESTING)
  roslaunch_add_file_check(launch)
endif()
xacro_add_files(urdf/robot.urdf.xacro INORDER TARGET media_files)
""",
        "roslaunch xacro",
        ("rviz", "robot_state_publisher", "joint_publisher"),
        files={
            "urdf/robot.urdf.xacro": '<robot name="r"/>',
            "launch/display.launch": "<launch/>",
        },
    ),
    "globbed_msgs": Shape(
        """
file(
  GLOB messages
  RELATIVE "${${PROJECT_NAME}_SOURCE_DIR}/msg"
  "${${PROJECT_NAME}_SOURCE_DIR}/msg/*.msg")
foreach(message ${messages})
  message(STATUS "Processing: ${message}")
  add_message_files(FILES ${message})
endforeach(message)
FILE(GLOB ACTIONS RELATIVE ${CMAKE_CURRENT_LIST_DIR}/action action/*.action)
add_action_files(DIRECTORY action FILES ${ACTIONS})
add_service_files(DIRECTORY srv FILES )
generate_messages(DEPENDENCIES actionlib_msgs)
catkin_package(CATKIN_DEPENDS actionlib_msgs)
""",
        "actionlib_msgs message_generation",
        ("actionlib_msgs",),
        files={
            "msg/A.msg": "int8 a\n",
            "msg/B.msg": "A a\n",
            "action/Go.action": "---\n---\n",
        },
        imports="from globbed_msgs.msg import A, B, GoAction",
    ),
    "gripper_action": Shape(
        """
add_action_files(FILES Grip.action)
if(WITH_MESSAGES)
  add_message_files(FILES Width.msg)
endif()
generate_messages(DEPENDENCIES actionlib_msgs control_msgs std_msgs)
catkin_package(CATKIN_DEPENDS actionlib_msgs control_msgs)
""",
        "actionlib genmsg control_msgs rospy",
        ("actionlib", "control_msgs", "rospy"),
        format=1,
        files={
            "action/Grip.action": "Width to\n---\n---\ncontrol_msgs/JointTolerance tolerance\n",
            "msg/Width.msg": "float64 meters\n",
        },
        imports="from gripper_action.msg import GripGoal; GripGoal().to.meters",
    ),
    "old_style": Shape(
        """
catkin_package()
catkin_python_setup()
catkin_install_python(PROGRAMS bin/old DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(FILES ${MISSING}/a.yaml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
rosbuild_add_boost_directories()
""",
        depends=("rospy", "message_filters"),
        format=1,
        files={
            "setup.py": (
                "from setuptools import find_packages, setup\n"
                "setup(packages=find_packages('src'), package_dir={'': 'src'},\n"
                "      py_modules=['old_tools'], requires=['rospy'])\n"
            ),
            "src/old_style/__init__.py": "",
            "src/old_tools.py": "TOOL = 1\n",
            "bin/old": PROGRAM,
        },
        imports="import old_style, old_tools",
    ),
    # executive_smach: a library without ROS, and one that calls actions and services with it.
    "smach": Shape(
        """
catkin_python_setup()
catkin_package()
""",
        files={
            "setup.py": SETUP.format(name="smach", more=""),
            "src/smach/__init__.py": """
import threading
__all__ = ['UserData', 'State', 'Container', 'StateMachine']
from .user_data import *
from .state import *
from .container import *
from .state_machine import *
""",
            "src/smach/user_data.py": """
import smach
__all__ = ['UserData']
class UserData(object): pass
""",
            "src/smach/state.py": """
import smach
__all__ = ['State']
class State(object):
    def __init__(self, outcomes=[], input_keys=[], output_keys=[], io_keys=[]):
        self._outcomes = set(outcomes)
    def execute(self, ud):
        raise NotImplementedError()
""",
            "src/smach/container.py": """
import smach
__all__ = ['Container']
class Container(smach.state.State): pass
""",
            "src/smach/state_machine.py": """
import smach
__all__ = ['StateMachine']
class StateMachine(smach.container.Container):
    _currently_opened_container = None
    def execute(self, parent_ud=smach.UserData()):
        return 'succeeded'
""",
        },
        imports="""
from smach import *
import smach
assert smach.StateMachine(outcomes=['succeeded']).execute() == 'succeeded'
""",
    ),
    "smach_ros": Shape(
        """
catkin_python_setup()
catkin_package(CATKIN_DEPENDS smach smach_msgs)
""",
        depends=(
            *("rospy", "rostopic", "std_msgs", "std_srvs", "actionlib", "actionlib_msgs"),
            *("smach", "smach_msgs"),
        ),
        manifest="<test_depend>rostest</test_depend>",
        files={
            "setup.py": SETUP.format(name="smach_ros", more=""),
            "src/smach_ros/__init__.py": """
from .util import set_preempt_handler
from .simple_action_state import SimpleActionState
from .introspection import IntrospectionServer
from .monitor_state import MonitorState
""",
            "src/smach_ros/util.py": """
import threading
import rospy
import smach
def set_preempt_handler(sc):
    rospy.core.add_client_shutdown_hook(lambda: sc)
""",
            "src/smach_ros/simple_action_state.py": """
import roslib
import rospy
import threading
import traceback
import copy
from actionlib.simple_action_client import SimpleActionClient, GoalStatus
import smach
from smach.state import *
class SimpleActionState(State):
    SUCCEEDED = GoalStatus.SUCCEEDED
    def __init__(self, action_name, action_spec, exec_timeout=None,
                 preempt_timeout=rospy.Duration(60.0), server_wait_timeout=rospy.Duration(60.0)):
        State.__init__(self, outcomes=['succeeded', 'aborted', 'preempted'])
        self._done_cond = threading.Condition()
""",
            "src/smach_ros/introspection.py": """
import rospy
from std_msgs.msg import Header
import base64
import pickle
import threading
import rostopic
from smach_msgs.msg import *
import smach
STATUS_TOPIC = '/smach/container_status'
class IntrospectionServer():
    def __init__(self, server_name, state, path):
        self._status = SmachContainerStatus(Header(), path, [], [], b'', '')
        self._init = SmachContainerInitialStatusCmd(path, [], b'')
        self._structure = SmachContainerStructure()
""",
            "src/smach_ros/monitor_state.py": """
import rospy
import threading
import traceback
import smach
class MonitorState(smach.State):
    def __init__(self, topic, msg_type, cond_cb, max_checks=-1, input_keys=[], output_keys=[]):
        smach.State.__init__(self, outcomes=['valid', 'invalid', 'preempted'])
    def _cb(self, msg, ud): pass
    def execute(self, ud):
        self._sub = rospy.Subscriber('t', None, self._cb, callback_args=ud)
""",
        },
        imports="""
from smach_ros import *
import smach_ros
smach_ros.SimpleActionState('move', None)
smach_ros.IntrospectionServer('sis', smach.StateMachine(), '/SM_ROOT')
assert smach_ros.SimpleActionState.SUCCEEDED == 3
""",
    ),
}
