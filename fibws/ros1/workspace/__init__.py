"""ROS 1 packages and workspaces: what catkin_make, catkin_create_pkg, rospack and rosrun do.

package_xml, cmake_lists, python_setup   read the files of one package
discovery, packages, suggestions         find packages and programs, and suggest what was meant
source_tree                              the packages in src/, in the order of their dependencies
definitions, package_checks              find what is wrong in packages
build, devel_space, setup_files          catkin_make: all of the above, and writing devel/
new_package                              catkin_create_pkg
"""
