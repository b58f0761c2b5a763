"""Break guard lines on purpose, one at a time, and check that a test notices each.

``python tests/mutants/check.py`` prints "N of N mutants killed" and exits with 1 if a mutant
survives. Words select mutants: ``python tests/mutants/check.py send_queue "latched"``.

A guard line is one that no ordinary message needs: the second of two early returns, a limit, a
reset after an error. Coverage cannot tell whether a test depends on it, only breaking it can. The
mutants are data, in the ``*.toml`` files beside this one::

    [[mutant]]
    what = "a source removed by a sink keeps no latched message"   # What the guard is for.
    file = "fibws/hub/graph/topic.py"
    old = "if not self.is_attached:"                               # Must be there exactly once.
    new = "if False:"
    tests = ["tests/hub/graph/test_sources.py"]                    # Files, or tests in them.

When one survives, think about what would go wrong for a user: then write a test for that, or remove
the guard. When a guard moves, change ``old``; `test_check.py` fails until this is done.

Each mutant is made in a copy of the tree, never in the checkout. First all tests must pass there
without mutants; then a mutant is killed if one of its tests fails.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

ROOT = Path(__file__).resolve().parents[2]
FOLDER = Path(__file__).resolve().parent

NOT_COPIED = (".*", "__pycache__", "node_modules")
"""Patterns of names in the tree that the tests do not need."""
TEST_TIMEOUT = 60
"""Seconds after which a test fails: a mutant may wait for something that never comes."""
RUN_TIMEOUT = 300
"""Seconds after which a run is ended that does not even notice `TEST_TIMEOUT`."""
PASSED, FAILED, ENDED = 0, 1, 98
"""Exit codes of pytest, all others mean that it could not run the tests; and of an ended run."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """A change that breaks one guard line.

    Attributes:
        what: what the guard is for.
        file: the file to change, relative to the root of the tree.
        old: the text to replace, which must be there exactly once.
        new: the text to put there.
        tests: test files, or names of tests in them, that must notice.
    """

    what: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.file}: {self.what}"

    def apply(self, text: str) -> str:
        """Return the file's text with the change.

        Raises:
            ValueError: the old text is not there exactly once, or nothing would change.
        """
        count = text.count(self.old)
        if count != 1:
            raise ValueError(f"{self}: the old text is there {count} times, expected once")
        if self.old == self.new:
            raise ValueError(f"{self}: the new text is the old one")
        return text.replace(self.old, self.new)


def load(folder: Path = FOLDER) -> list[Mutant]:
    """Return the mutants in the TOML files of a folder."""
    return [
        Mutant(tests=tuple(table.pop("tests")), **table)
        for path in sorted(folder.glob("*.toml"))
        for table in tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]
    ]


class Tree:
    """A copy of the tree in which mutants are made.

    Args:
        root: the tree.
        folder: where to copy it.
    """

    def __init__(self, root: Path, folder: Path) -> None:
        self._folder = folder
        self._versions = 0
        shutil.copytree(root, folder, ignore=shutil.ignore_patterns(*NOT_COPIED), symlinks=True)

    def run(self, tests: Iterable[str]) -> subprocess.CompletedProcess[str]:
        """Run tests until the first failure."""
        environment = {**os.environ, "PYTHONPATH": str(self._folder)}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        options = ["-q", "-x", "-n0", "-pno:cacheprovider", f"--timeout={TEST_TIMEOUT}"]
        options += ["-m", "not slow"]  # Long ones, which run in `.ci/all` alone, guard as well.
        command = [os.path.abspath(sys.executable), "-m", "pytest", *options, *tests]
        try:
            return subprocess.run(
                command,
                cwd=self._folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=RUN_TIMEOUT,
                check=False,
            )
        except subprocess.TimeoutExpired:
            text = f"ended after {RUN_TIMEOUT} s"
            return subprocess.CompletedProcess(command, ENDED, text)

    @contextmanager
    def mutated(self, mutant: Mutant) -> Iterator[None]:
        """Change a file for a while."""
        path = self._folder / mutant.file
        text = path.read_text(encoding="utf-8")
        self._write(path, mutant.apply(text))
        try:
            yield
        finally:
            self._write(path, text)

    def _write(self, path: Path, text: str) -> None:
        """Write a version of a file with a time of its own.

        Python takes bytecode for current if it has the source's length and time in whole seconds.
        """
        self._versions += 1
        modified = int(path.stat().st_mtime) + self._versions
        path.write_text(text, encoding="utf-8")
        os.utime(path, (modified, modified))


def faults(mutants: Iterable[Mutant], root: Path = ROOT) -> list[str]:
    """Return what is wrong with mutants: their old text or their tests are not found."""
    found = []
    for mutant in mutants:
        try:
            mutant.apply((root / mutant.file).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            found.append(str(error))
        for test in mutant.tests:
            name, *parts = test.split("::")
            path = root / name
            text = path.read_text(encoding="utf-8") if path.is_file() else ""
            missing = [part for part in parts if f" {part.partition('[')[0]}" not in text]
            if not path.exists() or missing:
                found.append(f"{mutant}: no test {test}")
    return found


def check(mutants: Sequence[Mutant], root: Path = ROOT, jobs: int = 2) -> bool:
    """Try all mutants, and print those that survive and the score; return whether none did."""
    if wrong := faults(mutants, root):
        print(*wrong, sep="\n")
        return False
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        pool = ThreadPoolExecutor(jobs)
        trees: Queue[Tree] = Queue()
        for tree in pool.map(lambda number: Tree(root, Path(folder, str(number))), range(jobs)):
            trees.put(tree)

        def baseline(tests: Sequence[str]) -> str:
            tree = trees.get()
            try:
                result = tree.run(tests) if tests else None
                return result.stdout if result is not None and result.returncode else ""
            finally:
                trees.put(tree)

        def survival(mutant: Mutant) -> str:
            tree = trees.get()
            began = time.monotonic()
            try:
                with tree.mutated(mutant):
                    result = tree.run(mutant.tests)
            finally:
                trees.put(tree)
            seconds = time.monotonic() - began
            if result.returncode == FAILED:
                verdict = "killed"
            else:
                verdict = "SURVIVED" if result.returncode == PASSED else "NOT TRIED"
            print(f"{verdict:9} {seconds:5.1f} s  {mutant}", flush=True)
            if verdict == "NOT TRIED":
                print(result.stdout)
            return "" if verdict == "killed" else str(mutant)

        with pool:
            tests = sorted({test for mutant in mutants for test in mutant.tests})
            if failures := "".join(pool.map(baseline, [tests[n::jobs] for n in range(jobs)])):
                print(failures, "These tests fail without a mutant.", sep="\n")
                return False
            survivors = [text for text in pool.map(survival, mutants) if text]
    print(f"{len(mutants) - len(survivors)} of {len(mutants)} mutants killed")
    return not survivors


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the check, and return its exit code."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("words", nargs="*", help="only mutants whose file or purpose has a word")
    parser.add_argument("--jobs", type=int, default=2, help="mutants at a time (default: 2)")
    options = parser.parse_args(arguments)
    chosen = [
        mutant
        for mutant in load()
        if not options.words or any(word in str(mutant) for word in options.words)
    ]
    if not chosen:
        parser.error("no mutant has such a file or purpose")
    return 0 if check(chosen, jobs=options.jobs) else 1


if __name__ == "__main__":
    raise SystemExit(main())
