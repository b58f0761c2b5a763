"""Python runs this at its start if this folder is on the PYTHONPATH, after ``fibws setup``.

It installs `fibws.ros1.finder` when a module of fibws is first imported, and loads nothing before.
Pythons without fibws, even Python 2, run this, too, and must not fail.
"""

import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
FIBWS = os.path.dirname(os.path.dirname(HERE))
DEFINITIONS = os.path.join(FIBWS, "interfaces", "definitions")
FALLBACK = os.path.join(FIBWS, "ros1", "fallback")


class Awaiting:
    """A placeholder for the finder until it is needed."""

    @staticmethod
    def find_spec(fullname, path=None, target=None):
        # type: (str, object, object) -> object
        """Return the finder's spec for a module of fibws; Python calls this for each import.

        Raises:
            ModuleNotFoundError: it is a module of fibws, which this Python does not have.
        """
        if "." in fullname or not _may_be_from_fibws(fullname):
            return None
        # Python accepts a class with only find_spec as a finder; type checkers do not.
        finders = sys.meta_path  # type: list[object] # type: ignore[assignment]
        if Awaiting in finders:  # The imports below must not call it.
            finders.remove(Awaiting)
        try:
            from fibws.ros1 import finder
        except ImportError as error:
            finders.insert(0, Awaiting)
            missing = ModuleNotFoundError(_advice(fullname, error), name=fullname)
            missing.__suppress_context__ = True
            raise missing  # noqa: B904 (Python 2 has no "from None")
        finder.install()
        return finder.PackageFinder.find_spec(fullname)


def _may_be_from_fibws(name):
    # type: (str) -> bool
    """Return whether this folder has the module, or another folder may define its messages.

    A module in `FALLBACK` is used only if no other folder on the path has it.
    """
    if os.path.isdir(os.path.join(FALLBACK, name)):
        from _frozen_importlib_external import PathFinder

        return PathFinder.find_spec(name) is None
    folders = [HERE, DEFINITIONS]
    folders += filter(None, os.environ.get("FIBWS_INTERFACES", "").split(os.pathsep))
    return any(
        os.path.isdir(os.path.join(folder, name)) or os.path.basename(folder) == name
        for folder in folders
    )


def _advice(name, error):
    # type: (str, ImportError) -> str
    text = "No module named " + repr(name) + ": "
    if error.name not in ("fibws", "fibws.ros1", "fibws.ros1.finder"):
        return text + str(error)
    python = os.environ.get("FIBWS_PYTHON", "the Python that fibws was installed in")
    return (
        text
        + "fibws is not installed in "
        + sys.executable
        + ". Run the script with rosrun, or with "
        + python
    )


def _run_other():
    # type: () -> None
    """Run the sitecustomize that this one hides, if it exists."""
    from _frozen_importlib import module_from_spec
    from _frozen_importlib_external import PathFinder

    others = [folder for folder in sys.path if os.path.abspath(folder) != HERE]
    spec = PathFinder.find_spec("sitecustomize", others)
    if spec is not None and spec.loader is not None:
        spec.loader.exec_module(module_from_spec(spec))


if sys.version_info >= (3, 7):  # noqa: UP036
    sys.meta_path.insert(0, Awaiting)  # type: ignore[arg-type]
    _run_other()
