"""``fibws workspace``: catkin_init_workspace and catkin_make as they are typed."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from subprocess import PIPE, Popen
from typing import TypeAlias

import pytest
from click.testing import CliRunner, Result

from fibws.cli.commands import command
from fibws.ros1.workspace import package_tests

Type: TypeAlias = Callable[..., Result]
PROGRAM = "#!/usr/bin/env python3\nprint('hello')\n"
INSTALLED = """
catkin_install_python(PROGRAMS src/node.py
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION}
)
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder: an empty workspace."""
    for variable in ("ROS_PACKAGE_PATH", "CMAKE_PREFIX_PATH", "FIBWS_INTERFACES", "PWD"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("SHELL", "/bin/bash")
    folder = tmp_path / "ros_workspace"
    (folder / "src").mkdir(parents=True)
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def type_(folder: Path) -> Type:
    """Type ``fibws`` with these words, in a folder."""

    def type_(*words: str, at: str = ".") -> Result:
        before = Path.cwd()
        os.chdir(folder / at)
        try:
            return CliRunner().invoke(command, words, prog_name="fibws")
        finally:
            os.chdir(before)

    return type_


def make(type_: Type, *words: str, at: str = ".") -> Result:
    return type_("workspace", "make", *words, at=at)


def test_package_beside_src_is_not_built(folder: Path, type_: Type) -> None:
    type_("workspace", "init", at="src")
    type_("pkg", "create", "fibonacci")
    assert "fibonacci is not in src, so it is not built: mv fibonacci src" in make(type_).output


def test_empty_workspace_is_built(folder: Path, type_: Type) -> None:
    begun = type_("workspace", "init", at="src")
    assert begun.output == f"Created file {folder / 'src' / 'CMakeLists.txt'}\n"
    made = make(type_)
    *spaces, create, sourcing = made.output.splitlines()
    assert spaces == [
        f"Base path: {folder}",
        f"Source space: {folder / 'src'}",
        f"Build space: {folder / 'build'}",
        f"Devel space: {folder / 'devel'}",
    ]
    assert create.endswith("cd src && fibws pkg create NAME std_msgs rospy")
    assert sourcing == "Next: source devel/setup.bash"
    assert sorted(path.name for path in folder.iterdir()) == [
        ".catkin_workspace",
        "build",
        "devel",
        "src",
    ]


def test_package_is_created_and_built(folder: Path, type_: Type) -> None:
    assert type_("pkg", "create", "fibonacci", "std_msgs", "rospy", at="src").exit_code == 0
    program = folder / "src" / "fibonacci" / "src" / "node.py"
    program.write_text(PROGRAM)
    program.chmod(0o755)
    with (folder / "src" / "fibonacci" / "CMakeLists.txt").open("a") as cmake:
        cmake.write(INSTALLED)
    made = make(type_)
    assert made.exit_code == 0
    assert made.output.splitlines()[4:] == [
        f"Created file {folder / 'src' / 'CMakeLists.txt'}",
        "~" * 50,
        "~~  traversing 1 package in topological order:",
        "~~  - fibonacci",
        "~" * 50,
        "fibonacci: node.py",
        "Next: source devel/setup.bash",
    ]


def test_messages_are_usable_at_once(
    folder: Path, type_: Type, monkeypatch: pytest.MonkeyPatch
) -> None:
    type_("pkg", "create", "fibonacci", "rospy", "--with", "msg,srv,action", at="src")
    assert "fibonacci: 1 message, 1 service, 1 action\n" in make(type_).output
    monkeypatch.setenv("FIBWS_INTERFACES", str(folder / "devel" / "share"))
    assert type_("msg", "show", "fibonacci/Num").output == "int64 num\n\n"
    assert type_("srv", "show", "fibonacci/AddTwoInts").output.startswith("int64 a\nint64 b\n---")
    assert "fibonacci/CountGoal" in type_("msg", "list").output


def test_error_stops_its_package_and_those_that_need_it(folder: Path, type_: Type) -> None:
    type_("pkg", "create", "fibonacci", "rospy", "--with", "msg", at="src")
    type_("pkg", "create", "needs_it", "fibonacci", at="src")
    type_("pkg", "create", "other", "rospy", at="src")
    (folder / "src" / "fibonacci" / "msg" / "Num.msg").write_text("int64 num\nint33\n")
    made = make(type_)
    assert made.exit_code == 1
    assert "Error: src/fibonacci/msg/Num.msg, line 2: " in made.stderr
    assert made.stderr.endswith("Error: not built: fibonacci, needs_it (needs fibonacci)\n")
    assert "~~  - other\n" in made.output and "~~  - fibonacci\n" not in made.output
    assert "Next: source devel/setup.bash\n" in made.output
    assert [path.name for path in (folder / "devel" / "share").iterdir()] == ["other"]


def test_next_steps_are_not_printed_if_nothing_is_built(folder: Path, type_: Type) -> None:
    type_("pkg", "create", "a", at="src")
    (folder / "src" / "a" / "CMakeLists.txt").unlink()
    made = make(type_)
    assert made.exit_code == 1
    assert "Next:" not in made.output


def test_warnings_do_not_stop_a_package(folder: Path, type_: Type) -> None:
    type_("pkg", "create", "a", "roscpp", at="src")
    with (folder / "src" / "a" / "CMakeLists.txt").open("a") as cmake:
        cmake.write("add_executable(node src/node.cpp)\n")
    made = make(type_)
    assert made.exit_code == 0
    assert made.stderr.startswith("Warning: ") and "C++" in made.stderr


def test_outside_the_root_of_a_workspace_the_error_says_where_it_is(
    folder: Path, type_: Type
) -> None:
    type_("workspace", "init", at="src")
    within = make(type_, at="src")
    assert within.exit_code == 1
    assert str(folder / "src") in within.stderr and within.stderr.endswith(": cd ..\n")
    assert make(type_, at="..").stderr.startswith(f"Error: {folder.parent} is not a workspace")
    assert not (folder.parent / "devel").exists()


def test_workspace_may_be_given(folder: Path, type_: Type) -> None:
    for option in ("-C", "--directory"):
        made = make(type_, option, "ros_workspace", at="..")
        assert f"Base path: {folder}\n" in made.output
        assert made.output.endswith(f"Next: source {folder / 'devel' / 'setup.bash'}\n")


def test_sourced_workspace_needs_no_sourcing(
    folder: Path, type_: Type, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(folder / "src"))
    output = make(type_).output
    assert "Next:" not in output and "already" in output.splitlines()[-1]


def test_zsh_has_its_own_file(type_: Type, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SHELL", "/usr/bin/zsh")
    monkeypatch.setattr(os, "getppid", lambda: 0)  # Tests may run in any shell.
    assert make(type_).output.endswith("Next: source devel/setup.zsh\n")


@pytest.mark.skipif(not Path("/proc/self/comm").exists(), reason="the system has no /proc")
def test_zsh_in_another_shell_has_its_own_file_too(
    folder: Path, type_: Type, monkeypatch: pytest.MonkeyPatch
) -> None:
    shell = folder / "zsh"
    shell.write_text("#!/bin/sh\necho ready\nread line\n")
    shell.chmod(0o755)
    with Popen([shell], stdin=PIPE, stdout=PIPE, text=True) as started:
        assert started.stdin is not None
        assert started.stdout is not None
        assert started.stdout.readline() == "ready\n"
        monkeypatch.setattr(os, "getppid", lambda: started.pid)
        assert make(type_).output.endswith("Next: source devel/setup.zsh\n")
        started.stdin.close()


@pytest.mark.parametrize(
    "words",
    [
        ["-j4"],
        ["-j", "4"],
        ["-j"],
        ["-j2", "-l2.5", "VERBOSE=1", "-k"],
        ["-DCMAKE_BUILD_TYPE=Release", "-DPYTHON_EXECUTABLE=/usr/bin/python3"],
        ["--cmake-args", "-DCMAKE_BUILD_TYPE=Release", "--anything"],
        ["--make-args", "whatever"],
        ["--force-cmake", "--no-color", "--use-ninja", "-GNinja"],
        ["all"],
    ],
)
def test_options_for_cmake_and_make_are_ignored(type_: Type, words: list[str]) -> None:
    type_("pkg", "create", "a", at="src")
    made = make(type_, *words)
    assert made.exit_code == 0, made.stderr
    assert "~~  - a\n" in made.output


def test_some_packages_are_chosen(type_: Type) -> None:
    for name, depends in (("a", []), ("b", ["a"]), ("c", []), ("d", [])):
        type_("pkg", "create", name, *depends, at="src")

    def built(*words: str) -> str:
        lines = make(type_, *words).output.splitlines()
        return "".join(line[-1] for line in lines if line.startswith("~~  - "))

    assert built("--pkg", "a", "c") == "ac"
    assert built("--pkg", "c", "-j4") == "c"
    assert built("--only-pkg-with-deps", "b", "d") == "abd"
    assert built("-DCATKIN_WHITELIST_PACKAGES=b;c") == "abc"
    assert built("-DCATKIN_WHITELIST_PACKAGES=") == "abcd"
    unknown = make(type_, "--pkg", "x")
    assert unknown.exit_code == 1 and unknown.stderr.endswith(": x\n")
    assert built("--pkg", "a", "c", "-j4", "all") == "ac"
    for words in (
        ["--pkg"],
        ["--pkg", "--no-color"],
        ["--pkg", "--make-args", "x"],
        ["--pkg", "--", "all"],
    ):
        assert "Option '--pkg' requires an argument." in make(type_, *words).stderr


def test_clean_removes_build_products(folder: Path, type_: Type) -> None:
    type_("pkg", "create", "a", at="src")
    make(type_)
    assert (folder / "devel" / "share" / "a").is_dir()
    assert str(folder / "devel") in make(type_, "clean").output
    assert not (folder / "devel" / "share" / "a").exists()


@pytest.mark.parametrize(
    ("word", "text"),
    [
        ("install", "install space"),
        ("testing", "unknown target testing"),
        ("frobnicate", "unknown target frobnicate"),
        ("--build=x", "--build=x: "),
    ],
)
def test_other_targets_are_errors(folder: Path, type_: Type, word: str, text: str) -> None:
    made = make(type_, word)
    assert made.exit_code == 1
    assert text in made.stderr
    assert not (folder / "devel").exists()


def test_initializing_a_folder_with_another_name_is_noted(folder: Path, type_: Type) -> None:
    (folder / "sources").mkdir()
    begun = type_("workspace", "init", "sources")
    assert "src/" in begun.output.splitlines()[-1]
    again = type_("workspace", "init", "sources")
    assert again.exit_code == 1 and "already exists" in again.stderr


GOOD_TEST = "import unittest\nclass A(unittest.TestCase):\n    def test_a(self): pass\n"
BAD_TEST = GOOD_TEST.replace("pass", "self.fail('no')")


def with_tests(folder: Path, type_: Type, package: str, macros: str, **files: str) -> None:
    type_("pkg", "create", package, "std_msgs", at="src")
    root = folder / "src" / package
    (root / "test").mkdir()
    for name, text in files.items():
        (root / "test" / f"{name}.py").write_text(text)
    with (root / "CMakeLists.txt").open("a") as file:
        file.write(f"if(CATKIN_ENABLE_TESTING)\n{macros}\nendif()\n")


@pytest.mark.long
def test_run_tests_builds_and_runs_the_tests(folder: Path, type_: Type) -> None:
    macros = "catkin_add_nosetests(test/a.py)\ncatkin_add_gtest(cpp_test test/a.cpp)"
    macros += "\nfind_package(roslaunch)\nroslaunch_add_file_check(test/a.launch speed=3)"
    uses = "from std_msgs.msg import Int32\nimport rospy\n"
    with_tests(folder, type_, "a", macros, a=uses + GOOD_TEST)
    launch = '<launch><arg name="speed"/></launch>'
    (folder / "src" / "a" / "test" / "a.launch").write_text(launch)
    made = make(type_, "run_tests")
    assert made.exit_code == 0, made.output
    assert (folder / "devel" / "setup.bash").is_file()
    for line in ("a: catkin_add_nosetests test/a.py", "a: roslaunch_add_file_check test/a.launch"):
        assert f"~~  {line}\n" in made.stdout
    assert "Summary: 2 tests, 0 errors, 0 failures, 0 skipped\n" in made.stdout
    assert "C++: 1 test left out: cpp_test" in made.stderr


@pytest.mark.long
def test_run_tests_runs_rostest(folder: Path, type_: Type) -> None:
    with_tests(folder, type_, "a", "add_rostest(test/a.test ARGS kind:=good)")
    test = '<test pkg="a" type="$(arg kind)" test-name="moves"/>'
    text = f'<launch><arg name="kind"/>{test}</launch>'
    (folder / "src" / "a" / "test" / "a.test").write_text(text)
    program = folder / "src" / "a" / "test" / "good"
    program.write_text("#!/bin/sh\necho '<testsuite tests=\"2\"/>' > ${1#--gtest_output=xml:}\n")
    program.chmod(0o755)
    made = make(type_, "run_tests_a")
    assert made.exit_code == 0, made.output
    results = folder / "build" / "test_results" / "a"
    assert {path.name for path in results.iterdir()} == {
        *("rostest-test_a.xml", "rosunit-moves.xml")
    }
    assert "Summary: 3 tests, 0 errors, 0 failures, 0 skipped\n" in made.stdout


@pytest.mark.long
def test_failed_tests_are_an_error(folder: Path, type_: Type) -> None:
    with_tests(folder, type_, "a", "catkin_add_nosetests(test/a.py)", a=BAD_TEST)
    with_tests(folder, type_, "b", "catkin_add_nosetests(test)", test_b=GOOD_TEST)
    made = make(type_, "test")
    assert made.exit_code == 1
    assert "tests failed: a: catkin_add_nosetests test/a.py\n" in made.stderr
    assert "a/nosetests-test_a.xml: 1 tests, 0 errors, 1 failures, 0 skipped\n" in made.stdout
    assert make(type_, "run_tests_b").exit_code == 0
    assert make(type_, "--make-args", "-j1", "run_tests").exit_code == 1
    assert make(type_, "run_tests_c").exit_code == 1


def test_test_without_results_of_its_own_is_in_the_results(folder: Path, type_: Type) -> None:
    with_tests(folder, type_, "a", "roslaunch_add_file_check(test)")
    for name, text in (("good", "<launch/>"), ("bad", "<launch>")):
        (folder / "src" / "a" / "test" / f"{name}.launch").write_text(text)
    made = make(type_, "run_tests")
    assert made.exit_code == 1
    bad = "a/roslaunch-check_test_bad.xml: 1 tests, 0 errors, 1 failures, 0 skipped\n"
    assert f"{bad}Summary: 2 tests, 0 errors, 1 failures, 0 skipped\n" in made.stdout


def test_tests_run_without_pytest(
    folder: Path, type_: Type, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(package_tests, "find_spec", lambda name: None)
    with_tests(folder, type_, "a", "catkin_add_nosetests(test/a.py)", a=GOOD_TEST)
    with_tests(folder, type_, "b", "catkin_add_nosetests(test)", test_b=GOOD_TEST)
    with_tests(folder, type_, "c", "catkin_add_nosetests(test/c.py)", c=BAD_TEST)
    made = make(type_, "run_tests")
    assert made.exit_code == 1
    bad = "c/nosetests-test_c.xml: 1 tests, 0 errors, 1 failures, 0 skipped\n"
    assert f"{bad}Summary: 3 tests, 0 errors, 1 failures, 0 skipped\n" in made.stdout


def test_missing_test_is_an_error_with_its_line(folder: Path, type_: Type) -> None:
    with_tests(folder, type_, "a", "add_rostest(test/gone.test)")
    assert make(type_).exit_code == 0
    made = make(type_, "run_tests")
    assert made.exit_code == 1
    assert "CMakeLists.txt, line " in made.stderr
    assert "gone.test not found" in made.stderr


def test_results_of_tests_are_summed_up(folder: Path, type_: Type) -> None:
    results = folder / "build" / "test_results" / "a"
    results.mkdir(parents=True)
    (results / "good.xml").write_text('<testsuite tests="2" skipped="1"/>')
    case = '<testcase name="x"><error message="lost"/></testcase>'
    (results / "bad.xml").write_text(f'<testsuite tests="1" errors="1">{case}</testsuite>')
    (results / "package.xml").write_text("<package/>")
    bad = "a/bad.xml: 1 tests, 1 errors, 0 failures, 0 skipped\n"
    summary = "Summary: 3 tests, 1 errors, 0 failures, 1 skipped\n"
    done = type_("workspace", "test-results")
    assert (done.exit_code, done.output) == (1, bad + summary)
    assert "a/good.xml: 2 tests" in type_("workspace", "test-results", "--all").output
    assert "\nlost\n" in type_("workspace", "test-results", "--verbose", "build").output
    (results / "bad.xml").unlink()
    assert type_("workspace", "test-results").exit_code == 0
