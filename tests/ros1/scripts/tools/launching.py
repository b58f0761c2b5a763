#!/usr/bin/env python3
"""What roslaunch's module says before it starts anything."""
import os
import tempfile

import roslaunch
from roslaunch.core import Node


def attempt(function, *args, **kwargs):
    try:
        print(function(*args, **kwargs), flush=True)
    except Exception as error:
        print(f"{type(error).__name__}: {error}", flush=True)


print("nodes")
attempt(Node, " ", "talker")
attempt(Node, "robot", "")
attempt(Node, "robot", "talker", name="a/b")
attempt(Node, "robot", "talker", output="both")
attempt(Node, "robot", "talker", cwd="home")
attempt(Node, "robot", "talker", respawn=True, required=True)
node = Node("robot", "talker", "t", "ns//a", args="/a /b", cwd="ros_home", remap_args=[("a", "b")])
print(node.package, node.type, node.name, node.namespace, node.args, node.cwd, node.output)
print(node.respawn, node.respawn_delay, node.required, node.remap_args, node.env_args)
print(node.launch_prefix, node.filename, Node("robot", "talker").name)

print("files")
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "x.launch")
    with open(path, "w") as file:
        file.write("<launch/>")
    found = roslaunch.rlutil.resolve_launch_arguments([path, "speed:=2"])
    print([os.path.basename(each) for each in found])
print(roslaunch.rlutil.resolve_launch_arguments([]))

print("launches")
print(roslaunch.rlutil.get_or_generate_uuid("abc", False))
attempt(roslaunch.parent.ROSLaunchParent, "abc", [], sigint_timeout=0)
attempt(roslaunch.parent.ROSLaunchParent, "abc", [], sigterm_timeout=-1.5)
attempt(roslaunch.parent.ROSLaunchParent("abc", []).spin)
attempt(roslaunch.scriptapi.ROSLaunch().launch, node)
