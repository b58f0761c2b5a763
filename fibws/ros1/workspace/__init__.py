"""Packages of ROS 1 in their workspaces, and catkin's part: to make, check and build them.

package.xml ─ condition ─> manifest;  CMakeLists.txt ─ cmake/, reader ─> recipe
packages  those that $ROS_PACKAGE_PATH leads to, as rospack and rosrun find them, by crawl and
          programs; missing, what a person is told who asks for another one
rosrun    what a program is started with, be it a package's or one of ROS's own
place     where a workspace is; source, a package in it; order, which is built before which
check     what is wrong in a package; definitions, in its .msg, .srv and .action files
build     catkin_make: all of that; devel and setup_files, what it makes; tree, how it writes it
skeleton  catkin_create_pkg: the first files of a package, from templates
"""
