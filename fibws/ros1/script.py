"""Runs a rospy script as Python does, in a process in which rospy can be imported."""

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

_original_main = sys.modules["__main__"]
"""Kept alive: a module without references loses its variables."""


def run_script(path: str | Path, arguments: Sequence[str] = ()) -> None:
    """Run a script as the module ``__main__``.

    Its errors are raised; their tracebacks begin in the script. Ctrl-C prints no traceback.

    Args:
        path: the script's file.
        arguments: its arguments in ``sys.argv``, after its path.

    Raises:
        SystemExit: the file cannot be read; the code is 2, as in Python. The reason is printed.
        BaseException: the script's error.
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
        sys.excepthook = _ScriptExcepthook(code, sys.excepthook)
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
        # For the Python processes that it starts.
        inherited = os.environ.get("PYTHONPATH")
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [modules, inherited]))
    finder.install()


class _ScriptExcepthook:
    """A `sys.excepthook` that omits fibws's functions from the script's traceback."""

    def __init__(self, code: CodeType | None, excepthook: Any) -> None:
        self._code = code
        self._excepthook = excepthook

    def __call__(
        self, kind: type[BaseException], error: BaseException, traceback: TracebackType | None
    ) -> None:
        if kind is KeyboardInterrupt and self._excepthook is sys.__excepthook__:
            if sys.stderr is not None and sys.stderr.isatty():
                print(file=sys.stderr)  # The shell's prompt belongs on the line after ^C.
            return
        traceback = self._script_part(error, traceback)
        self._excepthook(kind, error.with_traceback(traceback), traceback)

    def _script_part(
        self, error: BaseException, traceback: TracebackType | None
    ) -> TracebackType | None:
        """Return the part of a traceback from the script on."""
        # Programs that catkin_make writes to devel/ run another file, and set __file__ to it.
        file = getattr(sys.modules["__main__"], "__file__", None)
        part = _from(traceback, lambda code: code.co_filename == file)
        if part is None and getattr(error, "filename", None) != file:
            part = _from(traceback, lambda code: code is self._code)
        return part


def _from(
    traceback: TracebackType | None, is_first: Callable[[CodeType], bool]
) -> TracebackType | None:
    while traceback is not None and not is_first(traceback.tb_frame.f_code):
        traceback = traceback.tb_next
    return traceback
