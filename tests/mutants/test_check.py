"""The mutants fit the code, and the check notices those that survive."""

from __future__ import annotations

from pathlib import Path

import pytest

from . import check
from .check import Mutant


def test_mutants_fit_the_code() -> None:
    assert check.faults(check.load()) == []


def test_lost_line_and_lost_test_are_faults(tmp_path: Path) -> None:
    (tmp_path / "code.py").write_text("a = 1\nb = 1\n")
    lost = Mutant("x", "code.py", "c", "d", ("test_code.py",))
    unclear = Mutant("x", "code.py", "= 1", "= 2", ())
    assert len(check.faults([lost], tmp_path)) == 2
    assert len(check.faults([unclear], tmp_path)) == 1


@pytest.mark.long  # It runs pytest, as .ci/all does with each mutant.
def test_surviving_mutant_is_reported(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    code = "def f():\n    return 1\n\n\ndef g():\n    return 2\n"
    (tmp_path / "code_under_test.py").write_text(code)
    (tmp_path / "test_code.py").write_text(
        "from code_under_test import f\n\n\ndef test_f():\n    assert f() == 1\n"
    )
    (tmp_path / "pytest.ini").write_text("[pytest]\npythonpath = .\n")
    killed = Mutant("kept by a test", "code_under_test.py", "1", "3", ("test_code.py",))
    survivor = Mutant("kept by nothing", "code_under_test.py", "2", "3", ("test_code.py",))
    assert check.check([killed], tmp_path, jobs=1)
    assert not check.check([killed, survivor], tmp_path, jobs=1)
    assert "1 of 2 mutants killed" in capfd.readouterr().out
