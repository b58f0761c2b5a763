"""Starting a node; each is a process of its own."""

from __future__ import annotations

import os
import re
from contextlib import AsyncExitStack
from pathlib import Path

import pytest
from ports import port as port
from rospy.client import load_command_line_node_params, myargv
from rospy.exceptions import ROSInitException

import fibws
from fibws.errors import NoHub
from fibws.hub import Settings
from fibws.hub.server import HubServer
from ros1.rospy.programs import running_hub


def test_myargv_omits_arguments_of_ros() -> None:
    assert myargv(["a", "b:=c", "_x:=1", "__name:=y", "d=e", "--x:=5"]) == ["a", "d=e", "--x:=5"]


def test_command_line_sets_parameters_of_the_node() -> None:
    arguments = ["a", "b:=c", "_x:=1.5", "_list:=[1, a]", "__ns:=/n", "_none:=", "_text:=some text"]
    params = load_command_line_node_params(arguments)
    assert params == {"x": 1.5, "list": [1, "a"], "text": "some text"}


def test_invalid_yaml_on_the_command_line_is_an_error() -> None:
    with pytest.raises(ROSInitException, match="invalid command-line parameters: while parsing"):
        load_command_line_node_params(["_x:=["])


async def test_init_node_names_the_node() -> None:
    async with running_hub() as programs:
        said = await programs.run(
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
            f"{programs.hub.url}/?node=/robot/renamed",
        ]


@pytest.mark.parametrize(
    ("name", "possible"),
    [("my-node", "my-node"), ("2nd", "2nd"), ("n\u00fd uzel", "n\u00fd_uzel"), ("~a#\t", "_a__")],
)
async def test_illegal_node_name_gives_a_warning(name: str, possible: str) -> None:
    async with running_hub() as programs:
        said = await programs.run(
            f"""
            import rospy, warnings
            with warnings.catch_warnings(record=True) as caught:
                rospy.init_node({name!r})
            print(rospy.get_name(), *(each.message for each in caught), sep="\\n")
            print(caught[0].filename)
            """
        )
        node_name, warning, file = said
        assert (node_name, file) == (f"/{possible}", "<string>")
        assert name in warning and possible in warning


async def test_remapped_node_name_must_not_have_a_namespace() -> None:
    async with running_hub() as programs:
        program = await programs.start("import rospy; rospy.init_node('node')", "__name:=a/b")
        assert "'a/b' is not a legal name" in await program.read_errors()


async def test_init_node_can_be_called_again_after_an_invalid_address() -> None:
    async with running_hub() as programs:
        error, logged = await programs.run(f"""
            import os, rospy
            os.environ["FIBWS_HUB"] = "http://robot"
            os.environ["ROSCONSOLE_FORMAT"] = "${{message}}"
            try:
                rospy.init_node("talker")
            except rospy.ROSInitException as error:
                print(error)
            os.environ["FIBWS_HUB"] = {programs.hub.url!r}
            rospy.init_node("talker")
            rospy.loginfo("hello")
        """)
        assert "http://robot" in error
        assert logged == "hello"


async def test_anonymous_names_are_unique() -> None:
    text = (  # As in two containers that start in the same millisecond.
        "import os, time; os.getpid = lambda: 1; time.time = lambda: 1795305600.123; "
        "import rospy; rospy.init_node('talker', anonymous=True); print(rospy.get_name())"
    )
    async with running_hub() as programs:
        (one,), (other,) = await programs.run(text), await programs.run(text)
        assert re.fullmatch(r"/talker_1_\d{13}", one)
        assert one != other
        assert await programs.run(text, "__name:=known") == ["/known"]


async def test_command_line_can_be_given() -> None:
    async with running_hub() as programs:
        assert await programs.run("""
            import rospy
            rospy.init_node("talker", argv=["talker.py", "a:=b", "__name:=x"])
            print(rospy.get_name(), rospy.resolve_name("a"))
        """) == ["/x /b"]


async def test_log_is_published() -> None:
    async with running_hub() as programs, fibws.Node("listener", hub=programs.hub.url) as node:
        rosout = node.subscribe("/rosout", "rosgraph_msgs/Log")
        await node.params.has("x")  # The hub has heard of the subscription now.
        program = await programs.start("""
            import rospy
            rospy.init_node("talker", log_level=rospy.WARN)

            class Talker:
                def talk(self):
                    rospy.loginfo("quiet")
                    rospy.logwarn("careful: %d", 5, logger_name="wheels")

            Talker().talk()
        """)
        said = await program.read_errors()
        assert re.fullmatch(r"\[WARN\] \[\d+\.\d+\]: careful: 5\n", said)
        message = await anext(aiter(rosout))
        assert (message.level, message.name, message.msg) == (4, "/talker", "careful: 5")
        assert message.function == "Talker.talk"
        assert message.line == 9


async def test_log_is_written_to_a_file_and_not_published(tmp_path: Path) -> None:
    path = tmp_path / "node.log"
    text = """
        import rospy
        rospy.init_node("talker", disable_rosout=True)
        rospy.loginfo("hello")
        print(rospy.get_published_topics("/rosout"))
    """
    async with running_hub() as programs:
        line, topics = await programs.run(text, f"__log:={path}")
        assert line.endswith("]: hello")
        assert topics == "[]"
        assert path.read_text("utf-8").endswith(": hello\n")


async def test_other_loggers_write_into_the_folder_of_log_files(tmp_path: Path) -> None:
    text = f"""
        import logging, os, rospy
        os.environ["ROS_LOG_DIR"] = {str(tmp_path / "log")!r}
        rospy.init_node("talker")
        logging.getLogger("mine").warning("of a library")
        rospy.logwarn("of the node")
        print("done")
    """
    async with running_hub() as programs:
        assert await programs.run(text, "__ns:=/robot") == ["done"]
    [line] = (tmp_path / "log" / "robot_talker.log").read_text("utf-8").splitlines()
    assert line.startswith("[mine][WARNING] ")
    assert line.endswith(": of a library")


async def test_log_level_can_be_changed_by_a_service() -> None:
    async with running_hub() as programs, fibws.Node("other", hub=programs.hub.url) as node:
        program = await programs.start("""
            import rospy
            rospy.init_node("talker")
            rospy.logdebug("one")
            print("ready")
            rospy.wait_for_service("/go")
            rospy.logdebug("two")
        """)
        assert await program.read_line() == "ready"
        await node.call(
            "/talker/set_logger_level",
            "roscpp/SetLoggerLevel",
            {"logger": "rosout", "level": "debug"},
        )
        await node.service("/go", "std_srvs/Empty", lambda _: {})
        said = await program.finish()
        assert [line.partition("]: ")[2] for line in said if "two" in line] == ["two"]
        assert not [line for line in said if "one" in line]


async def test_new_node_of_the_same_name_ends_the_first() -> None:
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
    async with running_hub() as programs:
        first = await programs.start(text)
        assert await first.read_line() == "ready"
        second = await programs.start(text)
        assert await second.read_line() == "ready"
        assert await first.finish() == [
            "shutdown request: [/same] Reason: new node registered with same name",
            "hook",
            "end",
        ]
        async with fibws.Node("killer", hub=programs.hub.url) as node:
            await node.call("/rosapi/kill_node", "fibws_msgs/KillNode", {"node": "/same"})
        assert await second.finish() == ["shutdown request: user request", "hook", "end"]
        assert [first.errors, second.errors] == ["", ""]


@pytest.mark.skipif(os.name == "nt", reason="nobody can press Ctrl-C there")
async def test_wait_for_a_hub_is_logged_and_ends_with_ctrl_c() -> None:
    async with running_hub() as programs:
        program = await programs.start("""
            import os, threading
            os.environ["FIBWS_HUB"] = "127.0.0.1:1"
            import logging, rospy

            class Told(logging.Handler):
                def emit(self, record):
                    print("waits")

            logging.getLogger("rosout").addHandler(Told())
            rospy.init_node("lonely")
        """)
        assert await program.read_line() == "waits"
        program.interrupt()
        said = await program.read_errors()
        assert re.fullmatch(r"\[WARN\] \[.*\]: .*\n", said)
        assert "ws://127.0.0.1:1" in said
        assert NoHub("ws://127.0.0.1:1", "").remedy in said


async def test_node_survives_a_restart_of_the_hub(port: int) -> None:
    async with AsyncExitStack() as first, running_hub() as programs:
        hub = await first.enter_async_context(HubServer(Settings(port=port, close_timeout=0.1)))
        program = await programs.start(f"""
            import os, rospy
            os.environ["FIBWS_HUB"] = {hub.url!r}
            rospy.init_node("patient")
            print("ready")
            while not rospy.has_param("/go"):
                rospy.sleep(0.01)
            print("back")
        """)
        assert await program.read_line() == "ready"
        await first.aclose()
        async with HubServer(Settings(port=port, close_timeout=0.1)) as again:
            async with fibws.Node("other", hub=again.url) as node:
                await node.params.set("/go", True)
                assert [line for line in await program.finish() if line == "back"] == ["back"]


async def test_signal_handlers_can_be_disabled() -> None:
    async with running_hub() as programs:
        program = await programs.start("""
            import rospy, sys, threading, time
            rospy.init_node("careless", disable_signals=True)
            rospy.on_shutdown(lambda: print("hook"))

            def wait_for_spin():  # Until it spins, Ctrl-C is Python's.
                main = threading.main_thread().ident
                functions = []
                while "wait_for_shutdown" not in functions:
                    time.sleep(0.001)
                    frame, functions = sys._current_frames()[main], []
                    while frame is not None:
                        functions.append(frame.f_code.co_name)
                        frame = frame.f_back
                print("ready", flush=True)

            threading.Thread(target=wait_for_spin).start()
            rospy.spin()
            print("end", rospy.is_shutdown())
        """)
        assert await program.read_line() == "ready"
        if os.name == "nt":
            return
        program.interrupt()
        assert await program.finish() == ["hook", "end True"]


async def test_topics_created_before_init_node_are_published() -> None:
    async with running_hub() as programs:
        assert await programs.run("""
            import rospy
            from std_msgs.msg import String

            rospy.Publisher("chatter", String, queue_size=1)
            rospy.init_node("talker")
            print(rospy.get_published_topics("/chatter"), rospy.get_published_topics("/no"))
            print([topic for topic, _ in rospy.get_published_topics() if topic == "/chatter"])
        """) == ["[] []", "['/chatter']"]
