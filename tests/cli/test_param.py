"""``fibws param``."""

from __future__ import annotations

import errno
import json
import math
import os
from pathlib import Path

import pytest
from hub_in_thread import Run

pytestmark = pytest.mark.usefixtures("run")


def test_parameter_is_set_and_printed(run: Run) -> None:
    result = run("param", "set", "/gain", "1.5")
    assert (result.exit_code, result.output) == (0, "")
    assert run("param", "get", "gain").output == "1.5\n"
    assert run("param", "get", "--json", "/gain").output == "1.5\n"


def test_namespace_is_an_object(run: Run) -> None:
    result = run("param", "set", "-v", "robot", "{arm: {joints: [1, 2], name: x}}")
    assert result.output.splitlines() == [
        "set parameter [/robot/arm/joints] to [[1, 2]]",
        'set parameter [/robot/arm/name] to ["x"]',
    ]
    # The empty line is rosparam's.
    assert run("param", "get", "/robot/").output == "arm:\n  joints:\n  - 1\n  - 2\n  name: x\n\n"
    assert run("param", "get", "-p", "/robot/arm").output == "joints: - 1\n- 2\nname: x\n"
    assert json.loads(run("param", "get", "--json", "robot").output) == {
        "arm": {"joints": [1, 2], "name": "x"}
    }


def test_object_is_merged(run: Run) -> None:
    run("param", "set", "robot", "{a: 1, b: 1}")
    run("param", "set", "robot", "{b: 2, c: 3}")
    assert json.loads(run("param", "get", "--json", "robot").output) == {"a": 1, "b": 2, "c": 3}


@pytest.mark.parametrize(
    ("word", "value"), [("", ""), ("-5", -5), ('"1"', "1"), ("rad(pi)", math.pi)]
)
def test_empty_negative_and_quoted_values(run: Run, word: str, value: object) -> None:
    assert run("param", "set", "x", word).exit_code == 0
    assert json.loads(run("param", "get", "--json", "x").output) == value


def test_file_may_be_the_value(run: Run, tmp_path: Path) -> None:
    (tmp_path / "urdf").write_text("<robot>\n  5</robot>\n")
    assert run("param", "set", "robot_description", "-t", str(tmp_path / "urdf")).exit_code == 0
    found = json.loads(run("param", "get", "--json", "robot_description").output)
    assert found == "<robot>\n  5</robot>\n"


@pytest.mark.parametrize(
    "words", [["x"], ["x", "1", "-t", __file__], ["x", "[1"], ["x", "--jsn"], ["~x", "1"]]
)
def test_invalid_values_are_wrong_usage(run: Run, words: list[str]) -> None:
    assert run("param", "set", *words).exit_code == 2
    assert run("param", "get", "/x").exit_code == 1


def test_refused_parameter_is_an_error(run: Run) -> None:
    result = run("param", "set", "/x", "x" * 2**22)
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.startswith("Error: Parameter [/x] ")


def test_list_prints_names(run: Run) -> None:
    run("param", "set", "/", "{b: {c: 1, a: 2}, bc: 3}")
    found = run("param", "list").output.splitlines()
    assert found == sorted(found)
    assert {"/b/a", "/bc", "/rosdistro"} <= set(found)
    assert run("param", "list", "b").output == "/b/a\n/b/c\n"
    assert run("param", "list", "/b/", "--json").output == '"/b/a"\n"/b/c"\n'
    assert run("param", "list", "/nothing").output == ""


def test_names_are_relative_to_the_namespace(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "/robot")
    run("param", "set", "gain", "1")
    assert run("param", "get", "/robot/gain").output == "1\n"


def test_names_may_contain_any_characters(run: Run) -> None:
    run("param", "set", "/9 lives/ü", "1")
    assert run("param", "get", "/9 lives/ü").output == "1\n"


def test_unknown_parameter_is_an_error(run: Run) -> None:
    run("param", "set", "/gain", "1")
    result = run("param", "get", "/gian")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "[/gian] is not set; did you mean /gain?" in result.stderr


def test_delete(run: Run) -> None:
    run("param", "set", "/a", "{b: 1, c: 2}")
    assert run("param", "delete", "/a/b").output == ""
    assert run("param", "delete", "-v", "/a").output == "deleted parameter [/a]\n"
    result = run("param", "delete", "/a")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "[/a] is not set" in result.stderr
    assert run("param", "delete", "/").exit_code == 0
    assert run("param", "list").output == ""


def test_dumped_parameters_can_be_loaded(run: Run, tmp_path: Path) -> None:
    run("param", "set", "/robot", "{a: '1', b: 1, c: [x, 1.5], d: {e: true}, f: \"l1\\nl2\"}")
    file = str(tmp_path / "robot.yaml")
    result = run("param", "dump", "-v", file, "/robot")
    assert result.output == f"dumped namespace [/robot] to file [{file}]\n"
    run("param", "load", file, "/copy")
    robot, copy = (run("param", "get", "--json", name).output for name in ("robot", "copy"))
    assert robot == copy
    printed = run("param", "dump", "-", "/robot").output
    assert printed == Path(file).read_text()
    run("param", "load", "-", "/piped", input=printed)
    assert run("param", "get", "--json", "piped").output == robot


def test_dump_and_load_keep_every_value(run: Run, tmp_path: Path) -> None:
    text = "angle: 'deg(90)'\nbytes: !!binary AP8=\ndate: 2026-01-31 12:00:00\nn: [.nan, -.inf]\n"
    result = run("param", "load", "-", "/first", input=text)
    assert (result.exit_code, result.output) == (0, "")
    first = run("param", "dump", "-", "/first").output
    run("param", "load", "-", "/second", input=first)
    assert run("param", "dump", "-", "/second").output == first
    for shown in ("'deg(90)'", "!!binary", "2026-01-31 12:00:00", ".nan", "-.inf"):
        assert shown in first


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no such device")
def test_dump_that_fails_leaves_the_old_file(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    path = tmp_path / "robot.yaml"
    path.write_text("old: 1\n")
    monkeypatch.setattr(os, "replace", full)
    result = run("param", "dump", str(path))
    assert result.exit_code == 1
    assert f"{path}: No space left on device" in result.stderr
    assert path.read_text() == "old: 1\n" and list(tmp_path.iterdir()) == [path]
    assert "/dev/full: No space left" in run("param", "dump", "/dev/full").stderr


def test_dump_prints_everything(run: Run) -> None:
    assert "rosdistro: 'noetic\n" in run("param", "dump").output
    assert json.loads(run("param", "dump", "--json").output)["rosdistro"] == "noetic\n"


def test_load_sets_nothing_after_an_error(run: Run, tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_text("a: 1\n---\nb: null\n")
    result = run("param", "load", str(tmp_path / "bad.yaml"), "/x")
    assert (result.exit_code, result.stdout) == (1, "")
    assert f"{tmp_path / 'bad.yaml'}: Parameter [/x/b]" in result.stderr
    assert run("param", "list", "/x").output == ""
    assert "standard input: Invalid YAML" in run("param", "load", "-", input="a: [").stderr


def test_file_errors_are_reported(run: Run, tmp_path: Path) -> None:
    missing = str(tmp_path / "missing" / "file")
    assert run("param", "load", missing).exit_code == 2
    result = run("param", "dump", missing)
    assert result.exit_code == 1
    assert f"{missing}: No such file or directory" in result.stderr
