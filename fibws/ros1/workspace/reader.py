"""Reads a package's CMakeLists.txt into its recipe."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path, PurePosixPath

from fibws.ros1.workspace.cmake import vocabulary
from fibws.ros1.workspace.cmake.script import Call, Script, Value
from fibws.ros1.workspace.cmake.syntax import Command, read_commands
from fibws.ros1.workspace.recipe import ADD_FILES, FILE, Listed, Recipe
from fibws.suggestions import nearest, suggestion


def read_recipe(folder: Path) -> Recipe:
    """What the CMakeLists.txt in ``folder`` asks for.

    Raises:
        PackageFileError: the text is none of CMake's language.
        OSError: it cannot be read.
    """
    path = folder / FILE
    return _Reading(folder, path, read_commands(path)).read()


class _Reading:
    """One pass through the file, a method for each command that matters."""

    def __init__(self, folder: Path, path: Path, commands: list[Command]) -> None:
        self._folder = folder
        self.recipe = Recipe(str(path))
        here = folder.as_posix()
        variables = {name: here for name in vocabulary.HERE}
        self._script = Script(commands, folder, str(path), {**vocabulary.VARIABLES, **variables})
        self._readers: dict[str, Callable[[Call], None]] = {
            "project": self._project,
            "find_package": self._find_package,
            "generate_messages": self._generate_messages,
            "catkin_package": self._catkin_package,
            "catkin_metapackage": self._catkin_metapackage,
            "catkin_python_setup": self._catkin_python_setup,
            "catkin_install_python": self._catkin_install_python,
            "install": self._install,
            "message": self._message,
            "add_executable": self._compiled,
            "add_library": self._compiled,
            **dict.fromkeys(ADD_FILES.values(), self._add_files),
        }

    def read(self) -> Recipe:
        for call in self._script.calls():
            if reader := self._readers.get(call.name):
                reader(call)
            elif call.name not in vocabulary.COMMANDS | self._script.defined:
                self._unknown(call)
        recipe = self.recipe
        if not recipe.project.text:
            recipe.fault(1, "project(NAME) is missing, with the name in package.xml")
        has_definitions = any(recipe.definitions.values())
        if has_definitions and recipe.generates is None:
            line = next(each[0].line for each in recipe.definitions.values() if each)
            recipe.warn(line, "nothing is made of these files: generate_messages() is missing")
        return recipe

    def _unknown(self, call: Call) -> None:
        known = {*self._readers, *vocabulary.COMMANDS, *self._script.defined}
        near = nearest(call.name, known)
        if near:
            fault = f"there is no command {call.name}(); did you mean {near}()?"
            self.recipe.fault(call.line, fault)
        else:
            self.recipe.warn(call.line, f"{call.name}() is not known here and was passed over")

    def _project(self, call: Call) -> None:
        if not call.values:
            self.recipe.fault(call.line, "project() needs the package's name")
            return
        name = self.recipe.project = call.values[0]
        self._script.variables["PROJECT_NAME"] = name.text
        self._script.variables["CMAKE_PROJECT_NAME"] = name.text
        self._script.variables[f"{name.text}_SOURCE_DIR"] = self._folder.as_posix()

    def _find_package(self, call: Call) -> None:
        if not call.values:
            self.recipe.fault(call.line, "find_package() needs a name")
            return
        first, *rest = call.values
        self._script.variables[f"{first.text}_FOUND"] = "1"
        if first.text.lower() == "catkin" and first.text != "catkin":
            self.recipe.warn(first.line, f"the package is catkin, in lower case: {first.text!r}")
        self.recipe.components.setdefault(first.text, first.line)
        if first.text != "catkin":
            self.recipe.modules.add(first.text)
            return
        parts = _sorted_out(rest, {"COMPONENTS", "OPTIONAL_COMPONENTS"}, {"REQUIRED", "QUIET"})
        # Without the word COMPONENTS those behind REQUIRED are meant, too.
        for value in (*parts["COMPONENTS"], *parts[""]):
            if not value.text[:1].isdigit() and value.text not in ("EXACT", "CONFIG", "MODULE"):
                self.recipe.components.setdefault(value.text, value.line)
                self._script.variables[f"{value.text}_FOUND"] = "1"

    def _add_files(self, call: Call) -> None:
        kind = next(each for each, name in ADD_FILES.items() if name == call.name)
        recipe = self.recipe
        self._comes_from(call, "message_generation", "genmsg")
        if kind == "action":
            self._comes_from(call, "actionlib_msgs", "actionlib")
        if recipe.generates is not None:
            recipe.fault(call.line, f"{call.name}() stands before generate_messages(), not behind")
        parts = _sorted_out(call.values, {"FILES", "DIRECTORY", "BASE_DIR"}, {"NOINSTALL"})
        self._no_more(call, parts[""], "FILES")
        folder = self._folder / (parts["DIRECTORY"][0].text if parts["DIRECTORY"] else kind)
        if not folder.is_dir():
            recipe.fault(call.line, f"{call.name}(): there is no folder {folder}")
            return
        if any(value.text == "FILES" for value in call.values):
            files = [Listed(folder / value.text, value.line) for value in parts["FILES"]]
        else:
            files = [Listed(path, call.line) for path in sorted(folder.glob(f"*.{kind}"))]
        recipe.definitions[kind] += files

    def _generate_messages(self, call: Call) -> None:
        recipe = self.recipe
        if recipe.generates is not None:
            first = f"once, and did so in line {recipe.generates}"
            recipe.fault(call.line, f"generate_messages() stands in a package {first}")
        if recipe.declares is not None:
            recipe.fault(call.line, "generate_messages() stands before catkin_package()")
        self._comes_from(call, "message_generation", "genmsg")
        recipe.generates = call.line
        parts = _sorted_out(call.values, {"DEPENDENCIES", "LANGS"}, set())
        self._no_more(call, parts[""], "DEPENDENCIES")
        for value in parts["DEPENDENCIES"]:
            recipe.message_packages.setdefault(value.text, value.line)

    def _catkin_package(self, call: Call) -> None:
        recipe = self.recipe
        if recipe.declares is not None:
            recipe.warn(call.line, f"catkin_package() stood in line {recipe.declares} already")
        if "catkin" not in recipe.components:
            remedy = "find_package(catkin REQUIRED) stands before it"
            recipe.warn(call.line, f"catkin_package() comes from catkin: {remedy}")
        recipe.declares = call.line
        words = {"INCLUDE_DIRS", "LIBRARIES", "CATKIN_DEPENDS", "DEPENDS", "CFG_EXTRAS"}
        words |= {"EXPORTED_TARGETS"}
        parts = _sorted_out(
            call.values, words, {"SKIP_CMAKE_CONFIG_GENERATION", "SKIP_PKG_CONFIG_GENERATION"}
        )
        self._no_more(call, parts[""], "CATKIN_DEPENDS")
        for value in parts["CATKIN_DEPENDS"]:
            recipe.catkin_depends.setdefault(value.text, value.line)
        for value in parts["INCLUDE_DIRS"]:
            if not (self._folder / value.text).is_dir():
                recipe.fault(value.line, f"catkin_package(): there is no folder {value.text}")
        self._set_destinations()

    def _catkin_metapackage(self, call: Call) -> None:
        self.recipe.declares = call.line

    def _catkin_python_setup(self, call: Call) -> None:
        recipe = self.recipe
        for line, name in (
            (recipe.generates, "generate_messages"),
            (recipe.declares, "catkin_package"),
        ):
            if line is not None:
                recipe.fault(call.line, f"catkin_python_setup() stands before {name}()")
        if not (self._folder / "setup.py").is_file():
            recipe.fault(call.line, "catkin_python_setup(): there is no setup.py in the package")
            return
        recipe.python_setup = call.line

    def _catkin_install_python(self, call: Call) -> None:
        recipe = self.recipe
        if not call.values or call.values[0].text.upper() != "PROGRAMS":
            example = "catkin_install_python(PROGRAMS src/node.py DESTINATION ...)"
            recipe.fault(call.line, f"catkin_install_python() begins with PROGRAMS: {example}")
            return
        parts = _sorted_out(call.values[1:], {"DESTINATION"}, {"OPTIONAL"})
        destination = parts["DESTINATION"]
        if not destination:
            recipe.fault(call.line, self._no_destination())
            return
        if ".." in PurePosixPath(destination[0].text).parts:
            fault = f"{destination[0].text} leads out of the folder that programs are put into"
            recipe.fault(destination[0].line, fault)
            return
        optional = any(value.text == "OPTIONAL" for value in call.values)
        # What stands behind the destination is a program, too: it takes one value alone.
        for value in (*parts[""], *destination[1:]):
            path = self._folder / value.text
            if path.is_file():
                recipe.programs.append(Listed(path, value.line, destination[0].text))
            elif not optional:
                recipe.fault(
                    value.line, f"there is no program {value.text}{self._near(value.text)}"
                )

    def _no_destination(self) -> str:
        """Why catkin_install_python() has no DESTINATION, as far as one can see."""
        name = "CATKIN_PACKAGE_BIN_DESTINATION"
        for unset in self._script.unset:
            if unset == name and self.recipe.declares is None:
                return f"${{{name}}} is set by catkin_package(), which stands before it"
            if unset != name and nearest(unset, [name]):
                return f"${{{unset}}} is not set; did you mean ${{{name}}}?"
        return f"catkin_install_python() needs DESTINATION ${{{name}}}"

    def _install(self, call: Call) -> None:
        if not call.values or call.values[0].text not in ("FILES", "PROGRAMS", "DIRECTORY"):
            return
        words = {"DESTINATION", "PERMISSIONS", "FILE_PERMISSIONS", "DIRECTORY_PERMISSIONS"}
        words |= {"CONFIGURATIONS", "COMPONENT", "RENAME", "PATTERN", "REGEX"}
        flags = {"OPTIONAL", "FILES_MATCHING", "EXCLUDE", "USE_SOURCE_PERMISSIONS"}
        for value in _sorted_out(call.values[1:], words, flags)[""]:
            is_there = (self._folder / value.text).exists()
            if not is_there and not any(each.text == "OPTIONAL" for each in call.values):
                missing = f"install(): there is no {value.text}{self._near(value.text)}"
                self.recipe.warn(value.line, missing)

    def _message(self, call: Call) -> None:
        if call.texts[:1] == ["FATAL_ERROR"]:
            self.recipe.fault(call.line, " ".join(call.texts[1:]))

    def _compiled(self, call: Call) -> None:
        if not call.values:
            self.recipe.fault(call.line, f"{call.name}() needs a name")
            return
        name = call.values[0]
        self._script.targets.add(name.text)
        if "INTERFACE" not in call.texts and "ALIAS" not in call.texts:
            self.recipe.compiled.setdefault(name.text, name.line)

    def _comes_from(self, call: Call, package: str, other: str) -> None:
        """See whether find_package() finds a package that has the command."""
        if not {package, other} & self.recipe.components.keys():
            remedy = f"find_package(catkin REQUIRED COMPONENTS ... {package})"
            self.recipe.fault(call.line, f"{call.name}() comes from {package}: {remedy}")

    def _no_more(self, call: Call, rest: list[Value], word: str) -> None:
        for value in rest[:1]:
            fault = f"{call.name}() has no use for {value.text}: {word} stands before names"
            self.recipe.fault(value.line, fault)

    def _near(self, name: str) -> str:
        """The end of an error's text, which says where the file is that was meant."""
        path = Path(name)
        same = sorted(self._folder.rglob(path.name)) if path.name else []
        if same:
            return f"; did you mean {same[0].relative_to(self._folder).as_posix()}?"
        files = (each for each in self._folder.rglob(f"*{path.suffix}") if each.is_file())
        return suggestion(name, [each.relative_to(self._folder).as_posix() for each in files])

    def _set_destinations(self) -> None:
        project = self.recipe.project.text
        self._script.variables.update(
            {
                "CATKIN_PACKAGE_BIN_DESTINATION": f"lib/{project}",
                "CATKIN_PACKAGE_LIB_DESTINATION": f"lib/{project}",
                "CATKIN_PACKAGE_SHARE_DESTINATION": f"share/{project}",
                "CATKIN_PACKAGE_ETC_DESTINATION": f"etc/{project}",
                "CATKIN_PACKAGE_INCLUDE_DESTINATION": f"include/{project}",
                "CATKIN_PACKAGE_PYTHON_DESTINATION": f"lib/python3/dist-packages/{project}",
                "CATKIN_GLOBAL_BIN_DESTINATION": "bin",
                "CATKIN_GLOBAL_LIB_DESTINATION": "lib",
                "CATKIN_GLOBAL_SHARE_DESTINATION": "share",
                "CATKIN_GLOBAL_PYTHON_DESTINATION": "lib/python3/dist-packages",
            }
        )


def _sorted_out(
    values: Sequence[Value], words: set[str], flags: set[str]
) -> dict[str, list[Value]]:
    """The values by the word that they stand behind; those before any of them by ``""``."""
    parts: dict[str, list[Value]] = {word: [] for word in ("", *words)}
    word = ""
    for value in values:
        if value.text in words:
            word = value.text
        elif value.text not in flags:
            parts[word].append(value)
    return parts
