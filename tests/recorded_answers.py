"""Answers of a real ROS, recorded beside the tests that compare fibws with it.

Debian's ROS packages are frozen, so the same question always has the same answer. The answers of
``test_x.py`` are in ``answers/test_x.json`` in its folder, by test and question. Tests read them;
``pytest --record-ros`` asks the installed ROS again and writes the files, and ``git diff`` then
shows what ROS, or a question, has changed.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Awaitable, Callable, Iterable
from pathlib import Path
from typing import Any

import pytest

LONGEST = 120
"""Characters of a text that `shortened` keeps."""

Kept = dict[str, dict[str, Any]]
"""The answers of a test module, by test and question."""


class Answers:
    """What the real ROS answered in one test.

    Args:
        kept: the answers of the module's tests; changed when recording.
        test: the name of this test.
        recording: whether to ask the installed ROS.
    """

    def __init__(self, kept: Kept, test: str, *, recording: bool) -> None:
        self._before = kept.get(test, {})
        self._kept = kept
        self._test = test
        self.recording = recording
        if recording:
            kept.pop(test, None)

    def of(self, question: str, ask: Callable[[], Any]) -> Any:
        """Return the answer to a question; when recording, ask for it.

        Args:
            question: a text that distinguishes it from the test's other questions.
            ask: asks the real ROS; its result becomes JSON.

        Raises:
            AssertionError: the answer was never recorded.
        """
        if self.recording:
            self.keep(question, ask())
        return self.recorded(question)

    async def once(self, question: str, ask: Callable[[], Awaitable[Any]], tries: int = 1) -> Any:
        """Return the answer to a question; when recording, ask up to `tries` times.

        What a real ROS does depends on which of its threads is faster. An answer that it still
        gives stays; the last one replaces an answer that it gives no more.

        Raises:
            AssertionError: the answer was never recorded.
        """
        if self.recording:
            before = self._before.get(shortened(question))
            for _ in range(tries):
                self.keep(question, await ask())
                if before is None or self.recorded(question) == before:
                    break
        return self.recorded(question)

    def keep(self, question: str, answer: Any) -> None:
        """Record an answer."""
        self._kept.setdefault(self._test, {})[shortened(question)] = json.loads(json.dumps(answer))

    def recorded(self, question: str) -> Any:
        """Return a recorded answer.

        Raises:
            AssertionError: there is none.
        """
        answers = self._kept.get(self._test, {})
        key = shortened(question)
        assert key in answers, f"no recorded answer to {key!r}: run `pytest --record-ros` with ROS"
        return answers[key]


def shortened(text: str) -> str:
    """Return a text; of a long one, its beginning and a digest, which are as good to compare."""
    if len(text) <= LONGEST:
        return text
    digest = hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:16]
    return f"{text[:LONGEST]}... {digest}"


class AnswerFiles:
    """The files of all test modules, read when first used, and written at the end if recording."""

    def __init__(self, *, recording: bool) -> None:
        self.recording = recording
        self._kept: dict[Path, Kept] = {}

    def answers(self, module: Path, test: str) -> Answers:
        """Return the answers of a test."""
        return Answers(self._of(answer_file(module)), test, recording=self.recording)

    def forget_all_but(self, module: Path, tests: Iterable[str]) -> None:
        """Remove the answers of tests that a module no longer has."""
        kept = self._of(answer_file(module))
        for test in kept.keys() - set(tests):
            del kept[test]

    def write(self) -> None:
        """Write the files that were recorded."""
        for path, kept in self._kept.items():
            path.parent.mkdir(exist_ok=True)
            text = json.dumps(kept, indent=1, sort_keys=True)
            path.write_text(f"{text}\n", "ascii")

    def _of(self, path: Path) -> Kept:
        if path not in self._kept:
            self._kept[path] = json.loads(path.read_text("ascii")) if path.exists() else {}
        return self._kept[path]


def answer_file(module: Path) -> Path:
    """Return the file with the answers of a test module."""
    return module.parent / "answers" / f"{module.stem}.json"


def add_option(parser: pytest.Parser) -> None:
    """Add ``--record-ros``."""
    parser.addoption(
        "--record-ros",
        action="store_true",
        help="run only the tests with recorded answers: ask the installed ROS, write its answers",
    )


def select_tests(config: pytest.Config, items: list[pytest.Item]) -> None:
    """When recording, keep all tests that have answers, each module's on one worker."""
    if not config.getoption("--record-ros"):
        return
    config.option.markexpr = ""  # The answers of those that are left out otherwise would be lost.
    asking = [item for item in items if "answers" in getattr(item, "fixturenames", ())]
    for item in asking:
        item.add_marker(pytest.mark.xdist_group(str(answer_file(item.path))))
    config.hook.pytest_deselected(items=[item for item in items if item not in set(asking)])
    items[:] = asking


@pytest.fixture(scope="session")
def answer_files(request: pytest.FixtureRequest) -> Iterable[AnswerFiles]:
    """The answers of all test modules."""
    files = AnswerFiles(recording=request.config.getoption("--record-ros"))
    yield files
    if not files.recording:
        return
    chosen_by_name = any("::" in each for each in request.config.args)
    by_module: dict[Path, list[str]] = {}
    for item in request.session.items:
        by_module.setdefault(item.path, []).append(item.name)
    if not chosen_by_name and not request.config.option.keyword:
        for module, tests in by_module.items():
            if answer_file(module) in files._kept:
                files.forget_all_but(module, tests)
    files.write()


@pytest.fixture
def answers(request: pytest.FixtureRequest, answer_files: AnswerFiles) -> Answers:
    """What the real ROS answered in this test."""
    return answer_files.answers(request.path, request.node.name)
