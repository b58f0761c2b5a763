"""The generator of the modules in fibws/msg, srv and action."""

import os
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from fibws.errors import InterfaceError
from fibws.interfaces import Interfaces, generated_modules, generator
from fibws.interfaces.class_source import LINE_LENGTH
from fibws.interfaces.folders import KINDS, Kind

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
        "odd_msgs/srv/AVeryLongNameThatGoesOnAndOn.srv": "Late[2] late\nint32 from\n---\nint32 X=1",
        "odd_msgs/srv/Empty.srv": "---",
        "odd_msgs/srv/NameThatFillsTheLine.srv": "bytes_msgs/Bytes bytes\n---\ntime when",
        "odd_msgs/action/Go.action": "---\n---",
        "odd_msgs/action/GoAsFarAsTheLine.action": "Late late\n---\n---",
        "odd_msgs/action/GoMuchFurtherThanTheLine.action": "---\nint32 result\n---",
    }.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    return tmp_path


def test_odd_package_is_generated(folder: Path) -> None:
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
    assert max(map(len, source.splitlines())) <= LINE_LENGTH


def test_member_may_have_the_name_of_a_message(
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


def test_two_classes_of_one_name_are_refused(tmp_path: Path) -> None:
    services = tmp_path / "same_msgs" / "srv"
    services.mkdir(parents=True)
    (services / "Ask.srv").write_text("---")
    (services / "AskRequest.srv").write_text("---")
    with pytest.raises(InterfaceError, match="the name AskRequest in same_msgs's srv"):
        generator.generate("same_msgs", Interfaces([tmp_path]), "srv")


@pytest.mark.long  # mypy reads all that pydantic has.
def test_odd_package_passes_the_linters(folder: Path, tmp_path: Path) -> None:
    interfaces = Interfaces([folder])
    modules = tmp_path / "modules"
    written: list[tuple[Kind, str]] = [
        ("msg", "odd_msgs"),
        ("msg", "bytes_msgs"),
        ("msg", "std_msgs"),
        ("msg", "actionlib_msgs"),
        ("srv", "odd_msgs"),
        ("action", "odd_msgs"),
    ]
    for kind, package in written:
        source = generator.generate(package, interfaces, kind)
        (modules / kind).mkdir(parents=True, exist_ok=True)
        (modules / kind / f"{package}.py").write_text(
            source.replace("import fibws.msg.", "import msg."), "utf-8"
        )
    for tool in (
        ("ruff", "check", "--isolated", "--line-length=100", "--select=E,F,W", "."),
        ("ruff", "format", "--isolated", "--line-length=100", "--check", "."),
        ("mypy", "--strict", "--config-file=", "-p", "msg", "-p", "srv", "-p", "action"),
    ):
        done = subprocess.run(
            [sys.executable, "-m", *tool],
            cwd=modules,
            env=os.environ | {"MYPYPATH": str(generated_modules.MODULES.parent)},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stdout + done.stderr


def test_command_writes_stubs_of_all_packages_of_the_users_folder(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stubs = tmp_path / "typings"
    generator.main(["--interfaces", str(folder), "--stubs", str(stubs)])
    written: set[tuple[Kind, str]] = {
        ("msg", "bytes_msgs"),
        *((kind, "odd_msgs") for kind in KINDS),
    }
    paths = {stubs / "fibws" / kind / f"{package}.pyi" for kind, package in written}
    assert set(map(Path, capsys.readouterr().out.splitlines())) == paths
    assert {path for path in stubs.rglob("*") if path.is_file()} == paths
    for kind, package in written:
        text = (stubs / "fibws" / kind / f"{package}.pyi").read_text("utf-8")
        assert text == generator.generate(package, Interfaces([folder]), kind)


def test_stubs_of_types_that_are_gone_are_removed(folder: Path, tmp_path: Path) -> None:
    stubs = tmp_path / "typings"
    generator.main(["--interfaces", str(folder), "--stubs", str(stubs)])
    own = stubs / "fibws" / "srv" / "bytes_msgs.pyi"
    own.write_text("x: int", "utf-8")
    for action in (folder / "odd_msgs" / "action").iterdir():
        action.unlink()
    generator.main(["--interfaces", str(folder), "--stubs", str(stubs)])
    assert not (stubs / "fibws" / "action" / "odd_msgs.pyi").exists()
    assert own.exists()  # The command has not written it.


def test_stubs_of_a_package_with_a_standard_name_come_with_those_of_fibws_itself(
    tmp_path: Path,
) -> None:
    own = tmp_path / "own" / "std_msgs" / "msg"
    own.mkdir(parents=True)
    (own / "Extra.msg").write_text("int32 level\n")
    arguments = ["--interfaces", str(tmp_path / "own"), "--stubs", str(tmp_path / "typings")]
    generator.main(arguments)
    stubs = tmp_path / "typings" / "fibws"
    text = (stubs / "msg" / "std_msgs.pyi").read_text("utf-8")
    assert "class Extra(" in text
    assert "class String(" in text
    parents = {each.parent.name: each for each in stubs.rglob("__init__.pyi")}
    text = parents["fibws"].read_text("utf-8")
    assert "Node as Node" in text
    # Pyright looks for modules with relative names beside the stub alone.
    [exported] = re.findall(r"^from \. import (.*)$", text, re.M)
    assert {each.split(" as ")[0] for each in exported.split(", ")} == {*parents} - {"fibws"}
    for each in parents.values():
        assert not re.search(r"^from \.\w", each.read_text("utf-8"), re.M), each
    (tmp_path / "own" / "std_msgs").rename(tmp_path / "own" / "extra_msgs")
    (stubs / "msg" / "std_msgs.pyi").unlink()
    generator.main(arguments)
    assert not [*stubs.rglob("__init__.pyi")]


def test_stubs_need_packages_of_the_user(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("FIBWS_INTERFACES", raising=False)
    with pytest.raises(SystemExit) as caught:
        generator.main(["--stubs", str(tmp_path)])
    assert caught.value.code == 1
    assert "FIBWS_INTERFACES" in capsys.readouterr().err


def test_command_writes_the_standard_packages(tmp_path: Path) -> None:
    generator.main(["--into", str(tmp_path)])
    packages: dict[Kind, str] = {"msg": "std_msgs", "srv": "std_srvs", "action": "tf2_msgs"}
    for kind, package in packages.items():
        written = (tmp_path / kind / f"{package}.py").read_text("utf-8")
        assert written == generator.generate(package, Interfaces(), kind)
    assert not (tmp_path / "srv" / "std_msgs.py").exists()


def test_command_reports_errors(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        generator.main(["--stubs", "typings", "--interfaces", "nowhere"])
    assert caught.value.code == 1
    assert "nowhere" in capsys.readouterr().err
