"""The file of tokens: what is read from it, and how it is edited."""

from __future__ import annotations

import os
import stat
import sys
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime
from pathlib import Path

import pytest

from fibws.access.rights import Rights
from fibws.access.token_file import TokenFile, Tokens, digest_of
from fibws.errors import AccessError

FILE = f"""\
# Who may enter.
[tokens.teleop]
sha256 = "{digest_of("secret")}"  # Ann's
expires = 2027-01-01T00:00:00Z

[tokens.teleop.allow]
publish = ["/cmd_vel"]

[certificates.robot1]
admin = true

[anonymous]
allow = {{subscribe = ["/map"]}}
"""


def test_principals_are_read() -> None:
    tokens = Tokens.parse(FILE, "tokens.toml")
    teleop = tokens.find("secret")
    assert teleop is not None
    assert teleop.name == "teleop"
    assert teleop.rights.allows("publish", "/cmd_vel")
    assert teleop.expires == datetime(2027, 1, 1, tzinfo=UTC).timestamp()
    assert tokens.certificates["robot1"].rights.admin
    assert tokens.anonymous is not None
    assert tokens.anonymous.rights.allows("subscribe", "/map")


def test_changes_are_named() -> None:
    def entry(name: str, digit: str, rest: str = "admin = true") -> str:
        return f'[tokens.{name}]\nsha256 = "{digit * 64}"\n{rest}\n'

    old = Tokens.parse(
        entry("same", "0") + entry("gone", "1") + entry("new_token", "2") + entry("rights", "3")
        + "[certificates.arm]\nadmin = true\n[anonymous]\nadmin = true\n[ros1]\nadmin = true",
        "old",
    )  # fmt: skip
    new = Tokens.parse(
        "[certificates.leg]\nadmin = true\n[ros1]\nallow = {}\n[ros2]\nallow = {}\n"
        + entry("added", "4") + entry("rights", "3", 'allow = {call = ["/a"]}')
        + entry("new_token", "5") + entry("same", "0"),
        "new",
    )  # fmt: skip
    assert sorted(new.changes(old)) == [
        "certificate arm removed",
        "certificate leg added",
        "section anonymous removed",
        "section ros1 changed",
        "section ros2 added",
        "token added added",
        "token gone revoked",
        "token new_token changed",
        "token rights changed",
    ]
    assert new.changes(new) == []


@pytest.mark.parametrize("token", ["", "Secret", "secret ", digest_of("secret"), "é", "\udc80"])
def test_other_tokens_are_unknown(token: str) -> None:
    assert Tokens.parse(FILE, "tokens.toml").find(token) is None


def test_without_its_section_nobody_is_anonymous() -> None:
    assert Tokens.parse("", "tokens.toml").anonymous is None


@pytest.mark.parametrize(
    ("text", "facts"),
    [
        ("[tokens", ("]",)),
        ("[token.a]", ("token", "did you mean tokens")),
        ("tokens = 1", ("tokens", "table")),
        ("[tokens]\na = 1", ("tokens.a", "table")),
        ("[tokens.a]", ("tokens.a.sha256",)),
        ('[tokens.a]\nsha256 = "abc"', ("tokens.a.sha256", "64")),
        (f'[tokens.anonymous]\nsha256 = "{digest_of("x")}"', ("tokens.anonymous",)),
        ('[certificates.""]', ("name",)),
        ("[anonymous]\nalow = {}", ("anonymous.alow", "allow")),
        ('[anonymous]\nexpires = "soon"', ("anonymous.expires", "date")),
        ('[anonymous.allow]\npublish = ["x"]', ("'x'",)),
        (
            "".join(f'[tokens.{name}]\nsha256 = "{digest_of("x")}"\n' for name in "ab"),
            ("tokens.b", "same token as a"),
        ),
    ],
)
def test_invalid_file_is_refused(text: str, facts: tuple[str, ...]) -> None:
    with pytest.raises(AccessError) as raised:
        Tokens.parse(text, "tokens.toml")
    assert all(fact in str(raised.value) for fact in ("tokens.toml", *facts))


def test_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(AccessError, match=r"none\.toml"):
        Tokens.load(tmp_path / "none.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff")
    with pytest.raises(AccessError, match=r"bytes\.toml is not UTF-8"):
        Tokens.load(tmp_path / "bytes.toml")


def test_dates_without_a_zone_are_utc() -> None:
    tokens = Tokens.parse("[anonymous]\nexpires = 2027-01-01", "tokens.toml")
    assert tokens.anonymous is not None
    assert tokens.anonymous.expires == datetime(2027, 1, 1, tzinfo=UTC).timestamp()


def test_tokens_are_added_and_revoked(tmp_path: Path) -> None:
    path = tmp_path / "tokens.toml"
    path.write_text(FILE, "utf-8")
    file = TokenFile(path)
    expires = datetime(2030, 1, 1, tzinfo=UTC)
    token = file.add("robot.1", Rights({"publish": ["/**"]}, {"call": ["/x"]}), expires)
    other = file.add("boss", Rights(admin=True))
    tokens = Tokens.load(path)
    robot, boss = tokens.find(token), tokens.find(other)
    assert robot is not None
    assert boss is not None
    assert robot.name == "robot.1"
    assert robot.expires == expires.timestamp()
    assert robot.rights.table() == {"allow": {"publish": ["/**"]}, "deny": {"call": ["/x"]}}
    assert boss.rights.admin
    text = path.read_text("utf-8")
    assert "# Who may enter." in text
    assert "# Ann's" in text
    assert token not in text
    file.revoke("teleop")
    file.revoke("robot.1")
    tokens = Tokens.load(path)
    assert tokens.find("secret") is None
    assert tokens.find(token) is None
    assert tokens.find(other) is not None
    assert tokens.anonymous is not None


def test_new_file_is_readable_by_its_owner_only(tmp_path: Path) -> None:
    file = TokenFile(tmp_path / "tokens.toml")
    tokens = {file.add(name, Rights()) for name in ("a", "b")}
    assert len(tokens) == 2
    assert all(token.startswith("fibws_") and len(token) == 49 for token in tokens)
    assert [path.name for path in tmp_path.iterdir()] == ["tokens.toml"]
    if sys.platform != "win32":
        assert stat.S_IMODE((tmp_path / "tokens.toml").stat().st_mode) == 0o600


def test_names_are_added_once_and_revoked_if_known(tmp_path: Path) -> None:
    file = TokenFile(tmp_path / "tokens.toml")
    file.add("robot", Rights())
    with pytest.raises(AccessError, match="revoke it first"):
        file.add("robot", Rights())
    with pytest.raises(AccessError, match="anonymous"):
        file.add("anonymous", Rights())
    with pytest.raises(AccessError, match="did you mean robot"):
        file.revoke("robt")
    found = Tokens.load(tmp_path / "tokens.toml").tokens
    assert [each.name for each in found.values()] == ["robot"]


@pytest.mark.skipif(
    sys.platform == "win32" or os.geteuid() == 0, reason="the system's rights do not count"
)
def test_file_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    file = TokenFile(tmp_path / "tokens.toml")
    tmp_path.chmod(0o500)
    with pytest.raises(AccessError, match="cannot write"):
        file.add("robot", Rights())


def test_edits_of_several_programs_are_all_kept(tmp_path: Path) -> None:
    path = tmp_path / "tokens.toml"
    names = [f"robot{number}" for number in range(20)]
    with ThreadPoolExecutor(len(names)) as threads:
        for added in [threads.submit(TokenFile(path).add, name, Rights()) for name in names]:
            added.result()
        for revoked in [threads.submit(TokenFile(path).revoke, name) for name in names[1:]]:
            revoked.result()
    assert [each.name for each in Tokens.load(path).tokens.values()] == ["robot0"]
    assert [each.name for each in tmp_path.iterdir()] == ["tokens.toml"]


def test_invalid_name_leaves_the_file_unchanged(tmp_path: Path) -> None:
    path = tmp_path / "tokens.toml"
    path.write_text(FILE, "utf-8")
    with pytest.raises(AccessError, match="revoke it first"):
        TokenFile(path).add("teleop", Rights())
    assert path.read_text("utf-8") == FILE
