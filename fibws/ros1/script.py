"""Runs a rospy script as Python would run it, in a process where rospy can be imported."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable, Sequence
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType, TracebackType
from typing import Any

from fibws.ros1 import finder
from fibws.ros1.shell import environment

_ours = sys.modules["__main__"]
"""Is kept: a module that nobody knows any more loses its variables."""


def run_script(path: str | Path, arguments: Sequence[str] = ()) -> None:
    """Run a script as the program ``__main__``, and return when it has come to its end.

    What it raises is raised, and then told by Python as if nothing of ours had been between. Ctrl-C
    ends it without a traceback.

    Args:
        path: the script's file.
        arguments: what it finds in ``sys.argv``, behind its path.

    Raises:
        SystemExit: the file cannot be read, which has been told then; the code is Python's own, 2.
        BaseException: what the script raises.
    """
    file = os.path.abspath(path)
    try:
        with io.open_code(file) as opened:
            source = opened.read()
    except OSError as error:
        print(f"fibws.rospy: cannot open {file}: {error.strerror}", file=sys.stderr)
        sys.exit(2)
    _prepare(file, [os.fspath(path), *arguments])
    code = None
    try:
        code = compile(source, file, "exec", dont_inherit=True)
        exec(code, sys.modules["__main__"].__dict__)
    except BaseException:
        sys.excepthook = _Telling(code, sys.excepthook)
        raise


def _prepare(file: str, argv: list[str]) -> None:
    main = ModuleType("__main__")
    main.__dict__.update(
        __file__=file, __builtins__=__builtins__, __loader__=SourceFileLoader("__main__", file)
    )
    sys.modules["__main__"] = main
    sys.argv[:] = argv
    folder = os.path.dirname(os.path.realpath(file))
    if sys.flags.safe_path:
        sys.path.insert(0, folder)
    else:
        sys.path[0] = folder
    modules = os.fspath(environment.PYTHON_FOLDER)
    if modules not in sys.path:
        sys.path.insert(1, modules)
        # Other Pythons that it starts have their rospy there, too.
        inherited = os.environ.get("PYTHONPATH")
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [modules, inherited]))
    finder.install()


class _Telling:
    """Tells of what has ended the script, with the traceback from the script on.

    It stands for `sys.excepthook` at the very end, when Python has left our functions.
    """

    def __init__(self, code: CodeType | None, tell: Any) -> None:
        self._code = code
        self._tell = tell

    def __call__(
        self, kind: type[BaseException], error: BaseException, traceback: TracebackType | None
    ) -> None:
        if kind is KeyboardInterrupt and self._tell is sys.__excepthook__:
            if sys.stderr is not None and sys.stderr.isatty():
                print(file=sys.stderr)  # The shell's prompt must not stand behind the ^C.
            return
        traceback = self._own(error, traceback)
        self._tell(kind, error.with_traceback(traceback), traceback)

    def _own(self, error: BaseException, traceback: TracebackType | None) -> TracebackType | None:
        """The part of a traceback that is the script's own."""
        # What catkin_make has put into devel/ runs another file, and says so.
        file = getattr(sys.modules["__main__"], "__file__", None)
        own = _from(traceback, lambda code: code.co_filename == file)
        if own is None and getattr(error, "filename", None) != file:
            own = _from(traceback, lambda code: code is self._code)
        return own


def _from(
    traceback: TracebackType | None, is_first: Callable[[CodeType], bool]
) -> TracebackType | None:
    while traceback is not None and not is_first(traceback.tb_frame.f_code):
        traceback = traceback.tb_next
    return traceback
