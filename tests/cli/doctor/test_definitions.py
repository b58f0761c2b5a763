"""Checks of the folders of definitions."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fibws.cli.doctor import definitions
from fibws.ros1.workspace.build import RECORD


def define(folder: Path, **texts: str) -> None:
    """Write ``my_msgs/msg/<name>.msg`` for each name."""
    (folder / "my_msgs/msg").mkdir(parents=True)
    for name, text in texts.items():
        (folder / f"my_msgs/msg/{name}.msg").write_text(text)


def found(*folders: Path) -> list[tuple[str, str]]:
    return [(finding.verdict, finding.text) for finding in definitions.check_folders(list(folders))]


def test_nothing_is_checked_without_folders(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("FIBWS_INTERFACES", raising=False)
    assert list(definitions.checks()) == []


def test_folders_of_the_environment_are_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    define(tmp_path, Mine="int32 a", Other="Mine[] mine")
    missing = tmp_path / "missing"
    monkeypatch.setenv("FIBWS_INTERFACES", f"{tmp_path}{os.pathsep}{missing}")
    wrong, fine = definitions.checks()
    assert (wrong.check, wrong.verdict) == ("definitions", "wrong")
    assert str(missing) in wrong.text and "$FIBWS_INTERFACES" in wrong.text
    assert os.pathsep in wrong.advice
    assert (fine.verdict, fine.text[-1]) == ("ok", "2")


def test_empty_folder_is_a_warning(tmp_path: Path) -> None:
    ((verdict, text),) = found(tmp_path)
    assert verdict == "warning" and str(tmp_path) in text


def test_workspace_needs_no_definitions(tmp_path: Path) -> None:
    (tmp_path / RECORD).touch()
    (tmp_path / "share").mkdir()
    assert found(tmp_path / "share") == []


def test_invalid_file_is_named_with_the_line(tmp_path: Path) -> None:
    define(tmp_path, Bad="int32 a\nnonsense", Good="int32 a", Nests="Bad bad")
    wrong, fine = found(tmp_path)
    assert wrong[0] == "wrong"
    assert wrong[1].startswith(f"{tmp_path}/my_msgs/msg/Bad.msg, line 2: ")
    assert fine[0] == "ok"


def test_undefined_types_are_named(tmp_path: Path) -> None:
    define(tmp_path, Nests="int32 a\nother_msgs/Type a")
    ((verdict, text),) = found(tmp_path)
    assert verdict == "wrong"
    assert text.startswith(f"{tmp_path}/my_msgs/msg/Nests.msg, line 2: ")
    assert "other_msgs" in text


def test_folders_may_use_each_other(tmp_path: Path) -> None:
    define(tmp_path / "a", Nests="other_msgs/Type a")
    (tmp_path / "b/other_msgs/msg").mkdir(parents=True)
    (tmp_path / "b/other_msgs/msg/Type.msg").write_text("int32 a")
    assert [verdict for verdict, _ in found(tmp_path / "a", tmp_path / "b")] == ["ok"]


def test_services_and_actions_are_checked(tmp_path: Path) -> None:
    define(tmp_path)
    for kind in ("srv", "action"):
        (tmp_path / "my_msgs" / kind).mkdir()
        (tmp_path / f"my_msgs/{kind}/Bad.{kind}").write_text("nonsense")
    texts = [text for _, text in found(tmp_path)]
    assert ["Bad.srv" in texts[0], "Bad.action" in texts[1]] == [True, True]


def test_further_errors_are_counted(tmp_path: Path) -> None:
    define(tmp_path, **{f"Bad{number:02}": "nonsense" for number in range(25)})
    texts = [text for _, text in found(tmp_path)]
    assert len(texts) == definitions.MAX_LISTED + 1
    assert texts[-1] == "and 5 more"
