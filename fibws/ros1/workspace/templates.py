"""The texts of the files that a new package begins with."""

from __future__ import annotations

PACKAGE = """\
<?xml version="1.0"?>
<package format="2">
  <name>{name}</name>
  <version>{version}</version>
  <description>{description}</description>

  <!-- Who looks after the package; one line for each of them. -->
{maintainers}
  <!-- What others may do with it: BSD, MIT, Apache-2.0, GPLv3 ... -->
{licenses}
  <!-- Who wrote it, as in <author email="jane.doe@example.com">Jane Doe</author> -->
{authors}
  <!-- What it needs: other packages, or what the system has.
         build_depend         to be built, as in message_generation
         exec_depend          to run, as in message_runtime
         build_export_depend  so that others can build on it
         depend               all three in one
  -->
  <buildtool_depend>catkin</buildtool_depend>
{depends}
  <!-- What other tools want to know. -->
  <export>{export}
  </export>
</package>
"""

CMAKE = """\
cmake_minimum_required(VERSION 3.0.2)
project({name})

## What catkin is to find; each is named in package.xml, too.
find_package(catkin REQUIRED{components})
{boost}
## If there is a setup.py, it names Python modules for others to import.
# catkin_python_setup()


###############################################
## Messages, services and actions of our own ##
###############################################

## 1. Write them: msg/Num.msg, srv/AddTwoInts.srv, action/Count.action.
## 2. In package.xml:
##      <build_depend>message_generation</build_depend>
##      <exec_depend>message_runtime</exec_depend>
## 3. Above, in find_package(): message_generation, and each package whose types you use
##    (with actions: actionlib_msgs).
## 4. List them here, and those packages as DEPENDENCIES. Take the # off.

{messages}

{services}

{actions}

{generate}


#############
## Package ##
#############

## What those need who build on this package. It stands behind generate_messages(), and before all
## that uses a CATKIN_..._DESTINATION.
catkin_package(
#  CATKIN_DEPENDS {catkin_depends}
)


##############
## Programs ##
##############

## Python programs, so that rosrun finds them; each is executable (chmod +x) and begins with
## #!/usr/bin/env python3.
# catkin_install_python(PROGRAMS
#   src/{name}_node.py
#   DESTINATION ${{CATKIN_PACKAGE_BIN_DESTINATION}}
# )

## Other files that belong to the package.
# install(DIRECTORY launch
#   DESTINATION ${{CATKIN_PACKAGE_SHARE_DESTINATION}}
# )
"""

META = """\
cmake_minimum_required(VERSION 3.0.2)
project({name})
find_package(catkin REQUIRED)
catkin_metapackage()
"""

LAUNCH = """\
<launch>
  <!-- roslaunch {name} {name}.launch starts what is named here. -->
  <!-- <node pkg="{name}" type="{name}_node.py" name="{name}" output="screen"/> -->
</launch>
"""
