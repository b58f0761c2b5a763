"""Compiles the .msg, .srv and .action files of packages, to see whether they can be used."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fibws.errors import DefinitionError, FibwsError, UnknownPackage
from fibws.ros1.workspace.recipe import ADD_FILES, Listed
from fibws.ros1.workspace.source import Source
from fibws.suggestions import suggestion

if TYPE_CHECKING:
    from fibws.interfaces import Interfaces, MessageDefinition


def compile_definitions(sources: Sequence[Source], folders: Iterable[Path] = ()) -> None:
    """Read all definitions that the packages list; what is wrong becomes a fault of the recipe.

    Args:
        sources: the packages, which may use each other's types.
        folders: with packages of definitions that they may use besides.
    """
    from fibws.interfaces import Interfaces  # 0.1 s, and many a workspace has no definitions

    for source in sources:
        _check_files(source)
    if not any(source.recipe.definitions.values() for source in sources):
        return
    with tempfile.TemporaryDirectory(prefix="fibws-") as name:
        here = Path(name)
        originals: dict[str, Path] = {}
        for source in sources:
            originals |= _copy(source, here)
        interfaces = Interfaces([*(each for each in folders if each.is_dir()), here])
        for source in sources:
            errors = _compile(source, interfaces)
            source.recipe.faults += [_told(error, originals) for error in errors]


def _check_files(source: Source) -> None:
    """See whether the files that are listed exist, and those that exist are listed."""
    recipe = source.recipe
    if any(recipe.definitions.values()) and not source.name.isidentifier():
        name = "a package with definitions is named in letters, digits and _ alone"
        recipe.fault(recipe.project.line, f"{name}: {source.name!r}")
        recipe.definitions = {kind: [] for kind in recipe.definitions}
        return
    for kind, listed in recipe.definitions.items():
        there = sorted(path.name for path in (source.folder / kind).glob(f"*.{kind}"))
        good = []
        for each in listed:
            if fault := _unfit(each, kind, there):
                recipe.fault(each.line, fault)
            else:
                good.append(each)
        recipe.definitions[kind] = good
        names = {each.path.name for each in listed}
        for name in there:
            if name not in names:
                text = (
                    f"{kind}/{name} is not in {ADD_FILES[kind]}(FILES ...): nothing is made of it"
                )
                recipe.warn(listed[0].line if listed else 1, text)

    if recipe.generates is None:
        recipe.definitions = {kind: [] for kind in recipe.definitions}  # It was warned of that.


def _unfit(listed: Listed, kind: str, there: list[str]) -> str:
    """Why a listed file is none that a type can be made of; empty if it is one."""
    path = listed.path
    if not path.is_file():
        if path.name in there:
            return f"write {path.name}: {ADD_FILES[kind]}() looks in the folder {kind}/ by itself"
        return f"there is no {kind}/{path.name}{suggestion(path.name, there)}"
    if path.suffix != f".{kind}":
        return f"{ADD_FILES[kind]}() lists .{kind} files: {path.name}"
    if not (path.stem.isascii() and path.stem.isidentifier()):
        return f"the name of a type has letters, digits and _ alone: {path.name!r}"
    return ""


def _copy(source: Source, here: Path) -> dict[str, Path]:
    """Lay out the package's definitions as they are to be found, and tell where each is from."""
    originals = {}
    for kind, listed in source.recipe.definitions.items():
        for each in listed:
            target = here / source.name / kind / each.path.name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(each.path, target)
            originals[str(target)] = each.path
    return originals


def _compile(source: Source, interfaces: Interfaces) -> Iterable[FibwsError]:
    reachable = _reachable(source, interfaces)
    for kind, listed in source.recipe.definitions.items():
        for each in listed:
            name = f"{source.name}/{each.path.stem}"
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
                yield from _undeclared(each, parts, reachable)


def _undeclared(
    listed: Listed, parts: list[MessageDefinition], reachable: set[str]
) -> Iterable[FibwsError]:
    """The fields whose package generate_messages() does not depend on."""
    for part in parts:
        for field in part.fields:
            package, slash, _ = field.type.partition("/")
            if not slash or package in reachable:
                continue
            fault = f"generate_messages(DEPENDENCIES {package}) is missing in CMakeLists.txt for"
            yield DefinitionError(
                str(listed.path), field.line, f"{field.full_type} {field.name}", f"{fault} this"
            )


def _reachable(source: Source, interfaces: Interfaces) -> set[str]:
    """The packages whose types may be used: those depended on, and what these depend on."""
    found: set[str] = set()
    pending = [source.name, *source.recipe.message_packages]
    while pending:
        package = pending.pop()
        if package in found:
            continue
        found.add(package)
        if package != source.name:
            pending += _used_by(package, interfaces)
    return found


def _used_by(package: str, interfaces: Interfaces) -> set[str]:
    used: set[str] = set()
    try:
        names = interfaces.messages(package)
    except UnknownPackage:
        return used
    for name in names:
        try:
            fields = interfaces.message(name).fields
        except FibwsError:
            continue  # It is told where it is compiled.
        used |= {field.type.partition("/")[0] for field in fields if "/" in field.type}
    return used


def _told(error: FibwsError, originals: dict[str, Path]) -> FibwsError:
    """The error, with the file's own name in it and not that of its copy."""
    if isinstance(error, DefinitionError) and error.source in originals:
        return DefinitionError(str(originals[error.source]), error.line, error.text, error.fault)
    return error
