"""setup.py, read and not run."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.errors import PackageFileError
from fibws.ros1.workspace.python_setup import PythonSetup, read_setup


def read(folder: Path, text: str) -> PythonSetup:
    (folder / "setup.py").write_text(text)
    for name in ("src/a/b", "lib/c"):
        (folder / name).mkdir(parents=True, exist_ok=True)
        (folder / name / "__init__.py").touch()
    (folder / "src" / "a" / "__init__.py").touch()
    (folder / "src" / "one.py").touch()
    return read_setup(folder)


def test_packages_are_found_by_their_folders(tmp_path: Path) -> None:
    text = "setup(packages=['a', 'a.b', 'c'], package_dir={'': 'src', 'c': 'lib/c'})"
    assert read(tmp_path, text).packages == {
        "a": tmp_path / "src" / "a",
        "c": tmp_path / "lib" / "c",
    }


def test_the_names_may_be_looked_for(tmp_path: Path) -> None:
    text = "import setuptools\nsetuptools.setup(package_dir={'': 'src'}, packages="
    for words in ("'src'", "where='src'"):
        found = read(tmp_path, f"{text}setuptools.find_packages({words}))")
        assert list(found.packages) == ["a"]


def test_single_modules_and_scripts_are_read(tmp_path: Path) -> None:
    text = (
        "d = generate_distutils_setup(py_modules=['one'], package_dir={'': 'src'}, scripts=['x'])"
    )
    setup = read(tmp_path, text)
    assert setup.modules == {"one": tmp_path / "src" / "one.py"}
    assert setup.scripts == ("x",)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("setup(", "line 1: this is not Python"),
        ("\nsetup(packages=names)", "line 2: packages is to be written out here"),
        ("setup(packages='a')", "line 1: packages is to be written out here"),
        ("setup(package_dir=['src'])", "line 1: package_dir is to be written out here"),
        ("setup(packages=['../x'])", r"line 1: '\.\./x' is not the name of a module"),
        ("setup(py_modules=[''])", "line 1: '' is not the name of a module"),
        ("setup(packages={['a']})", "line 1: packages is to be written out here"),
        ("setup(packages=['x'])", "line 1: there is no folder x for x"),
        ("setup(packages=['x'], package_dir={'': '/y'})", "line 1: there is no folder /y/x for x"),
        ("setup(py_modules=['x'])", r"line 1: there is no x\.py in"),
    ],
)
def test_what_cannot_be_read_is_told_with_its_line(tmp_path: Path, text: str, fault: str) -> None:
    with pytest.raises(PackageFileError, match=fault):
        read(tmp_path, text)


def test_nothing_in_it_is_run(tmp_path: Path) -> None:
    read(tmp_path, "open('made', 'w')\nraise SystemExit\nsetup()")
    assert not (tmp_path / "made").exists()
