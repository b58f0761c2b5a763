"""The search for type definitions in folders of packages."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.errors import InterfaceError, InvalidTypeName
from fibws.hub import package_folders
from fibws.hub.ros1.definition_search import DefinitionSearch
from fibws.interfaces import Interfaces

DOUBLE = "int32 number\n---\nint32 twice\n"


def write(folder: Path, name: str, text: str, package_name: str | None = None) -> Path:
    """Write a definition such as ``maths/srv/Double.srv``, and its package's package.xml."""
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    package = path.parent.parent
    xml = f"<package><name>{package_name or package.name}</name></package>"
    (package / "package.xml").write_text(xml)
    return path


def test_definition_is_found_in_each_part_of_the_search_path(tmp_path: Path) -> None:
    given = write(tmp_path / "given", "one/srv/Double.srv", DOUBLE)
    source = write(tmp_path / "ws/src/deep/down", "two/srv/Double.srv", DOUBLE)
    installed = write(tmp_path / "install/share", "three/srv/Double.srv", DOUBLE)
    search = DefinitionSearch(
        [tmp_path / "given"],
        {
            "ROS_PACKAGE_PATH": f"{tmp_path}/ws/src:/nowhere",
            "CMAKE_PREFIX_PATH": f"{tmp_path}/devel:{tmp_path}/install",
        },
    )
    assert search.find("srv", "one/Double").path == given
    assert search.find("srv", "two/Double").path == source
    assert search.find("srv", "three/Double").path == installed
    assert search.find("srv", "std_srvs/Trigger").md5sum == "937c9679a518e3a18d831e57125ea522"


def test_package_in_a_source_tree_may_have_another_name_than_its_folder(tmp_path: Path) -> None:
    path = write(tmp_path, "src/maths-master/srv/Double.srv", DOUBLE, package_name="maths")
    search = DefinitionSearch([], {"ROS_PACKAGE_PATH": str(tmp_path)})
    assert search.find("srv", "maths/Double").path == path


def test_ignored_folders_are_not_searched(tmp_path: Path) -> None:
    write(tmp_path, "src/old/maths/srv/Double.srv", DOUBLE)
    (tmp_path / "src/old/CATKIN_IGNORE").touch()
    search = DefinitionSearch([], {"ROS_PACKAGE_PATH": str(tmp_path)})
    with pytest.raises(InterfaceError):
        search.find("srv", "maths/Double")


def test_links_in_circles_end_the_search(tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    (tmp_path / "src/again").symlink_to(tmp_path)
    search = DefinitionSearch([], {"ROS_PACKAGE_PATH": str(tmp_path)})
    with pytest.raises(InterfaceError):
        search.find("srv", "maths/Double")


def test_nested_types_come_from_the_same_path_and_are_in_the_text(tmp_path: Path) -> None:
    write(tmp_path, "shapes/msg/Box.msg", "geometry_msgs/Point[] corners\n")
    write(tmp_path, "maths/srv/Volume.srv", "shapes/Box box\n---\nfloat64 volume\n")
    found = DefinitionSearch([tmp_path], {}).find("srv", "maths/Volume")
    assert "MSG: shapes/Box" in found.text
    assert "MSG: geometry_msgs/Point" in found.text
    assert found.md5sum == Interfaces([tmp_path]).service_md5("maths/Volume")


def test_md5_chooses_between_definitions_of_one_name(tmp_path: Path) -> None:
    write(tmp_path, "new/maths/srv/Double.srv", "int64 number\n---\nint64 twice\n")
    older = write(tmp_path, "old/maths/srv/Double.srv", DOUBLE)
    md5sum = Interfaces([tmp_path / "old"]).service_md5("maths/Double")
    search = DefinitionSearch([tmp_path / "new", tmp_path / "old"], {})
    assert search.find("srv", "maths/Double", md5sum).path == older


def test_message_made_from_an_action_is_found(tmp_path: Path) -> None:
    path = write(tmp_path, "maths/action/Count.action", "int32 to\n---\nint32 n\n---\nint32 at\n")
    found = DefinitionSearch([tmp_path], {}).find("msg", "maths/CountActionGoal")
    assert found.path == path
    assert found.md5sum == Interfaces([tmp_path]).md5("maths/CountActionGoal")


def test_error_names_the_type_its_md5_and_what_was_found(tmp_path: Path) -> None:
    path = write(tmp_path, "maths/srv/Double.srv", DOUBLE)
    with pytest.raises(InterfaceError) as error:
        DefinitionSearch([tmp_path], {}).find("srv", "maths/Double", "0" * 32)
    for fact in ("maths/Double", "0" * 32, str(path), "--interfaces"):
        assert fact in str(error.value)


def test_invalid_definition_is_reported_with_its_line(tmp_path: Path) -> None:
    path = write(tmp_path, "maths/srv/Double.srv", "int32 a\nnonsense\n---\n")
    with pytest.raises(InterfaceError) as error:
        DefinitionSearch([tmp_path], {}).find("srv", "maths/Double")
    assert f"{path}, line 2" in str(error.value)


@pytest.mark.parametrize("name", ["../etc/passwd", "a/../b", "maths", ""])
def test_name_that_is_not_a_type_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InvalidTypeName):
        DefinitionSearch([tmp_path], {}).find("srv", name)


def test_package_added_later_is_found_after_a_while(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    search = DefinitionSearch([], {"ROS_PACKAGE_PATH": str(tmp_path)})
    with pytest.raises(InterfaceError):
        search.find("srv", "maths/Double")
    path = write(tmp_path, "deep/maths/srv/Double.srv", DOUBLE)
    monkeypatch.setattr(package_folders, "FRESH_FOR", 0.0)
    assert search.find("srv", "maths/Double").path == path
