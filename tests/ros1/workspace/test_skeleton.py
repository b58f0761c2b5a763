"""The first files of a package, and what the real catkin_create_pkg makes."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from fibws.errors import WorkspaceError
from fibws.ros1.workspace.manifest import read_manifest
from fibws.ros1.workspace.skeleton import EXTRAS, Skeleton

from .conftest import Layout
from .real import needs_catkin_pkg


def refused(skeleton: Skeleton, where: Path) -> str:
    with pytest.raises(WorkspaceError) as error:
        skeleton.create(where)
    return str(error.value)


def test_a_package_has_its_two_files_and_src(layout: Layout) -> None:
    made = Skeleton("fibonacci", ["std_msgs", "rospy"]).create(layout.source)
    assert made == [
        "file fibonacci/package.xml",
        "file fibonacci/CMakeLists.txt",
        "folder fibonacci/src",
    ]
    manifest = read_manifest(layout.source / "fibonacci")
    assert (manifest.name, manifest.format, manifest.version) == ("fibonacci", 2, "0.0.0")
    assert manifest.direct == ["rospy", "std_msgs"]
    assert layout.warnings() == []


def test_the_lines_that_learners_need_are_there_as_comments(layout: Layout) -> None:
    Skeleton("a", ["rospy"]).create(layout.source)
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
def test_what_it_begins_with_builds_at_once(layout: Layout, extra: list[str]) -> None:
    Skeleton("a", ["rospy", "std_msgs"], extras=extra).create(layout.source)
    assert layout.warnings() == []
    for name in extra:
        assert (layout.source / "a" / name).is_dir()
    kinds = {"msg", "srv", "action"} & set(extra)
    assert {path.parent.name for path in layout.devel.glob("share/a/*/*")} == kinds


def test_messages_build_without_other_packages(layout: Layout) -> None:
    Skeleton("a", extras=["msg"]).create(layout.source)
    assert layout.warnings() == []


def test_a_metapackage_names_others(layout: Layout) -> None:
    made = Skeleton("all", ["rospy", "std_msgs"], meta=True).create(layout.source)
    assert made == ["file all/package.xml", "file all/CMakeLists.txt"]
    manifest = read_manifest(layout.source / "all")
    assert manifest.is_metapackage and set(manifest.exec) == {"rospy", "std_msgs"}
    assert layout.warnings() == []


def test_what_is_written_is_escaped(layout: Layout) -> None:
    Skeleton(
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
def test_a_bad_name_is_refused(layout: Layout, name: str) -> None:
    assert "the name of a package has letters, digits" in refused(Skeleton(name), layout.source)
    assert not list(layout.source.iterdir())


def test_what_is_there_is_left_alone(layout: Layout) -> None:
    folder = layout.package("a")
    before = (folder / "package.xml").read_text()
    assert refused(Skeleton("a"), layout.source) == f"File exists: {folder / 'package.xml'}"
    assert (folder / "package.xml").read_text() == before
    (layout.source / "b").touch()
    assert refused(Skeleton("b"), layout.source) == f"File exists: {layout.source / 'b'}"


def test_a_package_within_a_package_is_refused(layout: Layout) -> None:
    folder = layout.package("a", files={"src/x.py": ""})
    text = refused(Skeleton("b"), folder / "src")
    assert text.endswith(
        f"is in the package a, and none is looked for in there: cd {layout.source}"
    )


def test_what_it_depends_on_has_a_name(layout: Layout) -> None:
    assert "'std msgs' is not the name of" in refused(Skeleton("a", ["std msgs"]), layout.source)
    assert refused(Skeleton("a", ["a"]), layout.source) == "a cannot depend on itself"
    assert "of the form 1.2.3" in refused(Skeleton("a", version="1"), layout.source)


@needs_catkin_pkg
@pytest.mark.parametrize(
    "depends",
    [
        ["std_msgs", "rospy"],
        ["roscpp", "rospy", "std_msgs"],
        ["rospy", "message_generation"],
        ["rospy", "message_generation", "message_runtime"],
    ],
)
def test_catkin_create_pkg_makes_the_same(tmp_path: Path, depends: list[str]) -> None:
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    ours.mkdir()
    theirs.mkdir()
    made = Skeleton("fibonacci", depends).create(ours)
    words = ["/usr/bin/catkin_create_pkg", "fibonacci", *depends]
    done = subprocess.run(words, cwd=theirs, capture_output=True, text=True, check=True)
    said = [line.removeprefix("Created ") for line in done.stdout.splitlines()[:-1]]
    assert made == said
    left, right = (read_manifest(each / "fibonacci") for each in (ours, theirs))
    for part in ("build", "exec", "exported"):
        assert getattr(left, part).keys() == getattr(right, part).keys(), part


@needs_catkin_pkg
def test_catkin_reads_what_is_made(tmp_path: Path) -> None:
    Skeleton("a", ["rospy"], ["boost"], extras=list(EXTRAS)).create(tmp_path)
    Skeleton("b", ["rospy"], meta=True).create(tmp_path)
    program = (
        "import sys; from catkin_pkg.package import parse_package\n"
        "for path in sys.argv[1:]: warnings = []; p = parse_package(path, warnings);"
        "p.validate(); print(p.name, warnings)"
    )
    words = ["/usr/bin/python3", "-c", program, str(tmp_path / "a"), str(tmp_path / "b")]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.stdout == "a []\nb []\n", done.stderr
