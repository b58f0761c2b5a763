"""The parameters that all nodes share, as a program asks for them."""

from __future__ import annotations

from ros1.rospy.programs import world

PROGRAM = """
    import rospy

    def show(function, *arguments):
        try:
            print(function(*arguments))
        except Exception as error:
            # CPython 3.12 also says which number it was.
            print(type(error).__name__, str(error).removesuffix(": nan"))

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
    show(rospy.set_param, "x", float("nan"))
    show(rospy.set_param, "/", 5)
    show(rospy.set_param, "servo/1/id", 4)
    show(rospy.get_param, "servo")
    show(lambda: "/servo/1/id" in rospy.get_param_names())
"""

SAID = """\
None
1
KeyError 'nope'
KeyError '~nope'
None
None
{'c': [1, 2.5, 'x', True]}
1
7
True
False
/foo
None
ROSException cannot search for parameter: '~p' is not a legal name: a private name cannot be \
searched for
None
KeyError 'foo'
KeyError '/'
TypeError a parameter cannot be None; delete_param() makes it unset
TypeError a parameter cannot be None; delete_param() makes it unset
TypeError a key in a parameter's dict is a string, not 1
ValueError Out of range float values are not JSON compliant
ROSException cannot set parameter: / is the namespace of all parameters: set it to an object
None
{'1': {'id': 4}}
True
"""


async def test_a_node_has_parameters() -> None:
    async with world() as it:
        node = PROGRAM.replace("    def show", '    rospy.init_node("asker")\n\n    def show', 1)
        assert await it.run(node) == SAID.splitlines()


async def test_who_is_no_node_yet_has_them_as_well() -> None:
    async with world() as it:
        assert await it.run(PROGRAM) == SAID.splitlines()


async def test_a_name_that_is_not_legal_is_warned_of() -> None:
    async with world() as it:
        program = await it.start("""
            import rospy
            rospy.set_param("odd-name", 1)
            print(rospy.get_param("odd-name"))
        """)
        assert await program.says() == "1"
        assert "'odd-name' is not a legal ROS graph resource name" in await program.complains()
