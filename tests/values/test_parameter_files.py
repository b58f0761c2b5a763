"""Parameters as YAML."""

from __future__ import annotations

import json
import math
import re
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from random_inputs import examples

from fibws.errors import InvalidValue, ParameterError
from fibws.values import parameter_files

KEYS = st.text(min_size=1).filter(lambda key: "/" not in key)
VALUES: st.SearchStrategy[Any] = st.recursive(
    st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=4),
    max_leaves=4,
)
TEXTS = st.text() | st.sampled_from(
    ["deg(90)", "rad(x)", "1e3", "1:30", "~", "<<", "=", "2026-01-31"]
)
SPECIAL: st.SearchStrategy[Any] = st.recursive(
    st.booleans()
    | st.integers()
    | st.floats()
    | TEXTS
    | st.binary()
    | st.datetimes().map(lambda date: date.replace(fold=0)),
    lambda inner: st.lists(inner, max_size=4),
    max_leaves=4,
)
TREES = st.dictionaries(KEYS, SPECIAL | st.dictionaries(st.text(), SPECIAL, max_size=3), max_size=4)
SPACES = st.recursive(
    st.dictionaries(KEYS, VALUES, min_size=1, max_size=4),
    lambda inner: st.dictionaries(KEYS, VALUES | inner, min_size=1, max_size=4),
    max_leaves=4,
)


def tree(leaves: list[tuple[str, str]]) -> dict[str, Any]:
    """What a parameter server has when all of these are set."""
    root: dict[str, Any] = {}
    for name, value in leaves:
        *above, last = name.split("/")[1:]
        space = root
        for key in above:
            space = space.setdefault(key, {})
        space[last] = json.loads(value)
    return root


@examples(0.3)  # PyYAML is slow.
@given(SPACES)
def test_dumped_parameters_are_loaded_unchanged(space: dict[str, Any]) -> None:
    space = json.loads(json.dumps(space))
    assert tree(parameter_files.parameters(parameter_files.dumped(space), "/")) == space


def in_order(value: Any) -> Any:
    return (
        {key: in_order(each) for key, each in sorted(value.items())}
        if isinstance(value, dict)
        else value
    )


def restored(entries: list[tuple[str, Any]]) -> dict[str, Any]:
    """What a parameter server has when all of these are set."""
    root: dict[str, Any] = {}
    for name, value in entries:
        *above, last = name.split("/")[1:]
        space = root
        for key in above:
            space = space.setdefault(key, {})
        space[last] = value
    return root


@examples(0.3)
@given(TREES)
@example({"angle": "deg(90)", "text": "rad(x)", "none": {}, "one": {"a/b": 1}, "nan": [math.nan]})
@example({"bytes": b"\0\xff", "date": datetime(2026, 1, 31, 12, 0, 0, 5), "inf": math.inf})
def test_saved_parameters_are_restored_exactly(space: dict[str, Any]) -> None:
    text = parameter_files.saved(space)
    after = restored(parameter_files.entries(text, "/"))
    assert repr(in_order(after)) == repr(in_order(space))  # It shows every bit.


@pytest.mark.parametrize(
    ("word", "value"),
    [
        ("1", 1),
        ('"1"', "1"),
        ("1.5", 1.5),
        ("yes", True),
        ("a b", "a b"),
        ("[1, a]", [1, "a"]),
        ("deg(180)", math.pi),
        ("!radians pi/2", math.pi / 2),
        ("!degrees 180", math.pi),
        ("degree", "degree"),
        ("radius(1)", "radius(1)"),
    ],
)
def test_values_have_the_types_of_yaml(word: str, value: object) -> None:
    found = parameter_files.parse(word)
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("word", "fault"),
    [
        ("[1", "Invalid YAML: expected"),
        ("!!python/object:os.system {}", "Invalid YAML: could not determine a constructor"),
        ("rad(x)", "angle in radians 'rad(x)'"),
        ("2020-13-45", "month must be in 1..12"),
        ("[" * 1_000, "'[[["),
    ],
)
def test_invalid_yaml_is_refused(word: str, fault: str) -> None:
    with pytest.raises(InvalidValue) as caught:
        parameter_files.parse(word)
    assert fault in str(caught.value)


def test_object_is_a_parameter_for_each_key() -> None:
    assert parameter_files.leaves("/a", {"b": 1, "c": {"d": [{"e": 1}], "f": {}}}) == [
        ("/a/b", "1"),
        ("/a/c/d", '[{"e": 1}]'),
    ]
    assert parameter_files.leaves("/a", "ü") == [("/a", '"ü"')]


@pytest.mark.parametrize(
    ("word", "fault"),
    [
        ("{1: 2}", "[/x]: key 1"),
        ("{a: {yes: 2}}", "[/x/a]: key True"),
        ("null", "[/x]: null"),
        ("{a: [{b: null}]}", "[/x/a]: null"),
        ("2020-01-01", "[/x]: 2020-01-01 is a date"),
        ("[2020-01-01]", "2020-01-01 is a date"),
        ("!!binary aGk=", "[/x]: bytes"),
        (".nan", "[/x]: nan"),
        ("[.inf]", "[/x]: "),
        ("&x {a: *x}", "nested too deeply"),
        ("&x [*x]", "nested too deeply"),
        (f"1{':59' * 500}", "number too large"),
        ("!!timestamp x", "Invalid YAML"),
    ],
)
def test_values_that_parameters_cannot_have_are_refused(word: str, fault: str) -> None:
    with pytest.raises((InvalidValue, ParameterError)) as caught:
        parameter_files.leaves("/x", parameter_files.parse(word))
    assert fault in str(caught.value)


def test_root_namespace_must_be_an_object() -> None:
    with pytest.raises((InvalidValue, ParameterError), match="object"):
        parameter_files.leaves("/", 5)
    assert parameter_files.leaves("/", {"a": 5}) == [("/a", "5")]


def test_documents_may_name_their_namespaces() -> None:
    text = "a: 1\n---\n---\n_ns: arm\nb: 2\n---\n_ns: /global\nc: 3\n---\n_ns: {d: 4}\n"
    assert parameter_files.parameters(text, "/robot") == [
        ("/robot/a", "1"),
        ("/robot/arm/b", "2"),
        ("/global/c", "3"),
        ("/robot/_ns/d", "4"),
    ]
    assert parameter_files.parameters("5", "/five") == [("/five", "5")]
    assert parameter_files.parameters("", "/") == []


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (
            "a: [1",
            "Invalid YAML: expected ',' or ']', but got '<stream end>' (line 1, column 6)",
        ),
        ("a: 2020-13-45", "month must be in 1..12"),
        ("a: deg(x)", "angle in degrees 'deg(x)'"),
        ("[" * 1_000, "nested too deeply"),
        ("a: !!timestamp x", "groupdict"),
    ],
)
def test_invalid_yaml_in_files_is_refused(text: str, fault: str) -> None:
    with pytest.raises((InvalidValue, ParameterError)) as caught:
        parameter_files.parameters(text, "/")
    assert fault in str(caught.value)


def test_unreadable_files_are_reported(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match="missing: No such file"):
        parameter_files.read(tmp_path / "missing")
    (tmp_path / "latin").write_bytes(b"\xff")
    with pytest.raises((InvalidValue, ParameterError), match=r"latin .*UTF-8"):
        parameter_files.read(tmp_path / "latin")


def test_pretty_leaves_out_quotes() -> None:
    value = {"b": {"c": "x"}, "a": "l1\nl2", "d": [1, 2], "e": 1.5}
    assert list(parameter_files.pretty(value)) == [
        "a: |",
        "  l1",
        "  l2",
        "b:",
        "  c: x",
        "d: - 1\n- 2",
        "e: 1.5",
    ]
    assert list(parameter_files.pretty("a: b")) == ["a: b"]
    assert list(parameter_files.pretty(5)) == ["5"]


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="there is no such device")
def test_endless_files_are_refused() -> None:
    with pytest.raises(ParameterError, match=r"/dev/zero .*67108864"):
        parameter_files.read(Path("/dev/zero"))


def test_aliases_of_billions_of_values_are_refused() -> None:
    lines = [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 12)]
    with pytest.raises((InvalidValue, ParameterError), match="5000000"):
        parameter_files.parameters("\n".join(["a0: &a0 [0, 0]", *lines]), "/")


@pytest.mark.parametrize("text", ["deg(180)", "180", " deg( 180 ) ", "1.8e2"])
def test_angles_in_degrees(text: str) -> None:
    assert parameter_files.degrees(text) == math.pi


@pytest.mark.parametrize("text", ["deg(x)", "deg()", "", "deg(90*2)"])
def test_invalid_angles_in_degrees(text: str) -> None:
    with pytest.raises(InvalidValue, match=re.escape(repr(text))):
        parameter_files.degrees(text)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("rad(pi)", math.pi),
        ("rad(pi/2)", math.pi / 2),
        ("2*pi", 2 * math.pi),
        ("rad(-pi + 1)", 1 - math.pi),
        ("rad(pi**2)", math.pi**2),
        ("rad(1.5)", 1.5),
        ("rad(1 - 3)", -2.0),
    ],
)
def test_angles_in_radians(text: str, value: float) -> None:
    assert parameter_files.radians(text) == value


@pytest.mark.parametrize(
    "text",
    [
        "rad()",
        "rad(x)",
        "rad(pi",
        "rad(__import__('os'))",
        "rad('one')",
        "rad([1])",
        "rad(1/0)",
        "rad(9**9**9**9)",
        "rad(2**2000)",
        f"rad({'-' * 100_000}1)",
    ],
)
def test_invalid_angles_in_radians(text: str) -> None:
    with pytest.raises(InvalidValue, match="invalid angle in radians"):
        parameter_files.radians(text)
