"""Scripts run as Python would run them: each is run by both, and what they say is compared."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest
from patience import PATIENCE

import fibws
from fibws.ros1.shell.environment import PYTHON_FOLDER

OURS = [sys.executable, "-P", "-m", "fibws.rospy"]


class Said(NamedTuple):
    code: int
    out: str
    err: str


def run(command: list[str], folder: Path) -> Said:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE)
    return Said(done.returncode, done.stdout, done.stderr)


def by_both(folder: Path, source: str, *arguments: str) -> Said:
    """Return a script's output, which must be the same in plain Python and in fibws."""
    (folder / "script.py").write_text(source)
    plain = run([sys.executable, "script.py", *arguments], folder)
    ours = run([*OURS, "script.py", *arguments], folder)
    assert ours == plain
    return ours


def test_script_sees_itself_as_in_python(tmp_path: Path) -> None:
    source = '''\
"""What this is."""
import sys, inspect, beside

class Thing:
    pass

print(__name__, __file__, __doc__, __spec__, __package__, sys.argv, sys.path[0])
print(sys.modules["__main__"].Thing is Thing, inspect.getsource(Thing), beside.eight)
'''
    (tmp_path / "beside.py").write_text("eight = 8")
    said = by_both(tmp_path, source, "-x", "a:=b", "--help")
    assert said.code == 0, said.err
    assert "'script.py', '-x', 'a:=b', '--help'" in said.out


@pytest.mark.parametrize(
    ("source", "code"),
    [
        ("def f():\n    raise ValueError(8)\n\nf()\n", 1),
        ("try:\n    1 / 0\nexcept ZeroDivisionError as error:\n    raise KeyError from error\n", 1),
        ("if 8\n    pass\n", 1),
        ("import json\njson.loads('{')\n", 1),
        ("raise SystemExit(5)\n", 5),
        ("import sys\nsys.exit('This is why.')\n", 1),
        ("import sys\nsys.excepthook = lambda *error: print(*error[:2])\nraise ValueError(8)\n", 1),
        ("import atexit\natexit.register(print, 'bye')\nraise SystemExit\n", 0),
        (
            "import threading, time\n\ndef late():\n    time.sleep(0.05)\n    print(value)\n\n"
            "value = 8\nthreading.Thread(target=late).start()\n",
            0,
        ),
    ],
)
def test_script_ends_as_in_python(tmp_path: Path, source: str, code: int) -> None:
    assert by_both(tmp_path, source).code == code


def test_object_of_a_script_class_can_be_pickled(tmp_path: Path) -> None:
    source = (
        "import pickle\n\nclass Thing:\n    pass\n\n"
        "print(type(pickle.loads(pickle.dumps(Thing()))))\n"
    )
    assert by_both(tmp_path, source).out == "<class '__main__.Thing'>\n"


def test_declared_encoding_of_a_script_is_used(tmp_path: Path) -> None:
    script = tmp_path / "latin.py"
    script.write_bytes("# -*- coding: latin-1 -*-\nprint(len('é'))\n".encode("latin-1"))
    assert run([*OURS, str(script)], tmp_path) == (0, "1\n", "")


def test_script_imports_from_its_own_folder(
    tmp_path: Path,
) -> None:
    nodes, here = tmp_path / "nodes", tmp_path / "here"
    for folder, text in ((nodes, "beside the script"), (here, "where one is")):
        folder.mkdir()
        (folder / "place.py").write_text(f"name = {text!r}")
    (nodes / "script.py").write_text("import place; print(place.name)")
    for options in ([], ["-P"]):
        command = [sys.executable, *options, "-m", "fibws.rospy", "../nodes/script.py"]
        assert run(command, here) == (0, "beside the script\n", "")


def test_rospy_and_messages_can_be_imported(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(
        "import rospy\nfrom std_msgs.msg import Int32\nprint(rospy.__file__)\nprint(Int32(8))\n"
    )
    said = run([*OURS, "script.py"], tmp_path)
    assert said.code == 0, said.err
    assert said.out == f"{PYTHON_FOLDER / 'rospy' / '__init__.py'}\ndata: 8\n"


def test_python_processes_of_a_script_find_rospy(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(
        "import subprocess, sys\n"
        "code = 'import rospy; from std_msgs.msg import Int32; print(Int32(8))'\n"
        "subprocess.run([sys.executable, '-c', code], check=True)\n"
    )
    assert run([*OURS, "script.py"], tmp_path) == (0, "data: 8\n", "")


def test_missing_script_is_reported_in_one_line(tmp_path: Path) -> None:
    said = run([*OURS, "script.py"], tmp_path)
    assert (said.code, said.out) == (2, "")
    where = tmp_path.resolve() / "script.py"
    assert said.err == f"fibws.rospy: cannot open {where}: No such file or directory\n"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for others")
def test_ctrl_c_ends_a_script_without_a_traceback(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(
        "import time\nprint('waiting', flush=True)\ntime.sleep(60)\n"
    )
    with subprocess.Popen(
        [*OURS, "script.py"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "waiting\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, out, err) == (-signal.SIGINT, "", "")


def test_folder_of_fibws_is_not_on_the_module_path(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text("import sys; print(*sys.path, sep='\\n')")
    folders = run([*OURS, "script.py"], tmp_path).out.splitlines()
    assert str(Path(fibws.__file__).parent) not in folders
    assert folders[:2] == [str(tmp_path.resolve()), str(PYTHON_FOLDER)]
