"""`catkin_make` runs .cfg files, which write modules of dynamic_reconfigure."""

from __future__ import annotations

import os
import runpy
import subprocess
import sys
from typing import Any

import pytest

from fibws.ros1.workspace import reconfigure

from .conftest import Layout

HEAD = "from dynamic_reconfigure.parameter_generator_catkin import *\ngen = ParameterGenerator()\n"
END = 'exit(gen.generate("robot", "node", "{name}"))\n'
TUTORIALS = f"""\
#!/usr/bin/env python
{HEAD}
gen.add("size", int_t, 1, "A size", 5, 0, 10)
gen.add("ratio", double_t, 2, "A ratio")
gen.add("name", str_t, 4, "A name", "Hello")
gen.add("active", bool_t, 8, "Whether", True)
kinds = gen.enum(
    [gen.const("Small", int_t, 0, "A small one"), gen.const("Large", int_t, 1, "A large one")],
    "Kinds",
)
gen.add("kind", int_t, 0, "A kind", 1, 0, 1, edit_method=kinds)
group = gen.add_group("Second Group", type="collapse", state=False)
deep = group.add_group("Deep")
deep.add("inner", double_t, 16, "Inner", 2, max=3.5)
{END.format(name="Tutorials")}"""


def package(layout: Layout, **files: str) -> None:
    names = " ".join(f"cfg/{name}.cfg" for name in files)
    layout.package(
        "robot",
        before=f"generate_dynamic_reconfigure_options({names})",
        files={f"cfg/{name}.cfg": text for name, text in files.items()},
    )


def module(layout: Layout, name: str) -> dict[str, Any]:
    """Build the workspace, and return the content of a module."""
    assert layout.errors() == []
    path = layout.devel / "lib/python3/dist-packages/robot/cfg" / f"{name}Config.py"
    return runpy.run_path(str(path))


def test_module_has_the_parameters_of_the_file(layout: Layout) -> None:
    package(layout, Tutorials=TUTORIALS, Other=HEAD + END.format(name="Other"))
    made = module(layout, "Tutorials")
    inf = float("inf")
    assert made["defaults"] == {
        "size": 5,
        "ratio": 0,
        "name": "Hello",
        "active": True,
        "kind": 1,
        "inner": 2.0,
    }
    assert made["min"]["size"] == 0 and made["max"]["size"] == 10
    assert (made["min"]["ratio"], made["max"]["ratio"]) == (-inf, inf)
    assert (made["min"]["inner"], made["max"]["inner"]) == (-inf, 3.5)
    assert made["all_level"] == 31 and made["level"]["name"] == 4
    assert made["type"]["active"] == "bool"
    assert (made["Tutorials_Small"], made["Tutorials_Large"]) == (0, 1)
    (group,) = made["config_description"]["groups"]
    assert (group["name"], group["type"], group["state"]) == ("Second_Group", "collapse", False)
    (deep,) = group["groups"]
    assert (deep["id"], deep["parent"], deep["class"]) == (2, 1, "DEFAULT::SECOND_GROUP::DEEP")
    assert deep["parameters"][0]["srcfile"] == "Tutorials.cfg"
    other = layout.devel / "lib/python3/dist-packages/robot/cfg/OtherConfig.py"
    assert other.is_file()


@pytest.mark.parametrize(
    ("line", "facts"),
    [
        ("gen.add('a b', int_t, 0, '')", ("a b", "naming")),
        ("gen.add('a', int_t, 0, '', 'five')", ("a", "int", "default", "five")),
        ("gen.add('a', str_t, 0, '', 'b', max='c')", ("a", "str", "Max")),
        ("gen.add('a', 'float', 0, '')", ("a", "float", "double")),
        ("gen.const('A', int_t, 1, 'the \"first\"')", ("quotes",)),
        ("gen.enum([gen.const('A', int_t, 1, ''), gen.const('B', str_t, '', '')], '')", ("enum",)),
        ("undefined", ("undefined",)),
    ],
)
def test_invalid_file_is_an_error_with_its_line(
    layout: Layout, line: str, facts: tuple[str, ...]
) -> None:
    package(layout, Bad=f"{HEAD}{line}\n{END.format(name='Bad')}")
    (error,) = layout.plan().errors
    text = layout.relative(str(error))
    assert text.startswith("robot/cfg/Bad.cfg, line 3: ")
    assert all(fact in text for fact in facts)


SETUP = """\
from setuptools import setup
from catkin_pkg.python_setup import generate_distutils_setup
setup(**generate_distutils_setup(packages=["{name}"], package_dir={{"": "src"}}))
"""


def test_file_imports_modules_of_this_and_other_packages(layout: Layout) -> None:
    """As DWAPlanner.cfg of navigation does: it imports a module of base_local_planner."""
    layout.package(
        "limits",
        before="catkin_python_setup()",
        files={
            "setup.py": SETUP.format(name="limits"),
            "src/limits/__init__.py": "def add(gen): gen.add('limit', 'double', 0, 'A limit', 0.5)",
        },
    )
    imports = "import limits, robot.names\nlimits.add(gen)\n"
    layout.package(
        "robot",
        "limits",
        before="catkin_python_setup()\ngenerate_dynamic_reconfigure_options(cfg/Plan.cfg)",
        files={
            "setup.py": SETUP.format(name="robot"),
            "src/robot/__init__.py": "",
            "src/robot/names.py": "",
            "cfg/Plan.cfg": f"{HEAD}{imports}{END.format(name='Plan')}",
        },
    )
    assert module(layout, "Plan")["defaults"] == {"limit": 0.5}


def test_package_has_a_cfg_module_of_its_own(layout: Layout) -> None:
    """The generated package comes first, as in catkin's __path__: rbx1_nav has both."""
    layout.package(
        "robot",
        before="catkin_python_setup()\ngenerate_dynamic_reconfigure_options(cfg/Plan.cfg)",
        files={
            "setup.py": SETUP.format(name="robot"),
            "src/robot/__init__.py": "",
            "src/robot/cfg/__init__.py": "",
            "src/robot/other.py": "",
            "cfg/Plan.cfg": f"{HEAD}{END.format(name='Plan')}",
        },
    )
    assert module(layout, "Plan")["defaults"] == {}
    program = layout.folder / "program.py"
    text = "import robot.other\nfrom robot.cfg import PlanConfig\nprint(PlanConfig.defaults)"
    program.write_text(text)
    modules = str(layout.devel / "lib/python3/dist-packages")
    done = subprocess.run(
        [sys.executable, "-m", "fibws.rospy", str(program)],
        env={**os.environ, "PYTHONPATH": modules},
        capture_output=True,
        text=True,
    )
    assert (done.stdout, done.stderr) == ("{}\n", "")


def test_file_that_writes_no_module_is_an_error(layout: Layout) -> None:
    package(layout, Bad=HEAD)
    (error,) = layout.plan().errors
    assert "gen.generate" in str(error)


def test_file_that_does_not_end_is_an_error(
    layout: Layout, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reconfigure, "TIMEOUT", 0.5)
    package(layout, Bad="while True: pass\n")
    (error,) = layout.plan().errors
    assert "0.5 s" in str(error)
