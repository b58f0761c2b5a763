"""Rights: globs, and the tables that they are read from."""

from __future__ import annotations

import re
from time import process_time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.access.rights import (
    ANY_LEVEL,
    NOTHING,
    RIGHTS,
    Principal,
    Rights,
    check_name,
    compile_globs,
)
from fibws.errors import AccessError

NAMES = st.from_regex(r"(/[a-z_]{1,3}){1,4}", fullmatch=True)


@pytest.mark.parametrize(
    ("glob", "name", "matches"),
    [
        ("/cmd_vel", "/cmd_vel", True),
        ("/cmd_vel", "/cmd_velx", False),
        ("/cmd_vel", "/robot/cmd_vel", False),
        ("/cmd*", "/cmd_vel", True),
        ("/cmd*", "/cmd/vel", False),
        ("/*/cmd_vel", "/robot/cmd_vel", True),
        ("/*/cmd_vel", "/a/b/cmd_vel", False),
        ("/**", "/a", True),
        ("/**", "/a/b/c", True),
        ("**", "/a/b/c", True),
        ("/robot/**", "/robot/arm/joint", True),
        ("/robot/**", "/robot", False),
        ("/robot/**", "/robots/x", False),
        ("/**/status", "/a/b/status", True),
        ("/a.c", "/abc", False),
        ("/%n/x", "/teleop/x", True),
        ("/%n/x", "/other/x", False),
        ("/%/x", "/%/x", True),
        ("/a", "/a\n", False),
    ],
)
def test_globs_match_levels_of_names(glob: str, name: str, *, matches: bool) -> None:
    assert (compile_globs([glob], "teleop").fullmatch(name) is not None) is matches


@pytest.mark.parametrize("name", ["", "a/b", "..", "*", "a b", "é"])
def test_name_of_a_principal_is_in_globs_only_if_it_is_one_level(name: str) -> None:
    assert compile_globs(["/%n/**"], name).fullmatch(f"/{name}/x") is None


@given(NAMES)
def test_a_name_matches_itself_and_what_is_above_it_with_all_below(name: str) -> None:
    assert compile_globs([name]).fullmatch(name)
    above = name.rpartition("/")[0]
    assert compile_globs([f"{above}/**"]).fullmatch(name)
    assert compile_globs([f"{above}/*"]).fullmatch(name)
    assert not compile_globs([f"{name}/**"]).fullmatch(name)


@given(
    st.text(st.sampled_from("/ab*"), max_size=9) | st.sampled_from(["/%n/*b", "**%n*a", "/%n%n"]),
    st.text(st.sampled_from("/ab"), max_size=9),
    st.sampled_from([NOTHING, ANY_LEVEL]),
)
def test_globs_match_as_patterns_that_try_all_ways(glob: str, name: str, otherwise: str) -> None:
    pattern = (
        re.escape(glob).replace(r"\*\*", ".*").replace(r"\*", "[^/]*").replace("%n", otherwise)
    )
    expected = re.fullmatch(pattern, name, re.DOTALL) is not None
    found = compile_globs([glob], otherwise=otherwise).fullmatch(name) is not None
    assert found == expected


@pytest.mark.parametrize(
    ("glob", "name"),
    [
        ("/*a*a*a*b", "/" + "a" * 1000),
        ("/**/a/**/a/**/b", "/a" * 511),
        ("**a**a*a**a*b", "a" * 1001),
    ],
)
def test_globs_try_few_ways_to_divide_a_long_name(glob: str, name: str) -> None:
    began = process_time()
    assert compile_globs([glob]).fullmatch(name) is None
    assert process_time() - began < 1


def test_deny_with_the_name_of_a_principal_that_is_no_level_denies_all_levels() -> None:
    rights = Rights({"publish": ["/**"]}, {"publish": ["/%n/x"]}, name="auth0|1")
    assert not rights.allows("publish", "/a/x")
    assert rights.allows("publish", "/a/y")


def test_nothing_is_allowed_without_a_glob() -> None:
    rights = Rights()
    assert not any(rights.allows(right, "/a") for right in RIGHTS)


def test_deny_overrides_allow() -> None:
    rights = Rights({"publish": ["/**"]}, {"publish": ["/secret/**"], "subscribe": ["/**"]})
    for _ in range(2):  # The second answers are remembered.
        assert rights.allows("publish", "/a")
        assert not rights.allows("publish", "/secret/a")
        assert not rights.allows("subscribe", "/a")


def test_admin_may_do_everything() -> None:
    rights = Rights(deny={"publish": ["/a"]}, admin=True)
    assert all(rights.allows(right, "/a") for right in RIGHTS)


def test_remembered_answers_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fibws.access.rights.MOST_ANSWERS", 10)
    rights = Rights({"publish": ["/a*"]})
    for number in range(25):
        assert rights.allows("publish", f"/a{number}")
        assert not rights.allows("publish", f"/b{number}")
        assert len(rights._answers) <= 10


def test_table_is_read_and_written() -> None:
    table = {
        "admin": True,
        "allow": {"publish": ["/a"], "node": ["/%n"]},
        "deny": {"param_write": ["/**"]},
    }
    rights = Rights.parse({**table, "sha256": "x"}, name="robot", where="tokens.robot")
    assert rights.table() == table
    assert rights.name == "robot"
    assert Rights.parse({}, name="robot", where="x").table() == {}


@pytest.mark.parametrize(
    ("table", "facts"),
    [
        ({"admin": "yes"}, ("tokens.robot.admin", "true or false")),
        ({"allow": ["/a"]}, ("tokens.robot.allow", "table")),
        ({"allow": {"publsh": []}}, ("tokens.robot.allow.publsh", "publish")),
        ({"deny": {"call": "/a"}}, ("tokens.robot.deny.call", "list")),
        ({"deny": {"call": [1]}}, ("tokens.robot.deny.call", "list")),
        ({"allow": {"call": ["add"]}}, ("'add'", "begin with /")),
    ],
)
def test_invalid_table_is_refused(table: dict[str, object], facts: tuple[str, ...]) -> None:
    with pytest.raises(AccessError) as raised:
        Rights.parse(table, name="robot", where="tokens.robot")
    assert all(fact in str(raised.value) for fact in facts)


@pytest.mark.parametrize("name", ["", "a\nb", "x" * 201])
def test_invalid_name_of_a_principal_is_refused(name: str) -> None:
    with pytest.raises(AccessError, match=re.escape("1 to 200 printable")):
        check_name(name)


def test_principal_expires() -> None:
    assert not Principal("a", Rights()).is_expired(1e12)
    assert not Principal("a", Rights(), 10.0).is_expired(9.9)
    assert Principal("a", Rights(), 10.0).is_expired(10.0)
