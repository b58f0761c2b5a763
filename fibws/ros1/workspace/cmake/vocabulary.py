"""The words of CMake and catkin that a CMakeLists.txt may use and nothing here is made of."""

from __future__ import annotations

COMMANDS = frozenset(
    """
    add_compile_definitions add_compile_options add_custom_command add_custom_target
    add_definitions add_dependencies add_link_options add_subdirectory add_test
    aux_source_directory break cmake_minimum_required cmake_parse_arguments cmake_path
    cmake_policy configure_file continue enable_language enable_testing execute_process export
    file find_file find_library find_path find_program get_cmake_property get_directory_property
    get_filename_component get_property get_target_property include include_directories
    include_guard link_libraries link_directories list mark_as_advanced math
    option remove_definitions return separate_arguments set set_directory_properties
    set_property set_source_files_properties set_target_properties set_tests_properties
    site_name source_group string target_compile_definitions target_compile_features
    target_compile_options target_include_directories target_link_directories
    target_link_libraries target_link_options target_sources unset variable_watch

    catkin_add_env_hooks catkin_add_gmock catkin_add_gtest catkin_add_nosetests
    catkin_add_executable_with_gtest catkin_destinations catkin_download
    catkin_download_test_data catkin_package_xml catkin_workspace assert debug_message
    em_expand stamp generate_dynamic_reconfigure_options add_rostest
    add_rostest_gtest add_rostest_gmock roslaunch_add_file_check roslint_cpp roslint_python
    roslint_add_test pkg_check_modules pkg_search_module find_program_required xacro_add_files
    qt5_wrap_cpp qt5_wrap_ui qt5_add_resources qt4_wrap_cpp qt4_wrap_ui python_add_module
    nodelet_add rosdoc catkin_lint
    """.split()
)

VARIABLES = {
    "CMAKE_VERSION": "3.25.1",
    "CATKIN_DEVEL_PREFIX": "devel",
    "PYTHON_EXECUTABLE": "python3",
    "CMAKE_SYSTEM_NAME": "Linux",
    "UNIX": "1",
}
"""What is set before a file begins."""

HERE = ["CMAKE_CURRENT_SOURCE_DIR", "CMAKE_SOURCE_DIR", "PROJECT_SOURCE_DIR"]
HERE += ["CMAKE_CURRENT_LIST_DIR", "CMAKE_CURRENT_BINARY_DIR", "CMAKE_BINARY_DIR"]
"""The variables that name the package's folder."""
