"""New packages, compared with those of catkin_create_pkg."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

from fibws.ros1.errors import WorkspaceError
from fibws.ros1.workspace.new_package import EXTRAS, NewPackage
from fibws.ros1.workspace.package_xml import read_manifest

from .conftest import Layout


def refused(package: NewPackage, where: Path) -> str:
    with pytest.raises(WorkspaceError) as error:
        package.create(where)
    return str(error.value)


def test_new_package_has_two_files_and_src(layout: Layout) -> None:
    made = NewPackage("fibonacci", ["std_msgs", "rospy"]).create(layout.source)
    assert made == [
        "file fibonacci/package.xml",
        "file fibonacci/CMakeLists.txt",
        "folder fibonacci/src",
    ]
    manifest = read_manifest(layout.source / "fibonacci")
    assert (manifest.name, manifest.format, manifest.version) == ("fibonacci", 2, "0.0.0")
    assert manifest.direct == ["rospy", "std_msgs"]
    assert layout.warnings() == []


def test_example_program_builds_once_it_is_uncommented(layout: Layout) -> None:
    NewPackage("a", ["rospy"]).create(layout.source)
    cmake = layout.source / "a" / "CMakeLists.txt"
    text = cmake.read_text()
    assert "# catkin_install_python(PROGRAMS\n#   src/a_node.py\n" in text
    (layout.source / "a" / "src" / "a_node.py").write_text("#!/usr/bin/env python3\n")
    (layout.source / "a" / "src" / "a_node.py").chmod(0o755)
    begin = text.index("# catkin_install_python")
    end = text.index("# )", begin) + 3
    active = text[begin:end].replace("# ", "", 1).replace("\n# ", "\n")
    cmake.write_text(text[:begin] + active + text[end:])
    assert layout.warnings() == []
    assert "lib/a/a_node.py" in layout.built()


@pytest.mark.parametrize("extra", [*([each] for each in EXTRAS), list(EXTRAS)])
def test_examples_build_at_once(layout: Layout, extra: list[str]) -> None:
    NewPackage("a", ["rospy", "std_msgs"], extras=extra).create(layout.source)
    assert layout.warnings() == []
    for name in extra:
        assert (layout.source / "a" / name).is_dir()
    kinds = {"msg", "srv", "action"} & set(extra)
    assert {path.parent.name for path in layout.devel.glob("share/a/*/*")} == kinds


def test_messages_build_without_other_packages(layout: Layout) -> None:
    NewPackage("a", extras=["msg"]).create(layout.source)
    assert layout.warnings() == []


def test_metapackage_depends_on_its_packages(layout: Layout) -> None:
    made = NewPackage("all", ["rospy", "std_msgs"], meta=True).create(layout.source)
    assert made == ["file all/package.xml", "file all/CMakeLists.txt"]
    manifest = read_manifest(layout.source / "all")
    assert manifest.is_metapackage and manifest.needs("exec") == ["rospy", "std_msgs"]
    assert layout.warnings() == []


def test_special_characters_are_escaped(layout: Layout) -> None:
    NewPackage(
        "a",
        description="x < y & z",
        licenses=["B&D"],
        authors=["A <a@b.cd>", "Only & Name"],
        maintainers=['"Q" <q@r.st>'],
        version="1.2.3",
    ).create(layout.source)
    manifest = read_manifest(layout.source / "a")
    assert manifest.description == "x < y & z"
    assert manifest.licenses == ("B&D",)
    assert [(each.name, each.email) for each in manifest.maintainers] == [('"Q"', "q@r.st")]


@pytest.mark.parametrize("name", ["a b", "a/b", "", "-a", "../a", "é"])
def test_invalid_name_is_an_error(layout: Layout, name: str) -> None:
    assert f"invalid name {name!r}" in refused(NewPackage(name), layout.source)
    assert not list(layout.source.iterdir())


def test_existing_files_are_not_overwritten(layout: Layout) -> None:
    folder = layout.package("a")
    before = (folder / "package.xml").read_text()
    assert str(folder / "package.xml") in refused(NewPackage("a"), layout.source)
    assert (folder / "package.xml").read_text() == before
    (layout.source / "b").touch()
    assert str(layout.source / "b") in refused(NewPackage("b"), layout.source)


def test_package_inside_a_package_is_an_error(layout: Layout) -> None:
    folder = layout.package("a", files={"src/x.py": ""})
    text = refused(NewPackage("b"), folder / "src")
    assert "inside package a" in text and text.endswith(f"cd {layout.source}")


def test_invalid_dependencies_and_versions_are_errors(layout: Layout) -> None:
    assert "'std msgs'" in refused(NewPackage("a", ["std msgs"]), layout.source)
    assert "itself" in refused(NewPackage("a", ["a"]), layout.source)
    assert "'1'" in refused(NewPackage("a", version="1"), layout.source)


@pytest.mark.parametrize(
    "depends",
    [
        ["std_msgs", "rospy"],
        ["roscpp", "rospy", "std_msgs"],
        ["rospy", "message_generation"],
        ["rospy", "message_generation", "message_runtime"],
    ],
)
def test_catkin_create_pkg_creates_the_same(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], depends: list[str]
) -> None:
    from catkin_pkg.cli import create_pkg

    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    ours.mkdir()
    theirs.mkdir()
    created = NewPackage("fibonacci", depends).create(ours)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        create_pkg.main(["fibonacci", *depends, "--rosdistro", "noetic"], str(theirs))
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("Created")]
    assert [line.split("/")[-1] for line in lines] == [each.split("/")[-1] for each in created]
    left, right = (read_manifest(each / "fibonacci") for each in (ours, theirs))
    for kind in ("build", "build_export", "exec"):
        assert sorted(left.needs(kind)) == sorted(right.needs(kind)), kind


def test_catkin_pkg_reads_new_packages(tmp_path: Path) -> None:
    from catkin_pkg.package import parse_package

    NewPackage("a", ["rospy"], ["boost"], extras=list(EXTRAS)).create(tmp_path)
    NewPackage("b", ["rospy"], meta=True).create(tmp_path)
    found: list[str] = []
    for name in ("a", "b"):
        parse_package(str(tmp_path / name), found).validate(found)
    assert found == []
