"""setup.py, which is parsed and not run."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.ros1.errors import PackageFileError
from fibws.ros1.workspace.python_setup import PythonSetup, read_setup


def read(folder: Path, text: str) -> PythonSetup:
    (folder / "setup.py").write_text(text)
    for name in ("src/a/b", "lib/c"):
        (folder / name).mkdir(parents=True, exist_ok=True)
        (folder / name / "__init__.py").touch()
    (folder / "src" / "a" / "__init__.py").touch()
    (folder / "src" / "one.py").touch()
    return read_setup(folder)


def test_packages_have_folders(tmp_path: Path) -> None:
    text = "setup(packages=['a', 'a.b', 'c'], package_dir={'': 'src', 'c': 'lib/c'})"
    assert read(tmp_path, text).packages == {
        "a": tmp_path / "src" / "a",
        "c": tmp_path / "lib" / "c",
    }


def test_find_packages_lists_the_packages(tmp_path: Path) -> None:
    text = "import setuptools\nsetuptools.setup(package_dir={'': 'src'}, packages="
    for words in ("'src'", "where='src'"):
        found = read(tmp_path, f"{text}setuptools.find_packages({words}))")
        assert list(found.packages) == ["a"]


def test_single_modules_are_read(tmp_path: Path) -> None:
    text = (
        "d = generate_distutils_setup(py_modules=['one'], package_dir={'': 'src'}, scripts=['x'])"
    )
    setup = read(tmp_path, text)
    assert setup.modules == {"one": tmp_path / "src" / "one.py"}


def test_settings_may_be_set_as_items(tmp_path: Path) -> None:
    text = (
        "d = generate_distutils_setup()\nd['packages'] = ['a']\nd['package_dir'] = {'': 'src'}\n"
        "d['scripts'] = names\nsetup(**d)"
    )
    assert list(read(tmp_path, text).packages) == ["a"]


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("setup(", "line 1: invalid Python"),
        ("\nsetup(packages=names)", "line 2: packages must be a literal"),
        ("setup(packages='a')", "line 1: packages must be a literal"),
        ("setup(package_dir=['src'])", "line 1: package_dir must be a literal"),
        ("setup(packages=['../x'])", r"line 1: invalid module name '\.\./x'"),
        ("setup(py_modules=[''])", "line 1: invalid module name ''"),
        ("setup(packages={['a']})", "line 1: packages must be a literal"),
        ("setup(py_modules=['x'])", r"line 1: x\.py not found in"),
    ],
)
def test_errors_have_their_line(tmp_path: Path, text: str, error: str) -> None:
    with pytest.raises(PackageFileError, match=error):
        read(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "warning"),
    [
        ("setup(packages=['x'])", "line 1: folder x of module x not found"),
        ("setup(packages=['x', 'x.y'], package_dir={'': '/y'})", "folder /y/x of module x not"),
    ],
)
def test_missing_folder_gives_a_warning(tmp_path: Path, text: str, warning: str) -> None:
    setup = read(tmp_path, text)
    (found,) = setup.warnings
    assert warning in found
    assert setup.packages == {}


def test_setup_py_is_not_run(tmp_path: Path) -> None:
    read(tmp_path, "open('made', 'w')\nraise SystemExit\nsetup()")
    assert not (tmp_path / "made").exists()
