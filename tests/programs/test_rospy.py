"""``python -m fibws.rospy``."""

from __future__ import annotations

from pathlib import Path

from running_programs import Start


async def test_script_is_run_with_its_arguments(start: Start, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text("import sys; print(sys.argv[1:])")
    program = await start("fibws.rospy", str(script), "numbers:=fibonacci", "--help")
    assert await program.end() == (0, "['numbers:=fibonacci', '--help']\n", "")


async def test_help(start: Start) -> None:
    program = await start("fibws.rospy", "--help")
    code, out, err = await program.end()
    assert (code, err) == (0, "")
    assert out.startswith("Usage: python -m fibws.rospy SCRIPT [ARGUMENTS]...\n")


async def test_missing_script_is_an_error(start: Start) -> None:
    for words in ([], ["--nonsense"]):
        program = await start("fibws.rospy", *words)
        code, out, err = await program.end()
        assert (code, out) == (2, "")
        assert err.startswith("Usage: python -m fibws.rospy SCRIPT")
