"""Check that a tag, the built packages and CHANGELOG.md agree on a release's version.

    python .ci/check_release.py v0.2.0            prints version=0.2.0 if they do
    python .ci/check_release.py v0.2.0 --notes    prints the release's section of CHANGELOG.md, too

It is run in the folder that holds dist/ and CHANGELOG.md.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

TAG = re.compile(r"v(\d+\.\d+\.\d+((a|b|rc)\d+)?)")


def notes_of(version: str, changelog: str) -> str | None:
    """Return the text of a release's section; None if there is no section with a date."""
    heading = rf"^## {re.escape(version)} - \d{{4}}-\d\d-\d\d\n(.*?)(?=^## |\Z)"
    found = re.search(heading, changelog, re.MULTILINE | re.DOTALL)
    return found[1].strip() if found else None


def faults(tag: str, folder: Path) -> list[str]:
    """Return a line for each fault of a release."""
    named = TAG.fullmatch(tag)
    if named is None:
        return [f"invalid tag {tag!r}: expected one such as v0.2.0 or v0.2.0rc1"]
    version = named[1]
    found = []
    expected = {f"fibws-{version}.tar.gz", f"fibws-{version}-py3-none-any.whl"}
    built = {path.name for path in (folder / "dist").glob("*")}
    if built != expected:
        found.append(f"dist/ has {sorted(built)}, expected {sorted(expected)} for the tag {tag}")
    if not notes_of(version, (folder / "CHANGELOG.md").read_text("utf-8")):
        found.append(f"CHANGELOG.md has no text under '## {version} - YYYY-MM-DD'")
    return found


def main() -> None:
    """Check the release that the command line names."""
    options = argparse.ArgumentParser(description="Check a release's version.")
    options.add_argument("tag", help="the tag of the release, such as v0.2.0")
    options.add_argument("--notes", action="store_true", help="print the section of CHANGELOG.md")
    chosen = options.parse_args()
    found = faults(chosen.tag, Path())
    if found:
        sys.exit("\n".join(found))
    version = chosen.tag.removeprefix("v")
    if chosen.notes:
        print(notes_of(version, Path("CHANGELOG.md").read_text("utf-8")))
    else:
        print(f"version={version}")


if __name__ == "__main__":
    main()
