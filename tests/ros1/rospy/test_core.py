"""Start and shutdown of a node."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator

import pytest
import rospy
from rospy import core, exceptions
from rospy.background import Background

from ros1.rospy.programs import running_hub


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No node has begun or ended in this process."""
    for name in "_shutting_down", "_shutdown", "_initialized":
        monkeypatch.setattr(core, name, False)
    for name in "_starters", "_client_hooks", "_early_hooks", "_late_hooks":
        monkeypatch.setattr(core, name, [])
    monkeypatch.setattr(core, "background", Background())
    yield


def test_hooks_are_called_before_and_at_the_end() -> None:
    said: list[tuple[str, bool, bool]] = []

    def note(what: str) -> None:
        said.append((what, core.is_shutdown_requested(), core.is_shutdown()))

    core.add_shutdown_hook(lambda reason: note(f"late: {reason}"))
    core.add_preshutdown_hook(lambda reason: note(f"early: {reason}"))
    core.add_client_shutdown_hook(lambda: note("first"))
    core.add_client_shutdown_hook(lambda: core.add_client_shutdown_hook(lambda: note("last")))
    core.signal_shutdown("enough")
    core.signal_shutdown("once more")
    assert said == [
        ("first", True, False),
        ("last", True, False),
        ("early: enough", True, False),
        ("late: enough", True, True),
    ]


def test_error_of_a_hook_does_not_stop_other_hooks(capsys: pytest.CaptureFixture[str]) -> None:
    said: list[str] = []
    core.add_client_shutdown_hook(lambda: [][0])
    core.add_client_shutdown_hook(lambda: said.append("second"))
    core.signal_shutdown("enough")
    assert said == ["second"]
    assert "IndexError" in capsys.readouterr().err


def test_exit_in_a_hook_does_not_stop_the_shutdown(capsys: pytest.CaptureFixture[str]) -> None:
    core.add_client_shutdown_hook(lambda: sys.exit(4))
    core.signal_shutdown("enough")
    assert core.is_shutdown()
    assert "SystemExit: 4" in capsys.readouterr().err


def test_hook_added_after_shutdown_is_called_at_once() -> None:
    core.signal_shutdown("enough")
    said: list[str] = []
    core.add_client_shutdown_hook(lambda: said.append("client's"))
    core.add_preshutdown_hook(said.append)
    core.add_shutdown_hook(said.append)
    assert said == ["client's", "already shutdown", "already shutdown"]


def test_hook_must_be_callable() -> None:
    for add in core.add_client_shutdown_hook, core.add_preshutdown_hook, core.add_shutdown_hook:
        with pytest.raises(TypeError, match=r"shutdown hook \[5\] must be a function"):
            add(5)  # type: ignore[arg-type]


def test_shutdown_wakes_waiting_threads() -> None:
    assert not core.wait_for_shutdown(timeout=0)
    waiting = threading.Thread(target=core.wait_for_shutdown)
    waiting.start()
    core.signal_shutdown("enough")
    waiting.join(60)
    assert not waiting.is_alive()
    assert core.wait_for_shutdown()


def test_start_functions_are_called_in_order() -> None:
    done: list[str] = []
    core.on_start(lambda: done.append("first"))
    core.on_start(lambda: core.on_start(lambda: done.append("last")))
    core.on_start(lambda: done.append("second"))
    assert done == []
    core.started()
    assert done == ["first", "second", "last"]
    assert core.is_initialized()


def test_start_function_is_called_at_once_while_the_node_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Background, "running", True)
    done: list[str] = []
    core.on_start(lambda: done.append("now"))
    assert done == ["now"]


def test_names_that_rospy_has_in_core_exist() -> None:
    for name in "logwarn", "rospyinfo", "resolve_name", "ROSInitException":
        assert callable(getattr(core, name))
    assert core.loginfo is rospy.loginfo  # type: ignore[attr-defined]
    for name in "nothing", "_log":
        with pytest.raises(AttributeError, match=f"no attribute '{name}'"):
            getattr(core, name)


def test_uri_is_none_without_a_node() -> None:
    assert core.get_node_uri() is None


def test_exceptions_have_the_bases_of_rospy() -> None:
    assert issubclass(exceptions.ROSInterruptException, KeyboardInterrupt)
    assert issubclass(exceptions.ROSInterruptException, exceptions.ROSException)
    assert issubclass(exceptions.ROSTimeMovedBackwardsException, exceptions.ROSInterruptException)
    assert issubclass(exceptions.TransportTerminated, exceptions.TransportException)
    assert issubclass(exceptions.TransportInitError, exceptions.ROSInternalException)
    error = exceptions.ROSTimeMovedBackwardsException(2.5)
    assert (str(error), error.time) == ("ROS time moved backwards", 2.5)


WAITS = {
    "a message": "rospy.wait_for_message('nothing', String)",
    "a service": "rospy.wait_for_service('nothing')",
    "a call": "rospy.ServiceProxy('slow', Empty)()",
}


@pytest.mark.skipif(sys.platform == "win32", reason="nobody can press Ctrl-C there")
@pytest.mark.parametrize("what", WAITS)
async def test_ctrl_c_interrupts_all_waits(what: str) -> None:
    async with running_hub() as programs:
        program = await programs.start(f"""
            import threading, rospy
            from std_msgs.msg import String
            from std_srvs.srv import Empty

            def serve(request):
                print("ready")
                rospy.sleep(60)

            rospy.init_node("waiter")
            rospy.on_shutdown(lambda: print("hook", rospy.is_shutdown()))
            if {what!r} == "a call":
                rospy.Service("slow", Empty, serve)
            else:
                threading.Timer(0.1, lambda: print("ready")).start()
            try:
                {WAITS[what]}
            except rospy.ROSInterruptException:
                print("interrupted")
        """)
        assert await program.read_line() == "ready"
        program.interrupt()
        assert await program.finish() == ["hook False", "interrupted"]


@pytest.mark.skipif(sys.platform == "win32", reason="nobody can press Ctrl-C there")
@pytest.mark.parametrize("turn", ["", "rospy.signal_shutdown('done')"])
@pytest.mark.parametrize("sleep", ["rate.sleep()", "rospy.sleep(100)"])
async def test_code_after_a_loop_runs_after_ctrl_c(turn: str, sleep: str) -> None:
    async with running_hub() as programs:
        program = await programs.start(f"""
            import rospy
            rospy.init_node("looper")
            rate = rospy.Rate(0.01)
            while not rospy.is_shutdown():
                print("turn")
                {turn}
                {sleep}
            print("cleaned up")
        """)
        assert await program.read_line() == "turn"
        if not turn:
            program.interrupt()
        assert await program.finish() == ["cleaned up"]


@pytest.mark.skipif(sys.platform == "win32", reason="nobody can press Ctrl-C there")
async def test_ctrl_c_ends_spin_silently() -> None:
    async with running_hub() as programs:
        program = await programs.start("""
            import rospy
            rospy.init_node("spinner")
            print("ready")
            rospy.spin()
            print("end", rospy.is_shutdown())
        """)
        assert await program.read_line() == "ready"
        program.interrupt()
        assert await program.finish() == ["end True"]


@pytest.mark.skipif(sys.platform == "win32", reason="nobody can press Ctrl-C there")
async def test_interrupted_wait_prints_no_traceback() -> None:
    async with running_hub() as programs:
        program = await programs.start("""
            import rospy, sys, threading
            sys.stderr = sys.stdout
            rospy.init_node("waiter")
            threading.Thread(target=rospy.wait_for_service, args=("nothing",)).start()
            print("ready")
            rospy.wait_for_service("nothing")
            print("never")
        """)
        assert await program.read_line() == "ready"
        program.interrupt()
        assert await program.finish() == []


@pytest.mark.skipif(sys.platform == "win32", reason="nobody can press Ctrl-C there")
async def test_second_ctrl_c_ends_a_program_that_ignores_the_first() -> None:
    async with running_hub() as programs:
        program = await programs.start("""
            import rospy, threading
            from fibws import exit_signals
            exit_signals.REPEAT = 0.0
            rospy.init_node("deaf")
            rospy.on_shutdown(lambda: print("hook"))
            print("ready")
            # A signal does not end a wait that is just about to begin, as behind the first one.
            while not threading.Event().wait(0.05):
                pass
        """)
        assert await program.read_line() == "ready"
        program.interrupt()
        assert await program.read_line() == "hook"
        program.interrupt()
        assert (await program.read_errors()).endswith("KeyboardInterrupt\n")


async def test_last_message_is_sent_at_shutdown() -> None:
    async with running_hub() as programs:
        listener = await programs.start("""
            import rospy
            from std_msgs.msg import Int32

            def hear(message):
                if message.data == 300:
                    print("all")
                    rospy.signal_shutdown("done")

            rospy.init_node("listener")
            rospy.Subscriber("numbers", Int32, hear)
            print("ready")
            rospy.spin()
        """)
        assert await listener.read_line() == "ready"
        await programs.run("""
            import rospy
            from std_msgs.msg import Int32

            numbers = rospy.Publisher("numbers", Int32, queue_size=1000)
            rospy.init_node("talker")
            for number in range(301):
                numbers.publish(number)
        """)
        assert await listener.finish() == ["all"]


def test_signals_need_the_main_thread() -> None:
    raised: list[Exception] = []

    def register() -> None:
        try:
            core.register_signals()
        except ValueError as error:
            raised.append(error)

    earlier = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=register)
    thread.start()
    thread.join()
    assert "main thread" in str(raised[0])
    assert signal.getsignal(signal.SIGINT) is earlier
