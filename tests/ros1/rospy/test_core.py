"""How a node comes to its end, and what is done when it begins."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator

import pytest
import rospy
from rospy import core, exceptions
from rospy.background import Background

from ros1.rospy.programs import world


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No node has begun or ended in this process."""
    for name in "_shutting_down", "_shutdown", "_initialized":
        monkeypatch.setattr(core, name, False)
    for name in "_starters", "_client_hooks", "_early_hooks", "_late_hooks":
        monkeypatch.setattr(core, name, [])
    monkeypatch.setattr(core, "background", Background())
    yield


def test_hooks_come_before_the_end_and_at_it() -> None:
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


def test_a_hook_that_raises_keeps_none_from_its_turn(capsys: pytest.CaptureFixture[str]) -> None:
    said: list[str] = []
    core.add_client_shutdown_hook(lambda: [][0])
    core.add_client_shutdown_hook(lambda: said.append("second"))
    core.signal_shutdown("enough")
    assert said == ["second"]
    assert "IndexError" in capsys.readouterr().err


def test_a_hook_that_exits_keeps_no_node_from_its_end(capsys: pytest.CaptureFixture[str]) -> None:
    core.add_client_shutdown_hook(lambda: sys.exit(4))
    core.signal_shutdown("enough")
    assert core.is_shutdown()
    assert "SystemExit: 4" in capsys.readouterr().err


def test_a_hook_that_comes_too_late_is_called_at_once() -> None:
    core.signal_shutdown("enough")
    said: list[str] = []
    core.add_client_shutdown_hook(lambda: said.append("client's"))
    core.add_preshutdown_hook(said.append)
    core.add_shutdown_hook(said.append)
    assert said == ["client's", "already shutdown", "already shutdown"]


def test_a_hook_is_a_function() -> None:
    for add in core.add_client_shutdown_hook, core.add_preshutdown_hook, core.add_shutdown_hook:
        with pytest.raises(TypeError, match=r"shutdown hook \[5\] must be a function"):
            add(5)  # type: ignore[arg-type]


def test_who_waits_for_the_end_is_woken() -> None:
    assert not core.wait_for_shutdown(timeout=0)
    waiting = threading.Thread(target=core.wait_for_shutdown)
    waiting.start()
    core.signal_shutdown("enough")
    waiting.join(60)
    assert not waiting.is_alive()
    assert core.wait_for_shutdown()


def test_what_is_to_be_done_at_the_start_is_done_in_order() -> None:
    done: list[str] = []
    core.on_start(lambda: done.append("first"))
    core.on_start(lambda: core.on_start(lambda: done.append("last")))
    core.on_start(lambda: done.append("second"))
    assert done == []
    core.started()
    assert done == ["first", "second", "last"]
    assert core.is_initialized()


def test_when_the_node_runs_it_is_done_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Background, "running", True)
    done: list[str] = []
    core.on_start(lambda: done.append("now"))
    assert done == ["now"]


def test_what_rospy_has_here_too_is_found_here() -> None:
    for name in "logwarn", "rospyinfo", "resolve_name", "ROSInitException":
        assert callable(getattr(core, name))
    assert core.loginfo is rospy.loginfo  # type: ignore[attr-defined]
    for name in "nothing", "_log":
        with pytest.raises(AttributeError, match=f"no attribute '{name}'"):
            getattr(core, name)


def test_without_a_node_there_is_no_uri() -> None:
    assert core.get_node_uri() is None


def test_exceptions_are_caught_as_in_rospy() -> None:
    assert issubclass(exceptions.ROSInterruptException, KeyboardInterrupt)
    assert issubclass(exceptions.ROSInterruptException, exceptions.ROSException)
    assert issubclass(exceptions.ROSTimeMovedBackwardsException, exceptions.ROSInterruptException)
    assert issubclass(exceptions.TransportTerminated, exceptions.TransportException)
    assert issubclass(exceptions.TransportInitError, exceptions.ROSInternalException)
    error = exceptions.ROSTimeMovedBackwardsException(2.5)
    assert (str(error), error.time) == ("ROS time moved backwards", 2.5)


WAITS = {
    "a sleep": "rospy.sleep(60)",
    "a rate": "rate = rospy.Rate(0.01); rate.sleep(); rate.sleep()",
    "a message": "rospy.wait_for_message('nothing', String)",
    "a service": "rospy.wait_for_service('nothing')",
    "a call": "rospy.ServiceProxy('slow', Empty)()",
}


@pytest.mark.skipif(sys.platform == "win32", reason="nobody can press Ctrl-C there")
@pytest.mark.parametrize("what", WAITS)
async def test_ctrl_c_ends_each_way_to_wait(what: str) -> None:
    async with world() as it:
        program = await it.start(f"""
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
        assert await program.says() == "ready"
        program.interrupt()
        assert await program.ends() == ["hook False", "interrupted"]


@pytest.mark.skipif(sys.platform == "win32", reason="nobody can press Ctrl-C there")
@pytest.mark.parametrize("turn", ["", "rospy.signal_shutdown('done')"])
async def test_what_follows_a_loop_is_done_wherever_the_end_meets_it(turn: str) -> None:
    async with world() as it:
        program = await it.start(f"""
            import rospy
            rospy.init_node("looper")
            rate = rospy.Rate(0.01)
            while not rospy.is_shutdown():
                print("turn")
                {turn}
                rate.sleep()
            print("cleaned up")
        """)
        assert await program.says() == "turn"
        if not turn:
            program.interrupt()
        assert await program.ends() == ["cleaned up"]


@pytest.mark.skipif(sys.platform == "win32", reason="nobody can press Ctrl-C there")
async def test_ctrl_c_ends_a_spin_in_silence() -> None:
    async with world() as it:
        program = await it.start("""
            import rospy
            rospy.init_node("spinner")
            print("ready")
            rospy.spin()
            print("end", rospy.is_shutdown())
        """)
        assert await program.says() == "ready"
        program.interrupt()
        assert await program.ends() == ["end True"]


@pytest.mark.skipif(sys.platform == "win32", reason="nobody can press Ctrl-C there")
async def test_who_is_woken_from_sleep_shows_no_traceback() -> None:
    async with world() as it:
        program = await it.start("""
            import rospy, sys, threading
            sys.stderr = sys.stdout
            rospy.init_node("sleeper")
            threading.Thread(target=rospy.sleep, args=(60,)).start()
            print("ready")
            rospy.sleep(60)
            print("never")
        """)
        assert await program.says() == "ready"
        program.interrupt()
        assert await program.ends() == []


@pytest.mark.skipif(sys.platform == "win32", reason="nobody can press Ctrl-C there")
async def test_the_second_ctrl_c_ends_what_does_not_heed_the_first() -> None:
    async with world() as it:
        program = await it.start("""
            import rospy, threading
            rospy.init_node("deaf")
            rospy.on_shutdown(lambda: print("hook"))
            print("ready")
            threading.Event().wait()
        """)
        assert await program.says() == "ready"
        program.interrupt()
        assert await program.says() == "hook"
        program.interrupt()
        assert (await program.complains()).endswith("KeyboardInterrupt\n")


async def test_what_was_published_last_is_still_sent() -> None:
    async with world() as it:
        listener = await it.start("""
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
        assert await listener.says() == "ready"
        await it.run("""
            import rospy
            from std_msgs.msg import Int32

            numbers = rospy.Publisher("numbers", Int32, queue_size=1000)
            rospy.init_node("talker")
            for number in range(301):
                numbers.publish(number)
        """)
        assert await listener.ends() == ["all"]


def test_signals_are_for_the_main_thread() -> None:
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
