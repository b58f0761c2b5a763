"""roslaunch: launch files are read into a model of what is to run, and that is run.

    reader       launch files, tag by tag: arguments, groups, includes
    node         <node>, <test>, <remap>, <env>;  parameter  <param>, <rosparam>
    attributes   those a tag has; substitution  $(arg x); value  1 or "1"
    evaluation   $(eval ...), a Python expression
    scope        what holds where a tag stands;  tag  one that knows its file and line
    world        what all these ask of their surroundings;  surroundings  what this machine says
    model        what was read: nodes, parameters, arguments;  listing  how that is told

    files        which files a command line names
    command      how a node's program is started;  share/  packages that need not be installed
    process      one process;  runner  all of them;  hub  the one that is started if there is none
    screen, log  what a person sees, what is kept

What reads is pure: it knows neither clocks nor processes. Parameters are set by whoever has a link
to the hub, `fibws.cli.launch`.
"""
