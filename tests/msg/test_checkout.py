"""Imports of the standard packages' modules in a checkout, where they are not in git."""

from __future__ import annotations

import importlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import fibws
import fibws.msg
from fibws.interfaces import Interfaces, generated_modules
from fibws.interfaces.folders import KINDS, Kind
from fibws.interfaces.generator import generate
from fibws.msg import _finder

PACKAGE = Path(fibws.__file__).parent
PACKAGES = ("std_msgs", "std_srvs", "tf2_msgs", "geometry_msgs", "actionlib_msgs")
INT32 = "std_msgs/msg/Int32.msg"
CONSTANT = "from fibws.msg.std_msgs import Int32; print(Int32.LIMIT)"


class Checkout:
    """A copy of what fibws.msg needs of fibws, with few definitions and no modules."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.package = folder / "fibws"
        self.definitions = self.package / "interfaces" / "definitions"
        self.module = self.package / "msg" / "std_msgs.py"
        folder.joinpath("hatch_build.py").touch()
        self._copy("*.py*", *(f"{name}/_*.py" for name in ("msg", "srv", "action")))
        self._copy("interfaces/*.py", *(f"interfaces/definitions/{name}/*/*" for name in PACKAGES))

    def _copy(self, *patterns: str) -> None:
        for pattern in patterns:
            for path in PACKAGE.glob(pattern):
                copy = self.package / path.relative_to(PACKAGE)
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(path, copy)

    def define(self, text: str, name: str = INT32) -> None:
        self.definitions.joinpath(name).write_text(text)

    def start(self, program: str) -> subprocess.Popen[str]:
        """Start a Python that imports fibws from here, and caches bytecode."""
        env = {**os.environ, "PYTHONPATH": str(self.folder)}
        env.pop("PYTHONDONTWRITEBYTECODE", None)
        # pytest-cov would measure this copy of fibws, too.
        env = {name: value for name, value in env.items() if not name.startswith("COV_")}
        return subprocess.Popen(
            [sys.executable, "-c", program],
            cwd=self.folder,
            env=env,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def run(self, program: str) -> str:
        """Return what a Python prints; its last line of standard error if it fails."""
        process = self.start(program)
        output, errors = process.communicate(timeout=60)
        return output.strip() if process.returncode == 0 else errors.strip().splitlines()[-1]


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    return Checkout(tmp_path)


@pytest.mark.parametrize(
    ("kind", "package", "name"),
    [("msg", "std_msgs", "Int32"), ("srv", "std_srvs", "Empty"), ("action", "tf2_msgs", "*")],
)
@pytest.mark.long
def test_missing_module_is_written(checkout: Checkout, kind: Kind, package: str, name: str) -> None:
    program = f"from fibws.{kind}.{package} import {name}; import fibws.{kind}.{package} as module"
    module = checkout.package / kind / f"{package}.py"
    assert checkout.run(f"{program}\nprint(module.__file__)") == str(module)
    assert module.read_text() == generate(package, Interfaces(), kind)


def test_module_follows_its_definition(checkout: Checkout) -> None:
    for limit in range(3):  # The module's size stays the same, and perhaps the second.
        checkout.define(f"int32 LIMIT={limit}\nint32 data")
        assert checkout.run(CONSTANT) == str(limit)
    checkout.define("", "std_msgs/msg/Fibonacci.msg")
    assert checkout.run("from fibws.msg.std_msgs import Fibonacci") == ""
    checkout.definitions.joinpath("std_msgs/msg/Fibonacci.msg").unlink()
    assert "ImportError" in checkout.run("from fibws.msg.std_msgs import Fibonacci")


def test_messages_follow_the_definition_of_an_action(checkout: Checkout) -> None:
    program = "from fibws.msg.tf2_msgs import LookupTransformGoal as Goal; print(Goal.LIMIT)"
    for limit in range(2):
        checkout.define(
            f"int32 LIMIT={limit}\n---\n---\n", "tf2_msgs/action/LookupTransform.action"
        )
        assert checkout.run(program) == str(limit)


def test_module_follows_the_generator(checkout: Checkout) -> None:
    checkout.run("import fibws.msg.std_msgs")
    generator = checkout.package / "interfaces" / "generator.py"
    imported = "import fibws.interfaces as ros"
    generator.write_text(generator.read_text().replace(imported, f"{imported}  #"))
    checkout.run("import fibws.msg.std_msgs")
    assert "as ros  #" in checkout.module.read_text()


def test_current_module_is_not_written_again(checkout: Checkout) -> None:
    checkout.run("import fibws.msg.std_msgs")
    before = checkout.module.stat()
    checkout.run("import fibws.msg.std_msgs")
    assert checkout.module.stat() == before


def test_module_of_an_installed_package_is_never_written(checkout: Checkout) -> None:
    checkout.define("int32 LIMIT=1")
    checkout.run("import fibws.msg.std_msgs")
    checkout.folder.joinpath("hatch_build.py").unlink()
    checkout.define("int32 LIMIT=2")
    assert checkout.run(CONSTANT) == "1"


def test_module_of_a_removed_package_is_unknown(checkout: Checkout) -> None:
    checkout.run("import fibws.srv.std_srvs")
    shutil.rmtree(checkout.definitions / "std_srvs")
    assert "ModuleNotFoundError" in checkout.run("import fibws.srv.std_srvs")


def test_invalid_definition_is_named(checkout: Checkout) -> None:
    checkout.define("int32 data\nint33 more")
    error = checkout.run("import fibws.msg.std_msgs")
    assert "Int32.msg" in error and "int33" in error


def test_several_processes_may_write_a_module(checkout: Checkout) -> None:
    checkout.define("int32 LIMIT=1")
    processes = [checkout.start(CONSTANT) for _ in range(4)]
    assert [process.communicate(timeout=60) for process in processes] == [("1\n", "")] * 4
    written = {path.name for path in checkout.module.parent.iterdir()} - {"__pycache__"}
    assert written == {"__init__.py", "_finder.py", "std_msgs.py"}


def test_command_writes_all_modules_and_removes_old_ones(checkout: Checkout) -> None:
    old, mine = (checkout.package / "srv" / f"{name}.py" for name in ("old_msgs", "mine"))
    old.write_text(f'"""The services of old_msgs, {generated_modules.GENERATED}"""\n')
    mine.touch()
    checkout.run("from fibws.interfaces.generator import main; main([])")
    assert mine.exists() and not old.exists()
    assert checkout.module.exists()
    assert (checkout.package / "srv" / "std_srvs.py").exists()
    assert (checkout.package / "action" / "tf2_msgs.py").exists()


def test_module_is_imported_without_a_file_if_the_checkout_is_read_only(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(package: str, kind: str) -> None:
        raise PermissionError

    before = importlib.import_module("fibws.msg.std_msgs")
    monkeypatch.setattr(_finder, "_is_outdated", lambda *_: True)
    monkeypatch.setattr(generated_modules, "write_module", fail)
    monkeypatch.delitem(sys.modules, "fibws.msg.std_msgs")
    monkeypatch.setattr(fibws.msg, "std_msgs", before, raising=False)
    module = importlib.import_module("fibws.msg.std_msgs")
    assert module is not before
    assert getattr(module, "__file__", None) is None
    assert module.Int32(5).to_dict() == {"data": 5}


@pytest.mark.parametrize("kind", KINDS)
def test_modules_of_this_checkout_are_current(kind: Kind) -> None:
    interfaces = Interfaces()
    for package in interfaces.packages():
        if interfaces.types(package, kind):
            importlib.import_module(f"fibws.{kind}.{package}")
            assert generated_modules.is_current(package, kind)
            text = Path(generated_modules.path(package, kind)).read_text("utf-8")
            assert text == generate(package, interfaces, kind)
