"""Compile the .msg, .srv and .action files of packages, to find what is wrong in them."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fibws.errors import DefinitionError, FibwsError, UnknownPackage
from fibws.ros1.errors import PackageFileError
from fibws.ros1.workspace.cmake_lists import ADD_FILES, ListedFile
from fibws.ros1.workspace.source_tree import SourcePackage
from fibws.suggestions import suggestion

if TYPE_CHECKING:
    from fibws.interfaces import Interfaces, MessageDefinition


def compile_definitions(packages: Sequence[SourcePackage], folders: Iterable[Path] = ()) -> None:
    """Compile the listed definitions of all packages, and add errors and warnings to them.

    Args:
        packages: the packages, each after those that it depends on.
        folders: folders with other packages whose types they may use.
    """
    from fibws.interfaces import Interfaces  # 0.1 s, and many workspaces have no definitions

    for package in packages:
        _check_files(package)
    if not any(any(package.lists.definitions.values()) for package in packages):
        return
    with tempfile.TemporaryDirectory(prefix="fibws-") as name:
        copies = Path(name)
        originals: dict[str, Path] = {}
        for package in packages:
            originals |= _copy(package, copies)
        interfaces = Interfaces([*(each for each in folders if each.is_dir()), copies])
        failed: set[str] = set()
        for package in packages:
            if not package.depends & failed:
                errors = _compile(package, interfaces)
                package.errors += [_at_original(error, originals) for error in errors]
            if package.errors or package.depends & failed:
                failed.add(package.name)


def _check_files(package: SourcePackage) -> None:
    """Check that listed files exist, and that existing files are listed."""
    lists = package.lists
    if any(lists.definitions.values()) and not package.name.isidentifier():
        text = f"{package.name!r}: packages with messages need names of letters, digits and _ only"
        package.errors.append(PackageFileError(lists.source, lists.project.line, text))
        lists.generates = None
    for kind, files in lists.definitions.items():
        existing = sorted(path.name for path in (package.folder / kind).glob(f"*.{kind}"))
        good = []
        for file in files:
            if text := _invalid_file(file, kind, existing):
                package.errors.append(PackageFileError(lists.source, file.line, text))
            else:
                good.append(file)
        listed = {file.path.name for file in files}
        line = files[0].line if files else 1
        for name in existing:
            if name not in listed:
                text = f"{kind}/{name} is not listed in {ADD_FILES[kind]}(FILES ...): not generated"
                package.warnings.append(f"{lists.source}, line {line}: {text}")
        lists.definitions[kind] = good
    if lists.generates is None:
        lists.definitions = {kind: [] for kind in ADD_FILES}


def _invalid_file(file: ListedFile, kind: str, existing: list[str]) -> str:
    """Return why a listed file cannot define a type; empty if it can."""
    path = file.path
    if not path.is_file():
        if path.name in existing:
            return f"write {path.name}: {ADD_FILES[kind]}() looks in {kind}/ already"
        return f"{kind}/{path.name} not found{suggestion(path.name, existing)}"
    if path.suffix != f".{kind}":
        return f"{ADD_FILES[kind]}() expects .{kind} files, got {path.name}"
    if not (path.stem.isascii() and path.stem.isidentifier()):
        return f"invalid name {path.name!r}: type names have letters, digits and _ only"
    return ""


def _copy(package: SourcePackage, folder: Path) -> dict[str, Path]:
    """Copy the package's definitions to where `Interfaces` finds them; return their originals."""
    originals = {}
    for kind, files in package.lists.definitions.items():
        for file in files:
            target = folder / package.name / kind / file.path.name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file.path, target)
            originals[str(target)] = file.path
    return originals


def _compile(package: SourcePackage, interfaces: Interfaces) -> Iterator[FibwsError]:
    declared = _declared(package, interfaces)
    for kind, files in package.lists.definitions.items():
        for file in files:
            name = f"{package.name}/{file.path.stem}"
            try:
                if kind == "msg":
                    parts = [interfaces.message(name)]
                elif kind == "srv":
                    service = interfaces.service(name)
                    parts = [service.request, service.response]
                else:
                    action = interfaces.action(name)
                    parts = [action.goal, action.result, action.feedback]
            except FibwsError as error:
                yield error
            else:
                package.warnings += _undeclared(file, parts, declared)


def _undeclared(
    file: ListedFile, parts: list[MessageDefinition], declared: set[str]
) -> Iterator[str]:
    """Yield a warning for each field whose package generate_messages() does not depend on."""
    for part in parts:
        for field in part.fields:
            package, slash, _ = field.type.partition("/")
            if slash and package not in declared:
                where = f"{file.path}, line {field.line}"
                text = f"catkin needs generate_messages(DEPENDENCIES {package}) for this"
                yield f"{where}: {text}: {field.full_type} {field.name}"


def _declared(package: SourcePackage, interfaces: Interfaces) -> set[str]:
    """Return the packages of DEPENDENCIES, and those whose types they use themselves."""
    found = {package.name}
    pending = list(package.lists.message_packages)
    while pending:
        name = pending.pop()
        if name not in found:
            found.add(name)
            pending += _packages_used_by(name, interfaces)
    return found


def _packages_used_by(package: str, interfaces: Interfaces) -> set[str]:
    used: set[str] = set()
    try:
        names = interfaces.messages(package)
    except UnknownPackage:
        return used
    for name in names:
        try:
            fields = interfaces.message(name).fields
        except FibwsError:
            continue  # It is reported where it is compiled.
        used |= {field.type.partition("/")[0] for field in fields if "/" in field.type}
    return used


def _at_original(error: FibwsError, originals: dict[str, Path]) -> FibwsError:
    """Return the error with the path of the original file instead of its copy's."""
    if isinstance(error, DefinitionError) and error.source in originals:
        return DefinitionError(str(originals[error.source]), error.line, error.text, error.fault)
    return error
