"""package.xml, and what catkin_pkg reads from the same texts."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import pytest

from fibws.ros1.errors import PackageFileError
from fibws.ros1.workspace.package_xml import Manifest, evaluate_condition, read_manifest, read_name

from .conftest import manifest_of

ROS_1 = {"ROS_VERSION": "1", "ROS_DISTRO": "noetic", "ROS_PYTHON_VERSION": "3"}


def format_1(text: str = "") -> str:
    return manifest_of("a", text=text).replace(' format="2"', "")


def format_2(text: str = "") -> str:
    return manifest_of("a", text=text)


def format_3(text: str = "") -> str:
    return manifest_of("a", text=text).replace('format="2"', 'format="3"')


def without(text: str, part: str, replacement: str = "") -> str:
    assert part in text
    return text.replace(part, replacement)


MAINTAINER = '<maintainer email="jane@example.com">Jane</maintainer>'
VALID = {
    "format 1": format_1("<build_depend>b</build_depend><run_depend>c</run_depend>"),
    "format 1, explicit": format_1("<run_depend>c</run_depend>").replace(
        "<package>", '<package format="1">'
    ),
    "format 2": format_2("<build_depend>b</build_depend><exec_depend>c</exec_depend>"),
    "format 3": format_3("<depend>b</depend>"),
    "depend": format_2("<depend>b</depend><depend>c</depend>"),
    "all kinds": format_2(
        "<build_export_depend>b</build_export_depend><doc_depend>c</doc_depend>"
        "<buildtool_export_depend>d</buildtool_export_depend><test_depend>e</test_depend>"
        "<conflict>f</conflict><replace>g</replace>"
    ),
    "the same test dependency in format 2": format_2(
        "<depend>b</depend><test_depend>b</test_depend>"
    ),
    "versions": format_2('<depend version_gte="1.0.0">b</depend>'),
    "other versions": format_2(
        '<depend version_gte="1.0.0">b</depend><build_depend>b</build_depend>'
    ),
    "conditions": format_3(
        '<depend condition="$ROS_VERSION == 2">b</depend>'
        '<depend condition="$ROS_VERSION == 1">c</depend>'
        "<exec_depend condition=\"$ROS_PYTHON_VERSION == '3' and $ROS_DISTRO != melodic\">d"
        "</exec_depend>"
        '<build_depend condition="$NONE == 1 or ($ROS_DISTRO &gt;= noetic)">e</build_depend>'
    ),
    "one of two conditions": format_3(
        '<depend condition="$ROS_VERSION == 2">b</depend>'
        '<depend condition="$ROS_VERSION != 2">b</depend>'
    ),
    "groups": format_3(
        "<group_depend>g</group_depend><member_of_group>h</member_of_group>"
        '<group_depend condition="$ROS_VERSION == 2">i</group_depend>'
    ),
    "metapackage": format_2("<exec_depend>b</exec_depend><export><metapackage/></export>"),
    "exports": format_3(
        "<export><build_type>cmake</build_type><x><y/></x>"
        '<only condition="$ROS_VERSION == 2">z</only><nodelet plugin="${prefix}/n.xml"/></export>'
    ),
    "deprecated": format_2("<export><deprecated>Use b.</deprecated></export>"),
    "comments": format_2("<!-- <depend>b</depend> --><depend>c<!-- d --></depend>"),
    "people": format_2(
        '<maintainer email="joe.doe+ros@mail.example.org">Joe Doe</maintainer>'
        '<author>Ann</author><author email="bob@example.com">Bob</author>'
    ),
    "licenses": format_2("<license>MIT</license><license>Apache License 2.0</license>"),
    "license file": format_3('<license file="LICENSE">MIT</license>'),
    "urls": format_2('<url type="website">http://example.com</url><url>http://b.example</url>'),
    "description in HTML": without(
        format_2(), "The a package", "<p>Reads &lt;b&gt;<br/> and <b>writes</b>.</p>"
    ),
    "description of one element": without(format_2(), "The a package", "<br/>"),
    "compatibility": without(format_2(), "<version>", '<version compatibility="1.0.0">'),
    "blanks": without(format_2("<depend>\n  b\n</depend>"), "<name>a", "<name> a "),
    "upper case": without(format_2(), "<name>a", "<name>BigRobot"),
    "dashes": without(format_2(), "<name>a", "<name>my-robot"),
    "schema": without(
        format_2(), "<package", '<?xml-model href="http://x/package_format2.xsd"?>\n<package'
    ),
    "namespace": without(format_2(), "<package ", '<package xmlns:xsi="http://x" xsi:y="z" '),
}
INVALID = {
    "no name": (without(format_2(), "<name>a</name>"), 2),
    "two names": (format_2("<name>b</name>"), 9),
    "empty name": (without(format_2(), "<name>a</name>", "<name/>"), 3),
    "bad name": (without(format_2(), "<name>a", "<name>a b"), 3),
    "name with an underscore first": (without(format_2(), "<name>a", "<name>_a"), 3),
    "bad version": (without(format_2(), "1.2.3", "1.2"), 4),
    "version with a letter": (without(format_2(), "1.2.3", "1.2.3a"), 4),
    "no version": (without(format_2(), "<version>1.2.3</version>"), 2),
    "empty description": (without(format_2(), "The a package"), 5),
    "no license": (without(format_2(), "<license>BSD</license>"), 2),
    "empty license": (without(format_2(), "BSD"), 7),
    "no maintainer": (without(format_2(), MAINTAINER), 2),
    "no email": (without(format_2(), ' email="jane@example.com"'), 6),
    "bad email": (without(format_2(), "jane@", "jane"), 6),
    "email without a domain": (without(format_2(), "example.com", "localhost"), 6),
    "bad email of an author": (format_2('<author email="x">X</author>'), 9),
    "unknown element": (format_2("<buld_depend>b</buld_depend>"), 9),
    "run_depend in format 2": (format_2("<run_depend>b</run_depend>"), 9),
    "exec_depend in format 1": (format_1("<exec_depend>b</exec_depend>"), 9),
    "depend in format 1": (format_1("<depend>b</depend>"), 9),
    "group_depend in format 2": (format_2("<group_depend>g</group_depend>"), 9),
    "condition in format 2": (format_2('<depend condition="1 == 1">b</depend>'), 9),
    "license file in format 2": (without(format_2(), "<license>", '<license file="L">'), 7),
    "unknown attribute": (format_2('<depend verson_gte="1.0.0">b</depend>'), 9),
    "attribute of the root": (without(format_2(), "<package", '<package name="a"'), 2),
    "element inside an element": (format_2("<depend><b/>c</depend>"), 9),
    "two exports": (format_2("<export/>\n<export/>"), 10),
    "itself": (format_2("<build_depend>a</build_depend>"), 9),
    "itself in tests": (format_2("<test_depend>a</test_depend>"), 9),
    "redundant": (format_2("<build_depend>b</build_depend><depend>b</depend>"), 9),
    "redundant test": (
        format_1("<run_depend>b</run_depend>\n<test_depend>b</test_depend>"),
        10,
    ),
    "member of the group it needs": (
        format_3("<group_depend>g</group_depend><member_of_group>g</member_of_group>"),
        9,
    ),
    "condition without an operator": (format_3('<depend condition="$A">b</depend>'), 9),
    "condition with a dot": (format_3('<depend condition="$A == 1.0">b</depend>'), 9),
    "unfinished condition": (format_3('<depend condition="$A == 1 and">b</depend>'), 9),
    "open parenthesis": (format_3('<depend condition="($A == 1">b</depend>'), 9),
    "format 4": (without(format_2(), '"2"', '"4"'), 2),
    "format x": (without(format_2(), '"2"', '"x"'), 2),
    "other root": ("<?xml version='1.0'?><robot/>", 1),
    "empty": ("", 1),
    "not XML": (format_2("<oops>"), 9),
}


def write(folder: Path, text: str) -> Path:
    (folder / "package.xml").write_text(text)
    return folder


def catkin_pkg_reads(text: str) -> Any:
    """Return the package that catkin_pkg reads, with its conditions evaluated."""
    from catkin_pkg.package import parse_package_string

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        package = parse_package_string(text, warnings=[])
        package.evaluate_conditions(ROS_1)
    return package


@pytest.fixture(autouse=True)
def ros_1(monkeypatch: pytest.MonkeyPatch) -> None:
    """The variables that conditions depend on."""
    for name in ROS_1:
        monkeypatch.delenv(name, raising=False)


@pytest.mark.parametrize("case", VALID)
def test_valid_manifest_is_read_as_catkin_pkg_does(tmp_path: Path, case: str) -> None:
    theirs = catkin_pkg_reads(VALID[case])
    ours = read_manifest(write(tmp_path, VALID[case]))
    assert (ours.name, ours.version, ours.format) == (
        theirs.name,
        theirs.version,
        theirs.package_format,
    )
    # Ours joins the words of paragraphs with spaces.
    assert "".join(ours.description.split()) == "".join(theirs.plaintext_description.split())
    for people in ("maintainers", "authors"):
        assert [(each.name, each.email) for each in getattr(ours, people)] == [
            (each.name, each.email or "") for each in getattr(theirs, people)
        ]
    assert list(ours.licenses) == [str(each) for each in theirs.licenses]
    for kind in ("build", "buildtool", "build_export", "buildtool_export", "exec", "test", "doc"):
        assert sorted(ours.needs(kind)) == true_names(getattr(theirs, f"{kind}_depends")), kind
    assert list(ours.group_depends) == true_names(theirs.group_depends)
    assert list(ours.groups) == true_names(theirs.member_of_groups)
    assert ours.is_metapackage == theirs.is_metapackage()
    exports = {each.tagname: each.content for each in theirs.exports if each.evaluated_condition}
    assert ours.exports.keys() == exports.keys()
    for name, text in ours.exports.items():
        assert text == exports[name] or "<" in exports[name]


def true_names(conditionals: Any) -> list[str]:
    return sorted({each.name for each in conditionals if each.evaluated_condition})


@pytest.mark.parametrize("case", INVALID)
def test_catkin_pkg_refuses_an_invalid_manifest_too(tmp_path: Path, case: str) -> None:
    text, line = INVALID[case]
    with pytest.raises(PackageFileError) as error:
        read_manifest(write(tmp_path, text))
    assert error.value.line == line
    # InvalidPackage, ValueError of int() or of a condition, and AssertionError for format 4.
    with pytest.raises(Exception, match=r"(?s).") as theirs:
        catkin_pkg_reads(text)
    assert type(theirs.value).__name__ in ("InvalidPackage", "ValueError", "AssertionError")


@pytest.mark.parametrize(
    ("case", "fact"),
    [
        ("unknown element", "did you mean build_depend?"),
        ("unknown attribute", "did you mean version_gte?"),
        ("run_depend in format 2", "<exec_depend>"),
        ("exec_depend in format 1", "<run_depend>"),
        ("depend in format 1", 'format="2"'),
        ("group_depend in format 2", 'format="3"'),
        ("bad version", "'1.2'"),
        ("bad email", "'janeexample.com'"),
    ],
)
def test_errors_say_what_to_write(tmp_path: Path, case: str, fact: str) -> None:
    with pytest.raises(PackageFileError) as error:
        read_manifest(write(tmp_path, INVALID[case][0]))
    assert fact in str(error.value)


def test_dependencies_have_lines(tmp_path: Path) -> None:
    manifest = read_manifest(write(tmp_path, manifest_of("fibonacci", "rospy", "std_msgs")))
    assert [(each.name, each.line) for each in manifest.depends] == [
        ("catkin", 8),
        *[("rospy", 9), ("rospy", 10), ("std_msgs", 11), ("std_msgs", 12)],
    ]
    assert manifest.direct == ["rospy", "std_msgs"]
    assert manifest.line == 3


def test_name_in_upper_case_is_warned_of(tmp_path: Path) -> None:
    manifest = read_manifest(write(tmp_path, manifest_of("BigRobot")))
    assert "line 3: " in manifest.warnings[0] and "'BigRobot'" in manifest.warnings[0]


def test_name_of_an_invalid_manifest_is_read(tmp_path: Path) -> None:
    write(tmp_path, "<package><!-- <name>x</name> --><name> a </name><oops>")
    assert read_name(tmp_path) == "a"
    write(tmp_path, "<package>")
    assert read_name(tmp_path) == tmp_path.name
    assert read_name(tmp_path / "none") == "none"


def test_manifest_of_fibws_depends_on_nothing() -> None:
    assert Manifest("std_msgs").direct == []


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        ("$ROS_VERSION == 1", True),
        ("$ROS_VERSION == 2", False),
        ("$ROS_DISTRO != 'kinetic'", True),
        ('$ROS_DISTRO == "noetic" and $ROS_VERSION == 2', False),
        ("$ROS_VERSION == 2 or $ROS_DISTRO == noetic", True),
        ("$ROS_VERSION == 2 or $ROS_VERSION == 3 and 1 == 1", False),
        ("($ROS_VERSION == 2 or $ROS_VERSION == 1) and $ROS_DISTRO == noetic", True),
        ("$ROS_DISTRO > melodic", True),
        ("$ROS_DISTRO <= melodic", False),
        ("10 < 9", True),
        ("$UNKNOWN == ''", True),
    ],
)
def test_conditions_compare_texts(condition: str, expected: bool) -> None:
    from catkin_pkg.condition import evaluate_condition as theirs

    assert evaluate_condition(condition, ROS_1) is expected
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert theirs(condition, ROS_1) is expected


@pytest.mark.parametrize(
    "text", ["", "$A", "$A ==", "== 1", "($A == 1", "$A == 1 and", "a b", "a == b c", "a == 1.0"]
)
def test_invalid_condition_is_an_error(text: str) -> None:
    with pytest.raises(ValueError, match="invalid condition"):
        evaluate_condition(text, ROS_1)


def test_conditions_read_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    assert evaluate_condition("$ROS_VERSION == 1")
    monkeypatch.setenv("ROS_VERSION", "2")
    assert evaluate_condition("$ROS_VERSION == 2")
