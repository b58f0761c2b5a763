"""Folders of definitions that are there or not, and parse or not."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fibws.cli.doctor import definitions
from fibws.cli.doctor.finding import Finding
from fibws.ros1.workspace.build import RECORD


def define(folder: Path, **texts: str) -> None:
    """Write ``my_msgs/msg/<name>.msg`` for each name."""
    (folder / "my_msgs/msg").mkdir(parents=True)
    for name, text in texts.items():
        (folder / f"my_msgs/msg/{name}.msg").write_text(text)


def found(*folders: Path) -> list[tuple[str, str]]:
    return [(finding.verdict, finding.text) for finding in definitions.of(list(folders))]


def test_where_no_folder_is_named_there_is_nothing_to_say(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("FIBWS_INTERFACES", raising=False)
    assert list(definitions.checks()) == []


def test_the_environment_names_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    define(tmp_path, Mine="int32 a", Other="Mine[] mine")
    missing = tmp_path / "missing"
    monkeypatch.setenv("FIBWS_INTERFACES", f"{tmp_path}{os.pathsep}{missing}")
    wrong, fine = definitions.checks()
    assert wrong == Finding(
        "definitions",
        "wrong",
        f"{missing} is in $FIBWS_INTERFACES and is no folder",
        f"Make it, or take it out: folders are divided by {os.pathsep}",
    )
    assert (fine.verdict, fine.text[-1]) == ("ok", "2")


def test_a_folder_with_nothing_in_it_is_odd(tmp_path: Path) -> None:
    assert found(tmp_path) == [("warning", f"{tmp_path} has no definitions")]


def test_a_workspace_needs_no_definitions(tmp_path: Path) -> None:
    (tmp_path / RECORD).touch()
    (tmp_path / "share").mkdir()
    assert found(tmp_path / "share") == []


def test_a_file_that_does_not_parse_is_named_with_the_line(tmp_path: Path) -> None:
    define(tmp_path, Bad="int32 a\nnonsense", Good="int32 a", Nests="Bad bad")
    wrong, fine = found(tmp_path)
    assert wrong[0] == "wrong"
    assert wrong[1].startswith(f"{tmp_path}/my_msgs/msg/Bad.msg, line 2: ")
    assert fine[0] == "ok"


def test_types_that_nobody_defined_are_named(tmp_path: Path) -> None:
    define(tmp_path, Nests="int32 a\nother_msgs/Type a")
    ((verdict, text),) = found(tmp_path)
    assert verdict == "wrong"
    assert text.startswith(f"{tmp_path}/my_msgs/msg/Nests.msg, line 2: ")
    assert "other_msgs" in text


def test_folders_may_need_each_other(tmp_path: Path) -> None:
    define(tmp_path / "a", Nests="other_msgs/Type a")
    (tmp_path / "b/other_msgs/msg").mkdir(parents=True)
    (tmp_path / "b/other_msgs/msg/Type.msg").write_text("int32 a")
    assert [verdict for verdict, _ in found(tmp_path / "a", tmp_path / "b")] == ["ok"]


def test_services_and_actions_are_read_too(tmp_path: Path) -> None:
    define(tmp_path)
    for kind in ("srv", "action"):
        (tmp_path / "my_msgs" / kind).mkdir()
        (tmp_path / f"my_msgs/{kind}/Bad.{kind}").write_text("nonsense")
    texts = [text for _, text in found(tmp_path)]
    assert ["Bad.srv" in texts[0], "Bad.action" in texts[1]] == [True, True]


def test_a_great_many_faults_are_counted(tmp_path: Path) -> None:
    define(tmp_path, **{f"Bad{number:02}": "nonsense" for number in range(25)})
    texts = [text for _, text in found(tmp_path)]
    assert len(texts) == definitions.MOST + 1
    assert texts[-1] == "and 5 more"
