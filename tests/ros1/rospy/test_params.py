"""Parameters in programs."""

from __future__ import annotations

from ros1.rospy.programs import running_hub

PROGRAM = """
    import rospy

    def show(function, *arguments):
        try:
            print(function(*arguments))
        except Exception as error:
            print(type(error).__name__, *(error.args if isinstance(error, KeyError) else ()))

    show(rospy.set_param, "foo", 1)
    show(rospy.get_param, "/foo")
    show(rospy.get_param, "nope")
    show(rospy.get_param, "~nope")
    show(rospy.get_param, "nope", None)
    show(rospy.set_param, "~p", {"a": 1, "b": {"c": (1, 2.5, "x", True)}})
    show(rospy.get_param, "~p/b")
    show(rospy.get_param_cached, "~p/a")
    show(rospy.get_param_cached, "nope", 7)
    show(rospy.has_param, "~p/b")
    show(rospy.has_param, "nope")
    show(rospy.search_param, "foo")
    show(rospy.search_param, "nope")
    show(rospy.search_param, "~p")
    show(rospy.delete_param, "foo")
    show(rospy.delete_param, "foo")
    show(rospy.delete_param, "/")
    show(rospy.set_param, "x", None)
    show(rospy.set_param, "x", [None])
    show(rospy.set_param, "x", {1: 2})
    show(rospy.set_param, "x", object())
    show(rospy.set_param, "/", 5)
    show(rospy.set_param, "servo/1/id", 4)
    show(rospy.get_param, "servo")
    show(lambda: "/servo/1/id" in rospy.get_param_names())
"""

SAID = """\
None
1
KeyError nope
KeyError ~nope
None
None
{'c': [1, 2.5, 'x', True]}
1
7
True
False
/foo
None
ROSException
None
KeyError foo
KeyError /
TypeError
TypeError
TypeError
TypeError
ROSException
None
{'1': {'id': 4}}
True
"""


async def test_parameters_of_a_node() -> None:
    async with running_hub() as programs:
        node = PROGRAM.replace("    def show", '    rospy.init_node("asker")\n\n    def show', 1)
        assert await programs.run(node) == SAID.splitlines()


async def test_parameters_before_init_node() -> None:
    async with running_hub() as programs:
        assert await programs.run(PROGRAM) == SAID.splitlines()


async def test_illegal_parameter_name_gives_a_warning() -> None:
    async with running_hub() as programs:
        program = await programs.start("""
            import rospy
            rospy.set_param("odd-name", 1)
            print(rospy.get_param("odd-name"))
        """)
        assert await program.read_line() == "1"
        assert "'odd-name' is not a legal ROS graph resource name" in await program.read_errors()
