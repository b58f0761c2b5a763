"""roslaunch: reads launch files into a model, and runs its nodes.

    launch_files  the files that a command line names
    reader        <launch>, <group>, <include>, <node> ...;  parameters  <param>, <rosparam>
    xml_element   elements and attributes;  scope  arguments, namespaces, $(...)
    model         the result: nodes, parameters, arguments
    environment   files, packages and variables of this machine

    node_command  the command of a node's program;  share/  launch files of packages of ROS
    rosbridge     rosbridge_websocket in launch files, whose place the hub takes
    runner        all processes;  process  one process;  output  screen, terminal, log files
    session       the hub, which is found or started, then parameters and nodes: for `fibws launch`
                  and for scripts that import roslaunch;  rostest_session  one <test>

Reading needs no clocks and no processes.
"""
