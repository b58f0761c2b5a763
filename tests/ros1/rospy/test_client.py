"""How a program becomes a node: each test's is a process of its own."""

from __future__ import annotations

import os
import re
from contextlib import AsyncExitStack
from pathlib import Path

import pytest
from rospy.client import load_command_line_node_params, myargv
from rospy.exceptions import ROSInitException

import fibws
from fibws.hub import Hub, Settings
from ros1.rospy.programs import world


def test_the_command_line_without_what_is_ross() -> None:
    assert myargv(["a", "b:=c", "_x:=1", "__name:=y", "d=e", "--x:=5"]) == ["a", "d=e", "--x:=5"]


def test_the_command_line_sets_parameters_of_the_node() -> None:
    arguments = ["a", "b:=c", "_x:=1.5", "_list:=[1, a]", "__ns:=/n", "_none:=", "_text:=some text"]
    params = load_command_line_node_params(arguments)
    assert params == {"x": 1.5, "list": [1, "a"], "text": "some text"}


def test_a_parameter_that_is_no_yaml_is_an_error() -> None:
    with pytest.raises(ROSInitException, match="invalid command-line parameters: while parsing"):
        load_command_line_node_params(["_x:=["])


async def test_a_program_becomes_a_node_of_a_name() -> None:
    async with world() as it:
        said = await it.run(
            """
            import rospy
            for name in "", "/a/b":
                try:
                    rospy.init_node(name)
                except ValueError as error:
                    print(error)
            for function in rospy.spin, rospy.get_time:
                try:
                    function()
                except rospy.ROSInitException as error:
                    print(error)
            rospy.init_node("talker")
            rospy.init_node("talker")
            try:
                rospy.init_node("other")
            except rospy.ROSException as error:
                print(error)
            print(rospy.get_name(), rospy.get_namespace(), rospy.resolve_name("chatter"))
            print(rospy.get_param("~x"), rospy.search_param("x"))
            print(rospy.get_node_uri())
            """,
            *("__name:=renamed", "__ns:=robot", "chatter:=/word", "_x:=[1, 2]"),
        )
        assert said == [
            "name must not be empty",
            "namespaces are not allowed in node names",
            "client code must call rospy.init_node() first",
            "time is not initialized. Have you called init_node()?",
            "rospy.init_node() has already been called with different arguments: ('talker', "
            "['-c', '__name:=renamed', '__ns:=robot', 'chatter:=/word', '_x:=[1, 2]'], "
            "False, None, False, False)",
            "/robot/renamed /robot/ /word",
            "[1, 2] /robot/renamed/x",
            f"{it.hub.url}/?node=/robot/renamed",
        ]


@pytest.mark.parametrize(
    ("name", "legal"), [("my-node", "my_node"), ("2nd", "node_2nd"), ("n\u00fd uzel", "n__uzel")]
)
async def test_a_name_that_ros_only_warns_of_becomes_one_that_the_graph_can_have(
    name: str, legal: str
) -> None:
    async with world() as it:
        said = await it.run(
            f"""
            import rospy, warnings
            with warnings.catch_warnings(record=True) as caught:
                rospy.init_node({name!r})
            print(rospy.get_name(), *(each.message for each in caught), sep="\\n")
            print(caught[0].filename)
            """
        )
        assert said == [
            f"/{legal}",
            f"'{name}' is not a legal ROS base name. This may cause problems with other ROS tools. "
            f"Here the node is called '{legal}'.",
            "<string>",
        ]


async def test_a_name_that_is_remapped_must_be_legal() -> None:
    async with world() as it:
        program = await it.start("import rospy; rospy.init_node('node')", "__name:=my-node")
        assert "'my-node' is not a legal name" in await program.complains()


async def test_who_has_no_luck_with_one_hub_may_try_another() -> None:
    async with world() as it:
        assert await it.run(f"""
            import os, rospy
            os.environ["FIBWS_HUB"] = "http://robot"
            os.environ["ROSCONSOLE_FORMAT"] = "${{message}}"
            try:
                rospy.init_node("talker")
            except rospy.ROSInitException as error:
                print(error)
            os.environ["FIBWS_HUB"] = {it.hub.url!r}
            rospy.init_node("talker")
            rospy.loginfo("hello")
        """) == [
            "'http://robot' is not the address of a hub: a hub speaks ws:// or wss://, "
            "not http://. Write ws://host:port",
            "hello",
        ]


async def test_an_anonymous_name_is_nobody_elses() -> None:
    text = (  # As in two containers that start in the same millisecond.
        "import os, time; os.getpid = lambda: 1; time.time = lambda: 1795305600.123; "
        "import rospy; rospy.init_node('talker', anonymous=True); print(rospy.get_name())"
    )
    async with world() as it:
        (one,), (other,) = await it.run(text), await it.run(text)
        assert re.fullmatch(r"/talker_1_\d{13}", one)
        assert one != other
        assert await it.run(text, "__name:=known") == ["/known"]


async def test_another_command_line_can_be_given() -> None:
    async with world() as it:
        assert await it.run("""
            import rospy
            rospy.init_node("talker", argv=["talker.py", "a:=b", "__name:=x"])
            print(rospy.get_name(), rospy.resolve_name("a"))
        """) == ["/x /b"]


async def test_the_log_goes_to_the_graph() -> None:
    async with world() as it, fibws.Node("listener", hub=it.hub.url) as node:
        rosout = node.subscribe("/rosout", "rosgraph_msgs/Log")
        await node.params.has("x")  # The hub has heard of the subscription now.
        program = await it.start("""
            import rospy
            rospy.init_node("talker", log_level=rospy.WARN)

            class Talker:
                def talk(self):
                    rospy.loginfo("quiet")
                    rospy.logwarn("careful: %d", 5, logger_name="wheels")

            Talker().talk()
        """)
        said = await program.complains()
        assert re.fullmatch(r"\[WARN\] \[\d+\.\d+\]: careful: 5\n", said)
        message = await anext(aiter(rosout))
        assert (message.level, message.name, message.msg) == (4, "/talker", "careful: 5")
        assert message.function == "Talker.talk"
        assert message.line == 9


async def test_the_log_goes_to_a_file_and_not_to_the_graph(tmp_path: Path) -> None:
    path = tmp_path / "node.log"
    text = """
        import rospy
        rospy.init_node("talker", disable_rosout=True)
        rospy.loginfo("hello")
        print(rospy.get_published_topics("/rosout"))
    """
    async with world() as it:
        line, topics = await it.run(text, f"__log:={path}")
        assert line.endswith("]: hello")
        assert topics == "[]"
        assert path.read_text("utf-8").endswith(": hello\n")


async def test_the_level_of_the_log_can_be_changed_from_outside() -> None:
    async with world() as it, fibws.Node("other", hub=it.hub.url) as node:
        program = await it.start("""
            import rospy
            rospy.init_node("talker")
            rospy.logdebug("one")
            print("ready")
            rospy.wait_for_service("/go")
            rospy.logdebug("two")
        """)
        assert await program.says() == "ready"
        await node.call(
            "/talker/set_logger_level",
            "roscpp/SetLoggerLevel",
            {"logger": "rosout", "level": "debug"},
        )
        await node.service("/go", "std_srvs/Empty", lambda _: {})
        said = await program.ends()
        assert [line.partition("]: ")[2] for line in said if "two" in line] == ["two"]
        assert not [line for line in said if "one" in line]


async def test_a_node_of_the_same_name_ends_the_first() -> None:
    text = """
        import rospy
        from std_msgs.msg import String
        rospy.init_node("same")
        rospy.Subscriber("heard", String)
        rospy.on_shutdown(lambda: print("hook"))
        print("ready")
        rospy.spin()
        print("end")
    """
    async with world() as it:
        first = await it.start(text)
        assert await first.says() == "ready"
        second = await it.start(text)
        assert await second.says() == "ready"
        assert await first.ends() == [
            "shutdown request: [/same] Reason: new node registered with same name",
            "hook",
            "end",
        ]
        async with fibws.Node("killer", hub=it.hub.url) as node:
            await node.call("/rosapi/kill_node", "fibws_msgs/KillNode", {"node": "/same"})
        assert await second.ends() == ["shutdown request: user request", "hook", "end"]
        assert [first.complaints, second.complaints] == ["", ""]


@pytest.mark.skipif(os.name == "nt", reason="nobody can press Ctrl-C there")
async def test_who_waits_for_a_hub_says_so_until_ctrl_c() -> None:
    async with world() as it:
        program = await it.start("""
            import os, threading
            os.environ["FIBWS_HUB"] = "127.0.0.1:1"
            import logging, rospy

            class Told(logging.Handler):
                def emit(self, record):
                    print("waits")

            logging.getLogger("rosout").addHandler(Told())
            rospy.init_node("lonely")
        """)
        assert await program.says() == "waits"
        program.interrupt()
        said = await program.complains()
        assert re.fullmatch(
            r"\[WARN\] \[.*\]: Waiting for a hub at ws://127.0.0.1:1 \(Connection refused\). "
            r"Start one with: roscore\n",
            said,
        )


async def test_a_node_survives_its_hub() -> None:
    async with AsyncExitStack() as first, world() as it:
        hub = await first.enter_async_context(Hub(Settings(port=0, close_timeout=0.1)))
        program = await it.start(f"""
            import os, rospy
            os.environ["FIBWS_HUB"] = {hub.url!r}
            rospy.init_node("patient")
            print("ready")
            while not rospy.has_param("/go"):
                rospy.sleep(0.01)
            print("back")
        """)
        assert await program.says() == "ready"
        await first.aclose()
        async with Hub(Settings(port=hub.port, close_timeout=0.1)) as again:
            async with fibws.Node("other", hub=again.url) as node:
                await node.params.set("/go", True)
                assert [line for line in await program.ends() if line == "back"] == ["back"]


async def test_signals_can_be_left_to_the_program() -> None:
    async with world() as it:
        program = await it.start("""
            import rospy, threading
            rospy.init_node("careless", disable_signals=True)
            rospy.on_shutdown(lambda: print("hook"))
            # Not before it spins: until then Ctrl-C is Python's.
            threading.Timer(1, print, ["ready"], {"flush": True}).start()
            rospy.spin()
            print("end", rospy.is_shutdown())
        """)
        assert await program.says() == "ready"
        if os.name == "nt":
            return
        program.interrupt()
        assert await program.ends() == ["hook", "end True"]


async def test_topics_made_before_the_node_are_published_when_it_comes() -> None:
    async with world() as it:
        assert await it.run("""
            import rospy
            from std_msgs.msg import String

            rospy.Publisher("chatter", String, queue_size=1)
            rospy.init_node("talker")
            print(rospy.get_published_topics("/chatter"), rospy.get_published_topics("/no"))
            print([topic for topic, _ in rospy.get_published_topics() if topic == "/chatter"])
        """) == ["[] []", "['/chatter']"]
