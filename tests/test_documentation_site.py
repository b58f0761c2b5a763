"""The pages of docs/ that are made from the code, and the site that MkDocs builds of all."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from inspect import ismodule
from pathlib import Path

import pytest

import fibws

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"


def test_page_of_all_commands_is_that_of_the_code() -> None:
    # In a process of its own: help texts may have been made with the shell's commands set up.
    environ = {name: value for name, value in os.environ.items() if name != "FIBWS_SETUP"}
    program = "from docs import write_commands; print(write_commands.page(), end='')"
    written = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, env=environ, capture_output=True, check=True
    )
    page = (DOCS / "commands.md").read_bytes()
    assert page == written.stdout, "run: python docs/write_commands.py"


def _public_names() -> list[str]:
    """Return the public names of fibws that are not modules."""
    return [name for name in fibws.__all__ if not ismodule(getattr(fibws, name))]


def test_api_page_has_all_public_names() -> None:
    page = (DOCS / "api.md").read_text("utf-8")
    names = re.findall(r"^::: fibws\.(\w+)$", page, re.MULTILINE)
    names.remove("testing")  # a module
    assert sorted(names) == sorted(_public_names())


@pytest.mark.parametrize(
    "class_",
    [
        *(fibws.Publisher, fibws.Subscription, fibws.Peers, fibws.ClientGoal, fibws.ServerGoal),
        *(fibws.Hub, fibws.Params, fibws.Graph, fibws.Node, fibws.Rate),
    ],
)
def test_classes_offer_what_the_api_page_has(class_: type) -> None:
    page = (DOCS / "api.md").read_text("utf-8")
    listed = re.search(
        rf"^::: fibws\.{class_.__name__}\n    options:\n      members: \[(.*)\]", page, re.M
    )
    offered = {name for name in dir(class_) if not name.startswith("_")}
    if listed is not None:
        members = set(listed[1].split(", "))
        assert offered <= members
        assert members - offered <= {"peers", "port"}  # Attributes of each object.
    assert class_.__doc__ is not None
    assert "session" not in class_.__doc__  # Users construct Node and Hub alone.


@pytest.mark.long  # MkDocs imports all of fibws, for 7 s of CPU time.
def test_site_has_the_readme_and_docstrings(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    built = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert built.returncode == 0, built.stdout + built.stderr
    home = (tmp_path / "index.html").read_text("utf-8")
    assert 'href="operations/"' in home
    assert 'href="../#first-steps"' in (tmp_path / "web" / "index.html").read_text("utf-8")
    api = (tmp_path / "api" / "index.html").read_text("utf-8")
    for name in _public_names():
        assert f'id="fibws.{name}"' in api
    page = (DOCS / "api.md").read_text("utf-8")
    for name, members in re.findall(
        r"^::: (\S+)\n    options:\n      members: \[(.*)\]", page, re.M
    ):
        for member in members.split(", "):
            assert f'id="{name}.{member}"' in api
    assert 'id="fibws.Node.advertise"' in api
    tutorial = (tmp_path / "tutorial" / "index.html").read_text("utf-8")
    assert "Terminal 2" in tutorial
