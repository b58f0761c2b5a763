"""The modules in fibws/msg are what the generator writes, and any package can be written."""

import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from fibws.interfaces import Interfaces, generator

ODD = """\
string<=5 FROM=it's \\\\ so
float32 INFINITE=1e400
int32 None=5
string from here
bytes_msgs/Bytes bytes
Late late
Late[2] lates
Late[] more
uint8[] blob [1, 2]
uint8[3] fixed
float64[2] pair [0.5, 1.0]
bool[2] flags
time when
duration[2] spans
bytes_msgs/AVeryLongNameThatGoesOnAndOn another_very_long_name_that_goes_on
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of two packages that hold each other's messages."""
    for name, text in {
        "odd_msgs/msg/Early.msg": ODD,
        "odd_msgs/msg/Late.msg": "int32 x",
        "bytes_msgs/msg/Bytes.msg": "odd_msgs/Late late",
        "bytes_msgs/msg/AVeryLongNameThatGoesOnAndOn.msg": "",
    }.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    return tmp_path


def test_the_modules_of_the_standard_packages_are_up_to_date() -> None:
    interfaces = Interfaces()
    written = {path.stem for path in generator.MODULES.glob("[!_]*.py")}
    assert written == {name for name in interfaces.packages() if interfaces.messages(name)}
    for package in sorted(written):
        source = (generator.MODULES / f"{package}.py").read_text("utf-8")
        assert source == generator.generate(package, interfaces), (
            "run python -m fibws.interfaces.generator"
        )


def test_an_odd_package_is_written(folder: Path) -> None:
    source = generator.generate("odd_msgs", Interfaces([folder]))
    assert source.index("class Late") < source.index("class Early")
    assert 'FROM: ClassVar[str] = "it\'s \\\\\\\\ so"' in source
    assert 'INFINITE: ClassVar[float] = float("inf")' in source
    assert "None_: ClassVar[int] = 5" in source
    assert 'from_: str = "here"' in source
    assert "bytes_: bytes_msgs.Bytes = field(default_factory=lambda: bytes_msgs.Bytes())" in source
    assert "late: Late = field(default_factory=lambda: Late())" in source
    assert "lates: list[Late] = field(default_factory=lambda: [Late() for _ in range(2)])" in source
    assert "more: list[Late] = field(default_factory=list)" in source
    assert "blob: bytes = bytes([1, 2])" in source
    assert "fixed: bytes = bytes(3)" in source
    assert "pair: list[float] = field(default_factory=lambda: [0.5, 1.0])" in source
    assert "flags: list[bool] = field(default_factory=lambda: [False] * 2)" in source
    assert "when: ros.Time = field(default_factory=ros.Time)" in source
    assert max(map(len, source.splitlines())) <= generator.LINE_LENGTH


def test_a_member_may_have_the_name_of_a_message(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    messages = tmp_path / "same_msgs" / "msg"
    messages.mkdir(parents=True)
    (messages / "Late.msg").write_text("int32 x")
    (messages / "Field.msg").write_text("Late Late\nLate[1] more")
    (messages / "Constant.msg").write_text("int32 Late=5\nLate late\nLate[1] more")
    module: Any = ModuleType("same_msgs")
    monkeypatch.setitem(sys.modules, "same_msgs", module)
    exec(generator.generate("same_msgs", Interfaces([tmp_path])), module.__dict__)
    late = module.Late(0)
    assert module.Field() == module.Field(Late=late, more=[late])
    assert module.Constant() == module.Constant(late=late, more=[late])
    assert module.Constant.Late == 5
    for message in (module.Field(), module.Constant()):
        assert type(message).from_dict(message.to_dict()) == message


def test_an_odd_package_is_formatted_and_typed(folder: Path, tmp_path: Path) -> None:
    interfaces = Interfaces([folder])
    modules = tmp_path / "modules"
    modules.mkdir()
    for package in ("odd_msgs", "bytes_msgs"):
        source = generator.generate(package, interfaces)
        source = source.replace("from fibws.msg import", "import")
        (modules / f"{package}.py").write_text(source, "utf-8")
    for tool in (
        ("ruff", "format", "--isolated", "--line-length=100", "--check", "."),
        ("mypy", "--strict", "--config-file=", "."),
    ):
        done = subprocess.run(
            [sys.executable, "-m", *tool],
            cwd=modules,
            env=os.environ | {"MYPYPATH": str(generator.MODULES.parents[1])},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stdout + done.stderr


def test_the_command_prints_a_users_package(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    generator.main(["--interfaces", str(folder), "bytes_msgs"])
    assert capsys.readouterr().out == generator.generate("bytes_msgs", Interfaces([folder]))


def test_the_command_writes_the_standard_packages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(generator, "MODULES", tmp_path)
    generator.main([])
    assert len(list(tmp_path.iterdir())) > 15
    assert (tmp_path / "std_msgs.py").read_text("utf-8") == generator.generate(
        "std_msgs", Interfaces()
    )


def test_the_command_says_what_is_wrong(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        generator.main(["nobodys_msgs"])
    assert caught.value.code == 1
    assert "package nobodys_msgs" in capsys.readouterr().err
