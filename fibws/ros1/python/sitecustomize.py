"""Python reads this at its start where this folder is on the PYTHONPATH, after ``fibws setup``.

It makes imports find messages, as `fibws.ros1.finder` does, but loads nothing for that until one of
ours is imported. Whatever Python has no fibws reads this, too, and must come to no harm: so even
Python 2 can read it.
"""

import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
FIBWS = os.path.dirname(os.path.dirname(HERE))
DEFINITIONS = os.path.join(FIBWS, "interfaces", "definitions")


class Awaiting:
    """Stands in for the finder until it is needed."""

    @staticmethod
    def find_spec(fullname, path=None, target=None):
        # type: (str, object, object) -> object
        """What the finder finds, if the module may be ours; Python calls this for every import.

        Raises:
            ModuleNotFoundError: it is ours, and this Python has no fibws.
        """
        if "." in fullname or not _may_be_ours(fullname):
            return None
        # A class with find_spec alone is a finder for Python, but not for what checks types.
        finders = sys.meta_path  # type: list[object] # type: ignore[assignment]
        if Awaiting in finders:  # It is not asked for what its own import takes.
            finders.remove(Awaiting)
        try:
            from fibws.ros1 import finder
        except ImportError as error:
            finders.insert(0, Awaiting)
            missing = ModuleNotFoundError(_advice(fullname, error), name=fullname)
            missing.__suppress_context__ = True
            raise missing  # noqa: B904 (Python 2 knows no "from None")
        finder.install()
        return finder.PackageFinder.find_spec(fullname)


def _may_be_ours(name):
    # type: (str) -> bool
    """Whether there is a module of this name here, or a folder that may hold definitions."""
    places = [HERE, DEFINITIONS]
    places += filter(None, os.environ.get("FIBWS_INTERFACES", "").split(os.pathsep))
    return any(
        os.path.isdir(os.path.join(place, name)) or os.path.basename(place) == name
        for place in places
    )


def _advice(name, error):
    # type: (str, ImportError) -> str
    fault = "No module named " + repr(name) + ": "
    if error.name not in ("fibws", "fibws.ros1", "fibws.ros1.finder"):
        return fault + str(error)
    python = os.environ.get("FIBWS_PYTHON", "the Python that fibws was installed in")
    return (
        fault + "this Python, " + sys.executable + ", has no fibws. Start the script by rosrun, "
        "or with " + python
    )


def _run_other():
    # type: () -> None
    """Run the sitecustomize that this one hides, if there is one."""
    from _frozen_importlib import module_from_spec
    from _frozen_importlib_external import PathFinder

    others = [place for place in sys.path if os.path.abspath(place) != HERE]
    spec = PathFinder.find_spec("sitecustomize", others)
    if spec is not None and spec.loader is not None:
        spec.loader.exec_module(module_from_spec(spec))


if sys.version_info >= (3, 7):  # noqa: UP036
    sys.meta_path.insert(0, Awaiting)  # type: ignore[arg-type]
    _run_other()
