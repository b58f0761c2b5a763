"""Imports of the user's packages from fibws.msg, fibws.srv and fibws.action."""

import importlib
import py_compile
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import fibws.msg
from fibws.action import action_class
from fibws.errors import InterfaceError, UnknownPackage
from fibws.interfaces import Interfaces
from fibws.msg import _finder
from fibws.srv import service_class


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Let each test begin with the standard types alone."""
    monkeypatch.setattr(_finder, "_interfaces", Interfaces())
    monkeypatch.delenv("FIBWS_INTERFACES", raising=False)
    before = dict(sys.modules)
    yield
    for name, module in list(sys.modules.items()):
        parent, _, package = name.rpartition(".")
        if parent in ("fibws.msg", "fibws.srv", "fibws.action") and module is not before.get(name):
            delattr(sys.modules[parent], package)
            if name in before:
                sys.modules[name] = before[name]
                setattr(sys.modules[parent], package, before[name])
            else:
                del sys.modules[name]


def write(folder: Path, package: str, name: str, text: str, kind: str = "msg") -> Path:
    path = folder / package / kind / f"{name}.{kind}"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, "utf-8")
    return folder


def test_standard_package_is_an_ordinary_file() -> None:
    module = importlib.import_module("fibws.msg.std_msgs")
    assert module.__file__ is not None
    assert Path(module.__file__).name == "std_msgs.py"


def test_environment_variable_names_folders(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path / "a", "fibonacci", "Fibonacci", "int32 a\nother_msgs/Other other")
    write(tmp_path / "b", "other_msgs", "Other", "std_msgs/Header header")
    monkeypatch.setenv("FIBWS_INTERFACES", f"{tmp_path / 'a'}:{tmp_path / 'b'}:")
    module = importlib.import_module("fibws.msg.fibonacci")
    message = module.Fibonacci(5)
    assert message.to_dict()["a"] == 5
    assert message.to_dict()["other"]["header"]["frame_id"] == ""
    assert module.Fibonacci.from_dict(message.to_dict()) == message


def test_folder_may_be_added(tmp_path: Path) -> None:
    fibws.msg.add_folder(write(tmp_path, "fibonacci", "Fibonacci", "int32 a"))
    assert fibws.msg.message_class("fibonacci/msg/Fibonacci")._type == "fibonacci/Fibonacci"


def test_packages_may_use_types_of_each_other(tmp_path: Path) -> None:
    write(tmp_path, "this_msgs", "Outer", "that_msgs/Middle middle")
    write(tmp_path, "that_msgs", "Middle", "this_msgs/Inner inner")
    fibws.msg.add_folder(write(tmp_path, "this_msgs", "Inner", "int32 x"))
    outer = fibws.msg.message_class("this_msgs/Outer")()
    assert outer.to_dict() == {"middle": {"inner": {"x": 0}}}
    assert type(outer).from_dict(outer.to_dict()) == outer


def test_users_package_replaces_the_standard_one(tmp_path: Path) -> None:
    fibws.msg.add_folder(write(tmp_path, "turtlesim", "Pose", "float64 x"))
    sys.modules.pop("fibws.msg.turtlesim", None)
    assert fibws.msg.message_class("turtlesim/Pose")().to_dict() == {"x": 0.0}


def test_users_services_and_actions_are_importable(tmp_path: Path) -> None:
    write(tmp_path, "count_msgs", "Number", "int32 value")
    write(tmp_path, "count_msgs", "Next", "Number number\n---\nNumber next", "srv")
    write(tmp_path, "count_msgs", "Count", "int32 to\n---\nNumber last\n---\n", "action")
    fibws.msg.add_folder(tmp_path)
    number: Any = fibws.msg.message_class("count_msgs/Number")
    following = service_class("count_msgs/srv/Next")
    assert following is importlib.import_module("fibws.srv.count_msgs").Next
    assert following.Request(number(5)).to_dict() == {"number": {"value": 5}}
    assert following.Response.from_dict({"next": {"value": 6}}).next == number(6)
    count: Any = action_class("count_msgs/Count")
    assert count is importlib.import_module("fibws.action.count_msgs").Count
    assert count.Result().last == number(0)
    assert count.Result is fibws.msg.message_class("count_msgs/CountResult")


@pytest.mark.parametrize("kind", ["msg", "srv", "action"])
def test_unknown_package_is_an_import_error(kind: str) -> None:
    with pytest.raises(ModuleNotFoundError, match=r"FIBWS_INTERFACES \(not set\)") as caught:
        importlib.import_module(f"fibws.{kind}.nobodys_msgs")
    assert caught.value.name == f"fibws.{kind}.nobodys_msgs"
    assert f"hold {kind} files of nobodys_msgs" in str(caught.value)


def test_misplaced_definitions_are_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, "deep_msgs", "Field", "int32 x")
    (tmp_path / "flat_msgs").mkdir()
    (tmp_path / "flat_msgs" / "Field.msg").write_text("int32 x")
    deep = tmp_path / "deep_msgs" / "msg"
    monkeypatch.setenv("FIBWS_INTERFACES", str(deep))
    with pytest.raises(ImportError, match=re.escape(f"name {tmp_path} in place of {deep}")):
        importlib.import_module("fibws.msg.deep_msgs")
    monkeypatch.setenv("FIBWS_INTERFACES", str(tmp_path))
    flat = tmp_path / "flat_msgs"
    with pytest.raises(ImportError, match=re.escape(f"move {flat}/*.msg to {flat / 'msg'}")):
        importlib.import_module("fibws.msg.flat_msgs")


@pytest.mark.parametrize(
    ("line", "text"),
    [
        (
            "from fibws.msg.farm_msgs import Field, Catle",
            "farm_msgs/msg/Catle; did you mean Cattle?",
        ),
        ("from fibws.msg.farm_msgs import Water", "it is in fibws.srv.farm_msgs"),
        ("from fibws.msg import String", "write from fibws.msg.std_msgs import String"),
        ("from fibws.srv import SetBool", "write from fibws.srv.std_srvs import SetBool"),
        ("from fibws.action import MoveBase", "from fibws.action.move_base_msgs import MoveBase"),
        ("from fibws.msg import std_msg", "did you mean std_msgs?"),
        ("from fibws.srv.farm_msgs import WaterRequst", "did you mean WaterRequest?"),
        ("from fibws.msg.std_msgs import Sting", "std_msgs/msg/Sting; did you mean String?"),
        ("from fibws.msg.farm_msg import Field", "did you mean farm_msgs?"),
        ("from fibws.action.farm_msgs import Field", "fibws.msg and fibws.srv have it"),
    ],
)
def test_imports_of_other_names_suggest_the_right_ones(
    tmp_path: Path, line: str, text: str
) -> None:
    for name in ("Field", "Cattle"):
        write(tmp_path, "farm_msgs", name, "int32 x")
    write(tmp_path, "farm_msgs", "Water", "---", "srv")
    fibws.msg.add_folder(tmp_path)
    with pytest.raises(ImportError, match=re.escape(text)):
        exec(line)


def test_attributes_that_modules_do_not_have_are_attribute_errors(tmp_path: Path) -> None:
    write(tmp_path, "farm_msgs", "Cattle", "int32 x")
    fibws.msg.add_folder(tmp_path)
    for module, name in (("farm_msgs", "Catle"), ("std_msgs", "Sting")):
        found = importlib.import_module(f"fibws.msg.{module}")
        assert not hasattr(found, name)
        assert not hasattr(found, "__path__")
        with pytest.raises(AttributeError, match=f"has no attribute '{name}'"):
            getattr(found, name)


def test_package_without_services_has_no_srv_module(tmp_path: Path) -> None:
    fibws.msg.add_folder(write(tmp_path, "only_msgs", "Mine", "int32 x"))
    with pytest.raises(ModuleNotFoundError, match="hold srv files of only_msgs"):
        importlib.import_module("fibws.srv.only_msgs")


@pytest.mark.parametrize("find", [fibws.msg.message_class, service_class, action_class])
def test_type_of_an_unknown_package_is_unknown(find: Callable[[str], type]) -> None:
    with pytest.raises(UnknownPackage):
        find("nobodys_msgs/Mine")


def test_module_found_by_python_is_not_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "bare_msgs.py"
    source.write_text("x = 1")
    py_compile.compile(str(source), str(tmp_path / "bare_msgs.pyc"))
    source.unlink()
    monkeypatch.setattr(fibws.msg, "__path__", [*fibws.msg.__path__, str(tmp_path)])
    assert importlib.import_module("fibws.msg.bare_msgs").x == 1


def test_private_modules_are_ignored() -> None:
    with pytest.raises(ModuleNotFoundError, match=r"No module named 'fibws.msg._nothing'$"):
        importlib.import_module("fibws.msg._nothing")


def test_missing_folder_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_INTERFACES", "/nowhere")
    with pytest.raises(InterfaceError, match="/nowhere"):
        fibws.msg.default_interfaces()


def test_finder_is_installed_once() -> None:
    importlib.reload(fibws.msg)
    assert sys.meta_path.count(_finder.ModuleFinder) == 1
