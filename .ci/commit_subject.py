"""Check the subject of a commit message: `component: what changed`, at most 72 characters.

pre-commit runs it as a commit-msg hook with the file of the message.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

MOST = 72
FORM = re.compile(r"[a-z0-9_.][\w./, -]*: \S.*[^.\s]")
OF_GIT = re.compile(r"Merge |Revert \"|(fixup|squash|amend)! ")
"""Subjects that git writes."""


def fault(message: str) -> str | None:
    """Return what is wrong with a message's subject; None if nothing is."""
    lines = [line for line in message.splitlines() if not line.startswith("#")]
    subject = lines[0] if lines else ""
    if OF_GIT.match(subject):
        return None
    if len(subject) > MOST:
        return f"the subject has {len(subject)} characters; the limit is {MOST}"
    if not FORM.fullmatch(subject):
        return (
            "the subject must be 'component: what changed', without a full stop at its end: "
            f"got {subject!r}"
        )
    if len(lines) > 1 and lines[1].strip():
        return "the line after the subject must be empty"
    return None


def main() -> None:
    """Check the file that the command line names."""
    found = fault(Path(sys.argv[1]).read_text("utf-8"))
    if found:
        sys.exit(f"{found}\nExample: cli: report a missing option value")


if __name__ == "__main__":
    main()
