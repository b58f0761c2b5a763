"""``fibws test``: programs that write results, started with a hub and nodes."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner, Result
from hub_in_thread import HubThread

from fibws.cli.commands import command

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="programs are shell scripts")

MANIFEST = """<package format="2"><name>robot</name><version>0.0.0</version>
<description>x</description><maintainer email="a@example.com">a</maintainer>
<license>BSD</license></package>"""
# It writes its first argument to the file of --gtest_output=xml:, and exits with the second.
PROGRAM = f"""#!/bin/sh
echo "says hello"
echo "speed $('{sys.executable}' -m fibws param get /speed)"
for word; do
    case $word in
        --gtest_output=xml:*) echo "$1" > "${{word#--gtest_output=xml:}}" ;;
        --text) echo "as text" ;;
    esac
done
exit $2
"""
# Its first two runs fail.
COUNTER = """#!/bin/sh
echo run >> '{folder}/runs'
[ $(wc -l < '{folder}/runs') -lt 3 ]
echo "<testsuite tests='1' failures='$((1 - $?))'/>" > "${{1#--gtest_output=xml:}}"
"""
GOOD = "&lt;testsuite tests='1'>&lt;testcase name='test_speed'/>&lt;/testsuite>"
BAD = (
    "&lt;testsuite tests='2' failures='1'>&lt;testcase name='test_speed'/>&lt;testcase name="
    "'test_size'>&lt;failure type='AssertionError'>1 != 2&lt;/failure>&lt;/testcase>&lt;/testsuite>"
)

RunTests: TypeAlias = Callable[..., Result]


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a package with programs."""
    folder = tmp_path / "src" / "robot"
    (folder / "test").mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST)
    programs = {
        "writer": PROGRAM,
        "waiter": "#!/bin/sh\nexec sleep 60\n",
        "silent": "#!/bin/sh\necho wrong >&2; exit 3\n",
        "counter": COUNTER.format(folder=tmp_path),
    }
    for name, text in programs.items():
        (folder / "test" / name).write_text(text)
        (folder / "test" / name).chmod(0o755)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "src"))
    monkeypatch.setenv("ROS_HOME", str(tmp_path / "home"))
    for name in ("ROS_LOG_DIR", "ROS_NAMESPACE", "FIBWS_HUB", "CMAKE_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.delenv("ROS_TEST_RESULTS_DIR", raising=False)
    monkeypatch.chdir(tmp_path)
    return folder


@pytest.fixture
def run_tests(robot: Path) -> RunTests:
    """Write robot.test, and run it with options."""

    def run_tests(text: str, *options: str) -> Result:
        (robot / "test" / "robot.test").write_text(f"<launch>{text}</launch>")
        words = ["test", "robot", "robot.test", *options]
        return CliRunner().invoke(command, words, prog_name="fibws")

    return run_tests


def test_tag(type_: str, name: str = "moves", args: str = "", attributes: str = "") -> str:
    return f'<test pkg="robot" type="{type_}" test-name="{name}" args="{args}" {attributes}/>'


test_tag.__test__ = False  # type: ignore[attr-defined]


def results(robot: Path, name: str) -> ElementTree.Element:
    return ElementTree.parse(robot.parents[1] / "home/test_results/robot" / name).getroot()


def test_passed_test_is_in_the_summary_and_the_results(robot: Path, run_tests: RunTests) -> None:
    done = run_tests(
        '<param name="speed" value="3"/>' + test_tag("writer", args=f"&quot;{GOOD}&quot; 0")
    )
    assert done.exit_code == 0, done.output
    assert "[robot.rosunit-moves/test_speed][passed]\n" in done.stdout
    for line in ("SUMMARY", " * RESULT: SUCCESS", " * TESTS: 1", " * ERRORS: 0", " * FAILURES: 0"):
        assert f"{line}\n" in done.stdout
    assert "says hello" not in done.stdout
    assert results(robot, "rosunit-moves.xml").get("tests") == "1"
    own = results(robot, "rostest-test_robot.xml")
    assert [own.get(name) for name in ("tests", "errors", "failures")] == ["1", "0", "0"]
    assert "says hello\nspeed 3\n" in (own.findtext("system-out") or "")


def test_failed_test_case_has_exit_code_2(run_tests: RunTests) -> None:
    done = run_tests(test_tag("writer", args=f"&quot;{BAD}&quot; 1"))
    assert done.exit_code == 2, done.output
    assert "[robot.rosunit-moves/test_speed][passed]\n" in done.stdout
    assert "[robot.rosunit-moves/test_size][FAILURE]-----" in done.stdout
    assert "-\n1 != 2\n-" in done.stdout
    for line in (" * RESULT: FAIL", " * TESTS: 2", " * ERRORS: 0", " * FAILURES: 1"):
        assert f"{line}\n" in done.stdout


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (test_tag("silent"), "did not generate test results; its exit code is 3"),
        (test_tag("writer", args="nonsense 0"), "rosunit-moves.xml: invalid XML"),
        (test_tag("nothing"), "no executable 'nothing' in package 'robot'"),
        (
            '<node pkg="robot" type="nothing" name="arm"/>' + test_tag("writer"),
            "failed to launch: /arm",
        ),
    ],
)
@pytest.mark.long
def test_test_that_cannot_run_is_a_failure_with_exit_code_1(
    run_tests: RunTests, text: str, fault: str
) -> None:
    done = run_tests(text)
    assert done.exit_code == 1, done.output
    assert "[Testcase: testmoves] ... FAILURE!\n" in done.stdout
    assert fault in done.stdout
    assert "\n[testmoves][failed]\n" in done.stdout
    assert done.stdout.endswith("failed to run:\n * testmoves\n\n")
    assert " * FAILURES: 1\n" in done.stdout


@pytest.mark.long
def test_standard_error_of_a_test_is_shown(run_tests: RunTests) -> None:
    assert "[moves] wrong\n" in run_tests(test_tag("silent")).stderr


def test_test_that_takes_too_long_is_ended_with_an_error(run_tests: RunTests) -> None:
    done = run_tests(test_tag("waiter", attributes='time-limit="0.1"'))
    assert done.exit_code == 1, done.output
    assert "ERROR: max time [0.1s] allotted for test [moves]" in done.stdout
    assert " * ERRORS: 1\n" in done.stdout


@pytest.mark.long
def test_end_of_a_required_node_ends_the_test_with_an_error(run_tests: RunTests) -> None:
    node = '<node pkg="robot" type="silent" name="arm" required="true"/>'
    done = run_tests(node + test_tag("waiter"))
    assert done.exit_code == 1, done.output
    assert "ERROR: test [moves] was stopped before its " in done.stdout
    assert "REQUIRED process [arm-1] has died!" in done.stderr


def test_test_is_not_passed_if_it_never_started(
    run_tests: RunTests, monkeypatch: pytest.MonkeyPatch
) -> None:
    from fibws.ros1.launch.session import Run

    async def stop(run: Run) -> None:
        run._runner.stop()

    monkeypatch.setattr(Run, "_start_nodes", stop)
    done = run_tests(test_tag("writer", args=f"&quot;{GOOD}&quot; 0"))
    assert done.exit_code == 1, done.output
    assert "ERROR: test [moves] was stopped before its start" in done.stdout


@pytest.mark.long
def test_failed_test_is_run_again_as_often_as_retry_says(robot: Path, run_tests: RunTests) -> None:
    done = run_tests(test_tag("counter", attributes='retry="5"'))
    assert done.exit_code == 0, done.output
    assert done.stdout.count("retrying") == 2
    assert (robot.parents[1] / "runs").read_text() == "run\n" * 3


@pytest.mark.long
def test_tests_of_one_name_are_a_failure(run_tests: RunTests) -> None:
    same = test_tag("writer", args=f"&quot;{GOOD}&quot; 0", attributes='name="a"')
    done = run_tests(same + same.replace('name="a"', 'name="b"'))
    assert done.exit_code == 1
    assert "Duplicate tests named [moves]" in done.stdout


@pytest.mark.long
def test_text_shows_all_output_and_uses_exit_codes(run_tests: RunTests) -> None:
    good = run_tests(test_tag("writer", args="x 0"), "--text")
    assert good.exit_code == 0, good.output
    for line in ("[moves] says hello", "[moves] as text", "[moves][passed]", " * TESTS: 1"):
        assert f"{line}\n" in good.stdout
    bad = run_tests(test_tag("writer", args="x 4"), "-t")
    assert bad.exit_code == 2
    assert "\nexit code 4\n" in bad.stdout


def test_running_hub_is_used_and_cleared(
    hub: HubThread, robot: Path, run_tests: RunTests, monkeypatch: pytest.MonkeyPatch
) -> None:
    def set_speed() -> None:
        words = ["param", "set", "/speed", "7", "--hub", hub.url]
        assert CliRunner().invoke(command, words).exit_code == 0

    monkeypatch.setenv("FIBWS_HUB", hub.url)
    text = test_tag("writer", args=f"&quot;{GOOD}&quot; 0")
    for options, speed in ((["-r"], "speed 7\n"), (["-r", "-c"], "speed \n")):
        set_speed()
        assert run_tests(text, *options).exit_code == 0
        assert speed in (results(robot, "rostest-test_robot.xml").findtext("system-out") or "")


@pytest.mark.long
def test_results_are_where_the_options_say(robot: Path, run_tests: RunTests) -> None:
    folder = robot.parents[1] / "results"
    options = ["--package", "other", "--pkgdir", str(robot.parent), "--results-filename", "all.xml"]
    run_tests(test_tag("silent"), *options, "--results-base-dir", str(folder))
    assert [path.name for path in folder.iterdir()] == ["other"]
    assert [path.name for path in (folder / "other").iterdir()] == ["rostest-all.xml"]


def test_missing_file_is_in_the_results_of_a_given_package(robot: Path) -> None:
    words = ["test", "gone.test", "--package", "robot", "--pkgdir", str(robot)]
    done = CliRunner().invoke(command, words, prog_name="fibws")
    assert done.exit_code == 1
    assert "gone.test not found" in done.stderr
    assert results(robot, "rostest-gone.xml").get("failures") == "1"


@pytest.mark.parametrize(
    ("words", "fact"),
    [
        ([], "PACKAGE FILE"),
        (["a.test", "b.test"], "got 2"),
        (["a.test", "--clear"], "--reuse-master"),
        (["a.test", "--hub", "ws://127.0.0.1:1"], "--reuse-master"),
    ],
)
def test_wrong_use_is_an_error(robot: Path, words: list[str], fact: str) -> None:
    for name in ("a", "b"):
        (robot.parents[1] / f"{name}.test").write_text("<launch/>")
    done = CliRunner().invoke(command, ["test", *words], prog_name="fibws")
    assert done.exit_code == 2
    assert fact in done.stderr


def test_file_outside_of_packages_needs_a_name_of_a_package(robot: Path) -> None:
    (robot.parents[1] / "a.test").write_text("<launch/>")
    done = CliRunner().invoke(command, ["test", "a.test"], prog_name="fibws")
    assert done.exit_code == 1
    assert "--package" in done.stderr


def test_file_without_tests_is_a_warning(run_tests: RunTests) -> None:
    done = run_tests("")
    assert done.exit_code == 0
    assert "has no <test>" in done.stderr
    assert " * TESTS: 0\n" in done.stdout
