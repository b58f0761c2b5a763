"""The first files of a new package, as catkin_create_pkg makes them."""

from __future__ import annotations

import getpass
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from fibws.errors import WorkspaceError
from fibws.ros1.workspace.manifest import FILE as MANIFEST
from fibws.ros1.workspace.manifest import NAME, NAME_RULE, Person
from fibws.ros1.workspace.recipe import ADD_FILES
from fibws.ros1.workspace.recipe import FILE as LISTS
from fibws.ros1.workspace.templates import CMAKE, LAUNCH, META, PACKAGE
from fibws.ros1.workspace.tree import File, Tree, write

EXTRAS = ("action", "config", "launch", "msg", "scripts", "srv")
"""The folders that a package may begin with besides."""

NO_LICENSE = "TODO"
"""What catkin_create_pkg writes as the license for the person to replace, if none is given."""

_EXAMPLES = {
    "msg": ("Num.msg", "int64 num\n"),
    "srv": ("AddTwoInts.srv", "int64 a\nint64 b\n---\nint64 sum\n"),
    "action": ("Count.action", "int32 to\n---\nint32 last\n---\nint32 now\n"),
}
_TOOLS = {"message_generation", "message_runtime", "genmsg"}
_PERSON = re.compile(r"\s*(?P<name>[^<>]*?)\s*<(?P<email>[^<>@\s]+@[^<>@\s]+)>\s*")


@dataclass
class Skeleton:
    """A package that is to be begun.

    Attributes:
        name: the package's.
        depends: packages that it needs.
        system: what it needs of the system.
        boost: parts of Boost that it needs.
        extras: those of `EXTRAS` that it begins with.
        meta: whether it is a metapackage, which only names others.
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
        """Make the package's folder in ``where``, and tell what was made: ``file a/package.xml``.

        Raises:
            WorkspaceError: the name or the version is none, or there is such a package.
            OSError: something cannot be written.
        """
        self._check(where)
        folder = where / self.name
        made = []
        for name, file in self._files().items():
            write(folder, {name: file})
            made.append(f"file {self.name}/{name}")
        for name in self._folders():
            if not (folder / name).is_dir():
                (folder / name).mkdir(parents=True)
                made.append(f"folder {self.name}/{name}")
        return made

    def _check(self, where: Path) -> None:
        if not NAME.fullmatch(self.name):
            raise WorkspaceError(f"{self.name!r} cannot be: {NAME_RULE}")
        if not re.fullmatch(r"\d+\.\d+\.\d+", self.version, re.ASCII):
            raise WorkspaceError(f"the version is not of the form 1.2.3: {self.version!r}")
        wrong = [each for each in (*self.depends, *self.system) if not NAME.fullmatch(each)]
        if wrong:
            raise WorkspaceError(f"{wrong[0]!r} is not the name of a package to depend on")
        if self.name in self.depends:
            raise WorkspaceError(f"{self.name} cannot depend on itself")
        for above in (where, *where.parents):
            if (above / MANIFEST).is_file():
                fault = f"{where} is in the package {above.name}, and none is looked for in there"
                raise WorkspaceError(f"{fault}: cd {above.parent}")
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
            texts[f"launch/{self.name}.launch"] = LAUNCH.format(name=self.name)
        return {name: File(text.encode()) for name, text in texts.items()}

    def _manifest(self) -> str:
        return PACKAGE.format(
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
            return META.format(name=self.name)
        components = "".join(f"\n  {name}" for name in self._components)
        boost = " ".join(self.boost)
        packages = [each for each in self.depends if each.endswith("_msgs")]
        return CMAKE.format(
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
    """``Jane Doe <jane@example.com>``, or a name alone."""
    if found := _PERSON.fullmatch(text):
        return Person(found["name"] or found["email"], found["email"])
    return Person(text.strip() or "user", "")


def _address(name: str) -> str:
    """An address in the place of one that is still to be written: each maintainer has one."""
    local = re.sub(r"[^A-Za-z0-9_+-]", "", name.split()[-1])
    return f"{local or 'user'}@todo.todo"


def _user() -> str:
    try:
        return getpass.getuser()
    except (OSError, KeyError, ImportError):
        return "user"
