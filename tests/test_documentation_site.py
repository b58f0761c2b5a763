"""The pages of docs/ that are made from the code, and the site that MkDocs builds of all."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from inspect import Parameter, getsource, isclass, ismodule, signature
from itertools import chain, pairwise
from pathlib import Path
from pkgutil import resolve_name
from textwrap import dedent

import pytest

import fibws
import fibws.testing

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


def _entries() -> dict[str, str]:
    """Return what the API page has, and the options of each."""
    page = (DOCS / "api.md").read_text("utf-8")
    return dict(re.findall(r"^::: (fibws[\w.]*)\n((?:    .*\n)*)", page, re.MULTILINE))


CLASSES = {
    class_.__name__: class_
    for class_ in (*map(resolve_name, _entries()), fibws.testing.HubThread)
    if isclass(class_)
}
"""The public classes."""


def _offered(class_: type) -> dict[str, bool]:
    """Return the members of a class that an editor offers, and whether each has a docstring.

    Those that objects get in a method are among them, but not those of classes outside of fibws.
    """
    found: dict[str, bool] = {}
    for base in reversed(class_.__mro__):
        if not base.__module__.startswith("fibws."):
            continue
        tree = ast.parse(dedent(getsource(base)))
        for owner in ast.walk(tree):
            body = getattr(owner, "body", [])
            for each, following in pairwise([*body, None]) if isinstance(body, list) else ():
                text = following.value if isinstance(following, ast.Expr) else None
                has_text = isinstance(text, ast.Constant) and isinstance(text.value, str)
                for name in _names_of(each, is_member=owner is tree.body[0]):
                    if isinstance(each, ast.FunctionDef | ast.AsyncFunctionDef):
                        has_text = ast.get_docstring(each) is not None
                    found[name] = found.get(name, False) or has_text
    return {name: has_text for name, has_text in found.items() if not name.startswith("_")}


def _names_of(statement: ast.stmt | None, *, is_member: bool) -> Iterator[str]:
    """Yield the names of members that a statement makes."""
    match statement:
        case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) if is_member:
            yield name
        case ast.Assign(targets=targets):
            yield from chain.from_iterable(_targets(each, is_member=is_member) for each in targets)
        case ast.AnnAssign(target=target):
            yield from _targets(target, is_member=is_member)


def _targets(target: ast.expr, *, is_member: bool) -> Iterator[str]:
    match target:
        case ast.Tuple(elts=elements):
            for each in elements:
                yield from _targets(each, is_member=is_member)
        case ast.Name(id=name) if is_member:
            yield name
        case ast.Attribute(value=ast.Name(id="self"), attr=name):
            yield name


def _inherited(class_: type) -> set[str]:
    """Return the members of a class that are Python's."""
    others = (base for base in class_.__mro__ if not base.__module__.startswith("fibws."))
    return {name for base in others for name in dir(base)}


def _arguments(class_: type) -> Mapping[str, Parameter]:
    """Return the arguments of a class's constructor, unless it is one of Python's own."""
    own = [vars(base) for base in class_.__mro__ if base.__module__.startswith("fibws.")]
    has_constructor = any("__init__" in each or "__new__" in each for each in own)
    return signature(class_).parameters if has_constructor else {}


@pytest.mark.parametrize("name", CLASSES)
def test_classes_offer_what_is_documented(name: str) -> None:
    class_ = CLASSES[name]
    offered = _offered(class_)
    completed = {each for each in dir(class_) if not each.startswith("_")}
    assert completed - _inherited(class_) <= offered.keys()
    listed = re.search(r"members: \[(.*)\]", _entries().get(f"fibws.{name}", ""))
    if listed is not None:
        assert offered.keys() == {*listed[1].split(", ")}
    documented = {each for each, has_text in offered.items() if has_text}
    if is_dataclass(class_):
        documented.update(each.name for each in fields(class_))
    for base in class_.__mro__:
        attributes = (base.__doc__ or "").partition("Attributes:")[2]
        documented.update(_arguments(base), re.findall(r"^ +(\w+): ", attributes, re.MULTILINE))
    assert offered.keys() <= documented


@pytest.mark.parametrize("name", CLASSES)
def test_help_shows_no_constructor_that_only_fibws_calls(name: str) -> None:
    class_ = CLASSES[name]
    known = vars(sys.modules[class_.__module__])
    for argument in _arguments(class_).values():
        for word in re.findall(r"\w+", str(argument.annotation)):
            found = known.get(word)
            if isclass(found) and found.__module__.startswith("fibws."):
                assert found in CLASSES.values(), f"{argument} is internal"
    if (class_.__init__.__doc__ or "").startswith("Made by "):
        assert "merge_init_into_class: false" in _entries()[f"fibws.{name}"]


@pytest.mark.long  # MkDocs imports all of fibws, for 7 s of CPU time.
def test_site_has_the_readme_and_docstrings(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    built = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert built.returncode == 0, built.stdout + built.stderr
    home = (tmp_path / "index.html").read_text("utf-8")
    assert 'href="operations/"' in home
    assert "badge.svg" not in home  # Pages load nothing from other servers.
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
