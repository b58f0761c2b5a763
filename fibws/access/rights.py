"""Principals and their rights: which names of the graph they may use, and how.

Rights are lists of globs, as in NATS's permissions and MQTT's access lists: what no glob allows is
forbidden, and a deny overrides every allow. In a glob, ``*`` stands for any characters within one
level of a name, ``**`` for any characters at all, and ``%n`` for the principal's own name.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, Self, TypeAlias, get_args

from fibws.access.limits import DEFAULT, Limits
from fibws.errors import AccessError
from fibws.suggestions import suggestion_or_known

Right: TypeAlias = Literal[
    "publish", "subscribe", "call", "provide", "param_read", "param_write", "node"
]
"""A kind of use of a name: ``call`` and ``provide`` are for services and actions, ``node`` is for
connecting as a node of this name."""

Proof: TypeAlias = Literal["token", "JWT", "certificate", "anonymous", "network"]
"""How a principal proves who it is: by a token of the file, a JSON web token, a certificate, not at
all, or by joining over another network, such as ROS 1's."""

RIGHTS: tuple[Right, ...] = get_args(Right)
GLOBS: TypeAlias = Mapping[Right, Sequence[str]]

LONGEST_NAME = 200
"""Most characters of a principal's name."""
MOST_ANSWERS = 10_000
"""Answers of one principal's rights that are remembered; names may be made up without end."""
NOTHING = r"(?!)"
"""The pattern that matches no text."""
ANY_LEVEL = "[^/]*"
"""The pattern of any characters within one level of a name."""
_TOKEN = re.compile(r"\*\*|\*|%n|[^*%]+|%")
_LISTS = ("allow", "deny")
KEYS = ("admin", *_LISTS)
"""The keys of a table of rights."""
_NAMED_BY_OTHERS: tuple[Proof, ...] = ("JWT", "certificate")
"""The proofs whose names the operator of the hub does not choose."""
_LEVEL = re.compile(r"\w+", re.ASCII)


@dataclass(frozen=True)
class Rights:
    """The rights of a principal, with a cache of decisions.

    Args:
        allow: globs of names by right.
        deny: exceptions from these.
        admin: whether everything is allowed, including the operator's actions: to kill nodes, to
            set log levels of others, to read metrics.
        name: the principal's, for ``%n``; if it is not one level of a name, ``%n`` allows nothing,
            and denies any level.

    Raises:
        AccessError: a glob is invalid.
    """

    allow: GLOBS = field(default_factory=dict)
    deny: GLOBS = field(default_factory=dict)
    admin: bool = False
    name: str = ""

    def __post_init__(self) -> None:
        for globs in (*self.allow.values(), *self.deny.values()):
            for glob in globs:
                check_glob(glob)

    @classmethod
    def parse(cls, table: Mapping[str, Any], *, name: str, where: str) -> Self:
        """Return the rights of a TOML table or a JSON object; see also `check_keys`.

        Args:
            table: with ``admin``, ``allow`` and ``deny``; the last two have lists of globs by
                right.
            name: the principal's.
            where: the table's name, for errors.

        Raises:
            AccessError: a value is not of its type, or a right is unknown.
        """
        admin = table.get("admin", False)
        if not isinstance(admin, bool):
            raise AccessError(f"{where}.admin must be true or false, got {admin!r}")
        allow, deny = (_parse_globs(table.get(key, {}), f"{where}.{key}") for key in _LISTS)
        return cls(allow, deny, admin, name)

    def table(self) -> dict[str, Any]:
        """Return the table that `parse` takes, without empty lists."""
        found: dict[str, Any] = {"admin": True} if self.admin else {}
        for key, globs in (("allow", self.allow), ("deny", self.deny)):
            kept = {right: list(globs[right]) for right in RIGHTS if globs.get(right)}
            if kept:
                found[key] = kept
        return found

    def allows(self, right: Right, name: str) -> bool:
        """Return whether the principal may use a global name in this way."""
        if self.admin:
            return True
        answer = self._answers.get((right, name))
        if answer is None:
            allowed, denied = self._compiled[right]
            answer = allowed.fullmatch(name) is not None and denied.fullmatch(name) is None
            if len(self._answers) >= MOST_ANSWERS:
                self._answers.clear()
            self._answers[right, name] = answer
        return answer

    def denies(self, right: Right, name: str) -> bool:
        """Return whether a use of a name is denied expressly."""
        return not self.admin and self._compiled[right][1].fullmatch(name) is not None

    @cached_property
    def text(self) -> str:
        """The same text for equal rights of one principal."""
        return repr(self.table())

    @cached_property
    def _answers(self) -> dict[tuple[Right, str], bool]:
        return {}

    @cached_property
    def _compiled(self) -> dict[Right, tuple[re.Pattern[str], re.Pattern[str]]]:
        return {
            right: (
                compile_globs(self.allow.get(right, ()), self.name),
                compile_globs(self.deny.get(right, ()), self.name, otherwise=ANY_LEVEL),
            )
            for right in RIGHTS
        }


@dataclass(frozen=True)
class Principal:
    """A user or program, identified by its name and the kind of its proof.

    An issuer of JSON web tokens or certificates must not be able to make somebody of the file of
    tokens by choosing the same name.

    Attributes:
        name: unique among those with the same kind of proof.
        expires: when the proof expires, in seconds since 1970; None for never.
        limits: limits that the principal's clients share.
    """

    name: str
    rights: Rights
    expires: float | None = None
    limits: Limits = DEFAULT
    proof: Proof = "token"

    @property
    def title(self) -> str:
        """The name for logs, which no other principal has, such as ``ann (JWT)``."""
        return f"{self.name} ({self.proof})" if self.proof in _NAMED_BY_OTHERS else self.name

    def is_same(self, other: Principal) -> bool:
        """Return whether this is one user or program; anonymous ones are strangers."""
        if self.proof == "anonymous":
            return False
        return (self.proof, self.name) == (other.proof, other.name)

    def is_expired(self, now: float) -> bool:
        """Return whether the proof has expired at a time in seconds since 1970."""
        return self.expires is not None and now >= self.expires


def check_keys(table: Mapping[str, Any], known: Collection[str], where: str) -> None:
    """Raise `AccessError` if a table has an unknown key: a misspelt deny would give more rights."""
    for key in table:
        if key not in known:
            raise AccessError(f"unknown key {where}.{key}{suggestion_or_known(key, known)}")


def check_name(name: str) -> str:
    """Return a principal's name; raise `AccessError` if it is empty, too long or not printable."""
    if not name or len(name) > LONGEST_NAME or not name.isprintable():
        raise AccessError(
            f"a principal's name must have 1 to {LONGEST_NAME} printable characters, "
            f"got {name[:LONGEST_NAME]!r}"
        )
    return name


def check_glob(glob: str) -> str:
    """Return a glob; raise `AccessError` if it can match no global name."""
    if not glob.startswith(("/", "*")):
        raise AccessError(f"a glob must begin with / or *, such as /robot1/** or /**; got {glob!r}")
    return glob


def compile_globs(
    globs: Iterable[str], name: str = "", *, otherwise: str = NOTHING
) -> re.Pattern[str]:
    """Return the pattern of all names that one of the globs matches.

    Args:
        name: the replacement of ``%n``.
        otherwise: the pattern in place of ``%n`` if the name is not one level of a name: `NOTHING`
            or `ANY_LEVEL`.
    """
    own = name if _LEVEL.fullmatch(name) else otherwise
    parts = [_pattern(each, own) for each in globs]
    return re.compile("|".join(parts) if parts else NOTHING, re.DOTALL)


def _pattern(glob: str, own: str) -> str:
    """Return the pattern of a glob; ``own`` is that of ``%n``.

    Names may be made up to keep the hub busy, so the search must not try all ways to divide a name
    among the wildcards: what stands between two of them is where it comes first, which leaves most
    to those that follow. Only what comes last is bound to the name's end.
    """
    parts: list[list[str]] = [[""]]
    for token in _TOKEN.findall(glob):
        if token == "**":
            parts.append([""])
        elif token == "*" or (token == "%n" and own == ANY_LEVEL):
            parts[-1].append("")
        else:
            parts[-1][-1] += own if token == "%n" else re.escape(token)
    *others, last = parts
    found = "".join(
        ("(?>.*?" if number else "(?>")
        + part[0]
        + "".join(f"(?>[^/]*?{text})" for text in part[1:])
        + ")"
        for number, part in enumerate(others)
    )
    found += (".*" if others else "") + last[0]
    found += "".join(f"(?>[^/]*?{text})" for text in last[1:-1])
    return found + "".join(f"{ANY_LEVEL}{text}" for text in last[1:][-1:])


def _parse_globs(table: object, where: str) -> GLOBS:
    if not isinstance(table, Mapping):
        raise AccessError(f"{where} must be a table of lists of globs, got {table!r}")
    found: dict[Right, Sequence[str]] = {}
    for right, globs in table.items():
        if right not in RIGHTS:
            raise AccessError(f"unknown right {where}.{right}{suggestion_or_known(right, RIGHTS)}")
        if not isinstance(globs, list) or not all(isinstance(each, str) for each in globs):
            raise AccessError(f"{where}.{right} must be a list of globs, got {globs!r}")
        found[right] = tuple(globs)
    return found
