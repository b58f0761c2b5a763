"""package.xml, and what the real catkin_pkg says of the same files."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from fibws.errors import PackageFileError
from fibws.ros1.workspace.manifest import read_manifest, read_name

from .conftest import manifest_of
from .real import needs_catkin_pkg

GOOD = {
    "plain": manifest_of("a", "rospy"),
    "format 1": manifest_of("a")
    .replace(' format="2"', "")
    .replace("</package>", "<build_depend>b</build_depend><run_depend>c</run_depend></package>"),
    "format 3": manifest_of("a", text='<depend condition="$ROS_VERSION == 2">b</depend>').replace(
        'format="2"', 'format="3"'
    ),
    "depend": manifest_of("a", text="<depend>b</depend><depend>c</depend>"),
    "versions": manifest_of("a", text='<depend version_gte="1.0.0">b</depend>'),
    "metapackage": manifest_of("a", text="<export><metapackage/></export>"),
    "comment": manifest_of("a", text="<!-- <depend>b</depend> -->"),
}
BAD = {
    "no name": (manifest_of("a").replace("<name>a</name>", ""), "line 2: <name> is missing"),
    "two names": (manifest_of("a", text="<name>b</name>"), "line 9: there is a second <name>"),
    "bad name": (manifest_of("a b"), "line 3: the name of a package has letters, digits"),
    "bad version": (manifest_of("a").replace("1.2.3", "1.2"), "line 4: the version is not of the"),
    "no licence": (
        manifest_of("a").replace("<license>BSD</license>", ""),
        "line 2: <license> is missing",
    ),
    "empty licence": (manifest_of("a").replace("BSD", ""), "line 7: <license> is empty"),
    "no maintainer": (
        manifest_of("a").replace('<maintainer email="jane@example.com">Jane</maintainer>', ""),
        "line 2: <maintainer> is missing",
    ),
    "no email": (
        manifest_of("a").replace(' email="jane@example.com"', ""),
        "line 6: <maintainer> has no email",
    ),
    "bad email": (
        manifest_of("a").replace("jane@", "jane"),
        "line 6: 'janeexample.com' is no email",
    ),
    "unknown tag": (
        manifest_of("a", text="<buld_depend>b</buld_depend>"),
        "line 9: a manifest has no <buld_depend>; did you mean <build_depend>?",
    ),
    "of format 1": (
        manifest_of("a", text="<run_depend>b</run_depend>"),
        'line 9: format 2 has no <run_depend>: write <exec_depend>, or <package format="1">',
    ),
    "of format 2": (
        manifest_of("a", text="<depend>b</depend>").replace(' format="2"', ""),
        'line 9: <depend> came with format 2: write <package format="2">',
    ),
    "itself": (manifest_of("a", "a"), "line 9: the package cannot depend on itself"),
    "redundant": (
        manifest_of("a", "b", text="<depend>b</depend>"),
        "line 9: <depend>b</depend> has said this already: leave <build_depend> out",
    ),
    "format 4": (manifest_of("a").replace('"2"', '"4"'), "line 2: the formats are 1, 2 and 3"),
    "other root": ("<?xml version='1.0'?><robot/>", "line 1: <package> is the root of a manifest"),
}


def write(folder: Path, text: str) -> Path:
    (folder / "package.xml").write_text(text)
    return folder


def test_a_manifest_says_what_a_package_is(tmp_path: Path) -> None:
    manifest = read_manifest(write(tmp_path, manifest_of("fibonacci", "rospy", "std_msgs")))
    assert (manifest.name, manifest.version) == ("fibonacci", "1.2.3")
    assert manifest.maintainers[0].email == "jane@example.com"
    assert manifest.build == {"std_msgs": 11, "rospy": 9, "catkin": 8}
    assert manifest.exec == {"std_msgs": 12, "rospy": 10}
    assert manifest.direct == ["rospy", "std_msgs"]
    assert manifest.line == 3


@pytest.mark.parametrize("case", GOOD)
def test_a_good_manifest_is_read(tmp_path: Path, case: str) -> None:
    assert read_manifest(write(tmp_path, GOOD[case])).name == "a"


def test_a_dependency_whose_condition_is_not_met_is_none(tmp_path: Path) -> None:
    assert read_manifest(write(tmp_path, GOOD["format 3"])).direct == []


def test_depend_stands_for_all_three(tmp_path: Path) -> None:
    manifest = read_manifest(write(tmp_path, GOOD["depend"]))
    assert {"b", "c"} <= manifest.build.keys() & manifest.exec.keys() & manifest.exported.keys()


@pytest.mark.parametrize("case", BAD)
def test_a_bad_manifest_is_told_with_its_line(tmp_path: Path, case: str) -> None:
    text, fault = BAD[case]
    with pytest.raises(PackageFileError) as error:
        read_manifest(write(tmp_path, text))
    assert fault in str(error.value)


def test_a_name_against_the_conventions_is_warned_of(tmp_path: Path) -> None:
    manifest = read_manifest(write(tmp_path, manifest_of("BigRobot")))
    assert "line 3: by convention a package's name is in lower case" in manifest.warnings[0]


def test_the_name_is_read_though_the_rest_is_broken(tmp_path: Path) -> None:
    write(tmp_path, "<package><!-- <name>x</name> --><name> a </name><oops>")
    assert read_name(tmp_path) == "a"
    write(tmp_path, "<package>")
    assert read_name(tmp_path) == tmp_path.name


@needs_catkin_pkg
def test_catkin_refuses_what_is_refused_here(tmp_path: Path) -> None:
    cases = {**GOOD, **{name: text for name, (text, _) in BAD.items()}}
    program = """
import json, sys
from catkin_pkg.package import parse_package_string
verdicts = {}
for name, text in json.load(sys.stdin).items():
    try:
        package = parse_package_string(text, warnings=[])
        package.evaluate_conditions({"ROS_VERSION": "1"})
        groups = package.build_depends + package.build_export_depends + package.exec_depends
        verdicts[name] = sorted({d.name for d in groups if d.evaluated_condition})
    except Exception:
        verdicts[name] = None
print(json.dumps(verdicts))
"""
    words = ["/usr/bin/python3", "-c", program]
    done = subprocess.run(
        words, input=json.dumps(cases), capture_output=True, text=True, check=True
    )
    theirs = json.loads(done.stdout)
    ours: dict[str, list[str] | None] = {}
    for name, text in cases.items():
        try:
            ours[name] = sorted(read_manifest(write(tmp_path, text)).direct)
        except PackageFileError:
            ours[name] = None
    assert ours == theirs
