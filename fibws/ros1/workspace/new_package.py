"""Create the first files of a new package, as catkin_create_pkg does."""

from __future__ import annotations

import getpass
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from fibws.ros1.errors import WorkspaceError
from fibws.ros1.workspace.cmake_lists import ADD_FILES
from fibws.ros1.workspace.cmake_lists import FILE as LISTS
from fibws.ros1.workspace.file_writer import File, Tree, write
from fibws.ros1.workspace.package_xml import FILE as MANIFEST
from fibws.ros1.workspace.package_xml import NAME, NAME_RULE, VERSION, Person

EXTRAS = ("action", "config", "launch", "msg", "scripts", "srv")
"""The folders that a new package may have besides src/."""

NO_LICENSE = "TODO"
"""The license that catkin_create_pkg writes if none is given, to be replaced."""

_EXAMPLES = {
    "msg": ("Num.msg", "int64 num\n"),
    "srv": ("AddTwoInts.srv", "int64 a\nint64 b\n---\nint64 sum\n"),
    "action": ("Count.action", "int32 to\n---\nint32 last\n---\nint32 now\n"),
}
_TOOLS = {"message_generation", "message_runtime", "genmsg"}
_PERSON = re.compile(r"\s*(?P<name>[^<>]*?)\s*<(?P<email>[^<>@\s]+@[^<>@\s]+)>\s*")

_PACKAGE_XML = """\
<?xml version="1.0"?>
<package format="2">
  <name>{name}</name>
  <version>{version}</version>
  <description>{description}</description>

  <!-- The people who look after the package, one line each. -->
{maintainers}
  <!-- BSD, MIT, Apache-2.0, GPLv3 ... -->
{licenses}
  <!-- The people who wrote it: <author email="jane.doe@example.com">Jane Doe</author> -->
{authors}
  <!-- Dependencies: other packages, or libraries of the system.
         build_depend         needed to build this package, as message_generation
         exec_depend          needed to run its programs, as message_runtime
         build_export_depend  needed to build packages that depend on this one
         depend               all three
  -->
  <buildtool_depend>catkin</buildtool_depend>
{depends}
  <!-- Information for other tools. -->
  <export>{export}
  </export>
</package>
"""

_CMAKE_LISTS = """\
cmake_minimum_required(VERSION 3.0.2)
project({name})

## Packages needed to build this one; list each in package.xml, too.
find_package(catkin REQUIRED{components})
{boost}
## Uncomment this if setup.py lists Python modules that other packages import.
# catkin_python_setup()


####################################
## Messages, services and actions ##
####################################

## 1. Write msg/Num.msg, srv/AddTwoInts.srv or action/Count.action.
## 2. Add to package.xml:
##      <build_depend>message_generation</build_depend>
##      <exec_depend>message_runtime</exec_depend>
## 3. Add to find_package() above: message_generation, and each package whose types you use
##    (for actions: actionlib_msgs).
## 4. Uncomment below, and list your files, and those packages as DEPENDENCIES.

{messages}

{services}

{actions}

{generate}


#############
## Package ##
#############

## List the packages that users of this one need. Call this after generate_messages(), and before
## you use CATKIN_PACKAGE_BIN_DESTINATION.
catkin_package(
#  CATKIN_DEPENDS {catkin_depends}
)


##############
## Programs ##
##############

## List Python programs, so that rosrun finds them. Each begins with #!/usr/bin/env python3 and is
## executable (chmod +x).
# catkin_install_python(PROGRAMS
#   src/{name}_node.py
#   DESTINATION ${{CATKIN_PACKAGE_BIN_DESTINATION}}
# )

## Other files of the package.
# install(DIRECTORY launch
#   DESTINATION ${{CATKIN_PACKAGE_SHARE_DESTINATION}}
# )
"""

_METAPACKAGE = """\
cmake_minimum_required(VERSION 3.0.2)
project({name})
find_package(catkin REQUIRED)
catkin_metapackage()
"""

_LAUNCH = """\
<launch>
  <!-- Uncomment this to start the node: roslaunch {name} {name}.launch -->
  <!-- <node pkg="{name}" type="{name}_node.py" name="{name}" output="screen"/> -->
</launch>
"""


@dataclass
class NewPackage:
    """A package to create.

    Attributes:
        name: its name.
        depends: the packages that it depends on.
        system: the system's libraries that it depends on.
        boost: the parts of Boost that it depends on.
        extras: those of `EXTRAS` that it begins with.
        meta: whether it is a metapackage, which only groups others.
    """

    name: str
    depends: list[str] = field(default_factory=list)
    system: list[str] = field(default_factory=list)
    boost: list[str] = field(default_factory=list)
    version: str = "0.0.0"
    description: str = ""
    licenses: list[str] = field(default_factory=list)
    authors: list[str] = field(default_factory=list)
    maintainers: list[str] = field(default_factory=list)
    extras: list[str] = field(default_factory=list)
    meta: bool = False

    def create(self, where: Path) -> list[str]:
        """Create the package's folder in ``where``; return what was created, as ``file a/src``.

        Raises:
            WorkspaceError: the name or the version is invalid, or the package exists.
            OSError: a file cannot be written.
        """
        self._check(where)
        folder = where / self.name
        created = []
        for name, file in self._files().items():
            write(folder, {name: file})
            created.append(f"file {self.name}/{name}")
        for name in self._folders():
            if not (folder / name).is_dir():
                (folder / name).mkdir(parents=True)
                created.append(f"folder {self.name}/{name}")
        return created

    def _check(self, where: Path) -> None:
        if not NAME.fullmatch(self.name):
            raise WorkspaceError(f"invalid name {self.name!r}: {NAME_RULE}")
        if not VERSION.fullmatch(self.version):
            raise WorkspaceError(f"invalid version {self.version!r}, expected e.g. 1.2.3")
        wrong = [each for each in (*self.depends, *self.system) if not NAME.fullmatch(each)]
        if wrong:
            raise WorkspaceError(f"invalid dependency {wrong[0]!r}: {NAME_RULE}")
        if self.name in self.depends:
            raise WorkspaceError(f"{self.name} cannot depend on itself")
        for above in (where, *where.parents):
            if (above / MANIFEST).is_file():
                text = f"{where} is inside package {above.name}, where no packages are found"
                raise WorkspaceError(f"{text}: cd {above.parent}")
        for name in (MANIFEST, LISTS):
            if (where / self.name / name).exists():
                raise WorkspaceError(f"File exists: {where / self.name / name}")
        if (where / self.name).exists() and not (where / self.name).is_dir():
            raise WorkspaceError(f"File exists: {where / self.name}")

    @property
    def _kinds(self) -> list[str]:
        return [kind for kind in ADD_FILES if kind in self.extras]

    @property
    def _components(self) -> list[str]:
        extra = ["message_generation"] if self._kinds else []
        extra += ["actionlib_msgs"] if "action" in self._kinds else []
        return sorted({*self.depends, *extra} - {"message_runtime"})

    def _folders(self) -> list[str]:
        if self.meta:
            return []
        headers = [f"include/{self.name}"] if "roscpp" in self.depends else []
        return [*headers, "src", *(each for each in EXTRAS if each in self.extras)]

    def _files(self) -> Tree:
        texts = {MANIFEST: self._manifest(), LISTS: self._lists()}
        for kind in self._kinds:
            name, text = _EXAMPLES[kind]
            texts[f"{kind}/{name}"] = text
        if "launch" in self.extras:
            texts[f"launch/{self.name}.launch"] = _LAUNCH.format(name=self.name)
        return {name: File(text.encode()) for name, text in texts.items()}

    def _manifest(self) -> str:
        return _PACKAGE_XML.format(
            name=self.name,
            version=self.version,
            description=escape(self.description or f"The {self.name} package"),
            maintainers=_people("maintainer", self.maintainers or [_user()]),
            licenses=_lines(
                f"<license>{escape(each)}</license>" for each in self.licenses or [NO_LICENSE]
            ),
            authors=_people("author", self.authors),
            depends=_lines(self._depends()),
            export="\n    <metapackage />" if self.meta else "",
        )

    def _depends(self) -> list[str]:
        if self.meta:
            return [f"<exec_depend>{name}</exec_depend>" for name in sorted(self.depends)]
        names = sorted({*self.depends, *self.system, *self._components} - _TOOLS)
        wanted = {tag: set(names) for tag in ("build_depend", "build_export_depend", "exec_depend")}
        if self._kinds or "message_generation" in self.depends:
            wanted["build_depend"].add("message_generation")
        if self._kinds or "message_runtime" in self.depends:
            wanted["exec_depend"].add("message_runtime")
        return [f"<{tag}>{name}</{tag}>" for tag in wanted for name in sorted(wanted[tag])]

    def _lists(self) -> str:
        if self.meta:
            return _METAPACKAGE.format(name=self.name)
        components = "".join(f"\n  {name}" for name in self._components)
        boost = " ".join(self.boost)
        packages = [each for each in self.depends if each.endswith("_msgs")]
        return _CMAKE_LISTS.format(
            name=self.name,
            components=f" COMPONENTS{components}\n" if components else "",
            boost=f"\nfind_package(Boost REQUIRED COMPONENTS {boost})\n" if boost else "",
            messages=self._command("msg", "Num.msg"),
            services=self._command("srv", "AddTwoInts.srv"),
            actions=self._command("action", "Count.action"),
            generate=self._generate(packages or ["std_msgs"]),
            catkin_depends=" ".join(sorted(set(self.depends) - _TOOLS)) or "rospy",
        )

    def _command(self, kind: str, example: str) -> str:
        text = f"{ADD_FILES[kind]}(\n  FILES\n  {example}\n)"
        return text if kind in self._kinds else _commented(text)

    def _generate(self, packages: list[str]) -> str:
        if not self._kinds:
            return _commented("generate_messages(\n  DEPENDENCIES\n  std_msgs\n)")
        packages = [each for each in packages if each in self._components]
        packages += ["actionlib_msgs"] if "action" in self._kinds else []
        names = "".join(f"\n  {name}" for name in sorted(set(packages)))
        return f"generate_messages(\n  DEPENDENCIES{names}\n)" if names else "generate_messages()"


def _commented(text: str) -> str:
    return "\n".join(f"# {line}" for line in text.split("\n"))


def _lines(elements: Iterable[str]) -> str:
    return "".join(f"  {element}\n" for element in elements)


def _people(tag: str, people: list[str]) -> str:
    lines = []
    for person in map(_person, people):
        email = person.email or (_address(person.name) if tag == "maintainer" else "")
        email = f" email={quoteattr(email)}" if email else ""
        lines.append(f"<{tag}{email}>{escape(person.name)}</{tag}>")
    return _lines(lines)


def _person(text: str) -> Person:
    """Read ``Jane Doe <jane@example.com>``, or a name alone."""
    if found := _PERSON.fullmatch(text):
        return Person(found["name"] or found["email"], found["email"])
    return Person(text.strip() or "user", "")


def _address(name: str) -> str:
    """Return a placeholder, as each maintainer must have an address."""
    local = re.sub(r"[^A-Za-z0-9_+-]", "", name.split()[-1])
    return f"{local or 'user'}@todo.todo"


def _user() -> str:
    try:
        return getpass.getuser()
    except (OSError, KeyError, ImportError):
        return "user"
