"""A workspace on disk, which each test fills with packages."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from fibws.ros1.workspace.build import Plan, Workspace

CMAKE = """\
cmake_minimum_required(VERSION 3.0.2)
project({name})
find_package(catkin REQUIRED COMPONENTS {components})
{before}
catkin_package()
{after}
"""
BIN = "${CATKIN_PACKAGE_BIN_DESTINATION}"


class Layout:
    """A workspace's folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.source = folder / "src"
        self.devel = folder / "devel"
        self.source.mkdir(parents=True)

    def package(
        self,
        name: str,
        *depends: str,
        before: str = "",
        after: str = "",
        files: Mapping[str, str] | None = None,
        programs: Mapping[str, str] | None = None,
        manifest: str | None = None,
        cmake: str | None = None,
        folder: str | None = None,
    ) -> Path:
        """Write a package that builds.

        Args:
            name: its name.
            depends: its dependencies, which both of its files list.
            before: text before catkin_package() in CMakeLists.txt, from line 4 on.
            after: text after it.
            files: more files, by their names.
            programs: more files, which are executable.
            manifest: the text of package.xml, or elements to add to it.
            cmake: the text of CMakeLists.txt.
            folder: its folder in src/, if that has another name.
        """
        path = self.source / (folder or name)
        path.mkdir(parents=True)
        (path / "package.xml").write_text(manifest_of(name, *depends, text=manifest))
        components = " ".join(depends)
        text = cmake or CMAKE.format(name=name, components=components, before=before, after=after)
        (path / "CMakeLists.txt").write_text(text)
        for more, mode in ((files or {}, 0o644), (programs or {}, 0o755)):
            for relative, content in more.items():
                target = path / relative
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_text(content)
                target.chmod(mode)
        return path

    def messages(self, name: str, files: Mapping[str, str], *depends: str) -> Path:
        """Write a package of messages: text by name, as in ``Num.msg``."""
        tools = ("message_generation", "message_runtime")
        listed = " ".join(files)
        needed = f"generate_messages(DEPENDENCIES {' '.join(depends)})"
        return self.package(
            name,
            *tools,
            *depends,
            before=f"add_message_files(FILES {listed})\n{needed}",
            files={f"msg/{file}": text for file, text in files.items()},
        )

    def plan(self, *names: str, with_depends: bool = False) -> Plan:
        """Plan and build packages."""
        workspace = Workspace(self.folder, {})
        plan = workspace.plan(names, with_depends=with_depends)
        workspace.make(plan)
        return plan

    def errors(self) -> list[str]:
        """Build, and return the errors, with paths relative to src/."""
        return [self.relative(str(error)) for error in self.plan().errors]

    def warnings(self) -> list[str]:
        """Build without errors, and return the warnings, with paths relative to src/."""
        plan = self.plan()
        assert not plan.errors
        return [self.relative(warning) for warning in plan.warnings]

    def relative(self, text: str) -> str:
        return text.replace(f"{self.source}/", "")

    def built(self) -> set[str]:
        """Return the files in devel/ that were generated from packages."""
        return {
            path.relative_to(self.devel).as_posix()
            for path in self.devel.rglob("*")
            if path.is_file() and path.parent != self.devel
        }


def manifest_of(name: str, *depends: str, text: str | None = None) -> str:
    if text is not None and text.startswith("<?xml"):
        return text
    lines = "".join(
        f"<{tag}>{each}</{tag}>\n" for each in depends for tag in ("build_depend", "exec_depend")
    )
    return f"""\
<?xml version="1.0"?>
<package format="2">
<name>{name}</name>
<version>1.2.3</version>
<description>The {name} package</description>
<maintainer email="jane@example.com">Jane</maintainer>
<license>BSD</license>
<buildtool_depend>catkin</buildtool_depend>
{lines}{text or ""}</package>
"""


@pytest.fixture
def layout(tmp_path: Path) -> Layout:
    """An empty workspace."""
    return Layout(tmp_path / "ws")
