"""Descriptions of parameters, written in Python: ``.cfg`` files.

    gen = ParameterGenerator()
    gen.add("size", int_t, 0, "How large it is", 5, 0, 10)
    exit(gen.generate("my_package", "my_node", "Tutorials"))

`catkin_make` runs these files, and so writes the module ``my_package.cfg.TutorialsConfig``.
"""

from __future__ import annotations

import inspect
import math
import os
import re
import sys
from typing import Any

__all__ = ["ParameterGenerator", "bool_t", "check_description", "check_name", "double_t"]
__all__ += ["int_t", "str_t"]

str_t = "str"
bool_t = "bool"
int_t = "int"
double_t = "double"

_PYTHON: dict[str, Any] = {str_t: str, bool_t: bool, int_t: int, double_t: float}
_DEFAULTS: dict[str, Any] = {str_t: "", bool_t: False, int_t: 0, double_t: 0}
_LEAST: dict[str, Any] = {str_t: "", bool_t: False, int_t: -(2**31), double_t: -math.inf}
_MOST: dict[str, Any] = {str_t: "", bool_t: True, int_t: 2**31 - 1, double_t: math.inf}
_CPP = {str_t: "std::string", bool_t: "bool", int_t: "int", double_t: "double"}
_CPP_CONSTANT = {name: f"const {cpp}" for name, cpp in _CPP.items()}
_CPP_CONSTANT[str_t] = "const char * const"
_NAME = re.compile(r"[a-zA-Z][a-zA-Z0-9_]*")

_MODULE = """\
# Generated from {name}.cfg of the package {package}: a change here is lost.

from dynamic_reconfigure.encoding import extract_params

inf = float("inf")

config_description = {description}

min = {{}}
max = {{}}
defaults = {{}}
level = {{}}
type = {{}}
all_level = 0

for param in extract_params(config_description):
    min[param["name"]] = param["min"]
    max[param["name"]] = param["max"]
    defaults[param["name"]] = param["default"]
    level[param["name"]] = param["level"]
    type[param["name"]] = param["type"]
    all_level = all_level | param["level"]

{constants}"""


def check_description(description: str) -> None:
    """Raise an error if a description has quotes, which C++ could not take."""
    if "'" in description or '"' in description:
        raise ValueError(f"quotes not allowed in description string `{description}`")


def check_name(name: str) -> None:
    """Raise an error if a parameter's name has other characters than letters, digits and _."""
    if not _NAME.fullmatch(name):
        raise ValueError(
            f"The name of field '{name}' does not follow the ROS naming conventions, "
            "see http://wiki.ros.org/ROS/Patterns/Conventions"
        )


def _place() -> dict[str, Any]:
    """Return the line of a .cfg file from which one of the functions here was called."""
    frame: Any = inspect.currentframe()
    while frame.f_back is not None and frame.f_code.co_filename == __file__:
        frame = frame.f_back
    return {"srcline": frame.f_lineno, "srcfile": os.path.basename(frame.f_code.co_filename)}


def _converted(name: str, type_: str, field: str, value: Any) -> Any:
    """Return a value as its parameter's type."""
    python = _PYTHON[type_]
    if type(value) is not python and not (python is float and type(value) is int):
        raise TypeError(f"'{name}' has type {type_}, but {field} is {value!r}")
    return python(value)


class _Group:
    """A group of parameters, and of groups."""

    def __init__(
        self, gen: ParameterGenerator, name: str, type_: str, state: bool, parent: _Group | None
    ) -> None:
        self.gen = gen
        self.name = name.replace(" ", "_")
        self.type = type_
        self.state = state
        self.id = gen.take_id()
        self.parent = parent.id if parent is not None else 0
        self.groups: list[_Group] = []
        self.parameters: list[dict[str, Any]] = []
        self._parent = parent
        self._place = _place()

    def add_group(self, name: str, type: str = "", state: bool = True) -> _Group:
        """Add a group, and return it.

        Args:
            type: how it is shown: "", "collapse", "tab" or "hide".
            state: whether it is open.
        """
        group = _Group(self.gen, name, type, state, self)
        self.groups.append(group)
        return group

    def add(
        self,
        name: str,
        paramtype: str,
        level: int,
        description: str,
        default: Any = None,
        min: Any = None,
        max: Any = None,
        edit_method: str = "",
    ) -> None:
        """Add a parameter.

        Args:
            paramtype: ``int_t``, ``double_t``, ``str_t`` or ``bool_t``.
            level: a bit mask; the server's callback gets the levels of all that has changed.
            edit_method: what `ParameterGenerator.enum` returns, or nothing.

        Raises:
            ValueError: the name is invalid, or a text or a bool has a range.
            TypeError: a value is not of the type.
        """
        if paramtype not in _PYTHON:
            raise ValueError(f"'{name}': unknown type {paramtype!r}; one of {', '.join(_PYTHON)}")
        if paramtype in (str_t, bool_t) and not (min is None and max is None):
            raise ValueError(f"Max or min specified for {name}, which is of '{paramtype}' type")
        check_name(name)
        values: dict[str, Any] = {}
        for field, value, otherwise in (
            ("default", default, _DEFAULTS),
            ("max", max, _MOST),
            ("min", min, _LEAST),
        ):
            given = value is not None
            values[field] = (
                _converted(name, paramtype, field, value) if given else otherwise[paramtype]
            )
        self.parameters.append(
            {
                "name": name,
                "type": paramtype,
                "default": values["default"],
                "level": level,
                "description": description,
                "min": values["min"],
                "max": values["max"],
                **_place(),
                "edit_method": edit_method,
                "ctype": _CPP[paramtype],
                "cconsttype": _CPP_CONSTANT[paramtype],
            }
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the description of the group."""
        names = self._names()
        around = names[:-1]
        return {
            "name": self.name,
            "type": self.type,
            "state": self.state,
            "cstate": "true" if self.state else "false",
            "id": self.id,
            "parent": self.parent,
            "parameters": self.parameters,
            "groups": [group.to_dict() for group in self.groups],
            **self._place,
            "class": "::".join(names).upper(),
            "parentclass": "::".join(around).upper(),
            "parentname": self._parent.name if self._parent is not None else self.name,
            "field": "::".join([*(name.upper() for name in around), self.name.lower()]),
            "upper": self.name.upper(),
            "lower": "groups" if self._parent is None else self.name.lower(),
        }

    def _names(self) -> list[str]:
        return [*(self._parent._names() if self._parent is not None else ()), self.name]


class ParameterGenerator:
    """Collects the parameters of a .cfg file.

    Raises:
        SystemExit: the file was not run by `catkin_make`.
    """

    Group = _Group

    def __init__(self) -> None:
        if len(sys.argv) < 5:
            raise SystemExit(
                f"{sys.argv[0]}: catkin_make runs this file: name it in CMakeLists.txt with "
                "generate_dynamic_reconfigure_options(). See "
                "http://wiki.ros.org/dynamic_reconfigure/Tutorials"
            )
        self.dynconfpath, self.binary_dir, self.cpp_gen_dir, self.py_gen_dir = sys.argv[1:5]
        self.constants: list[dict[str, Any]] = []
        self._ids = 0
        self.group = _Group(self, "Default", "", True, None)

    def take_id(self) -> int:
        """Return the id of a new group."""
        self._ids += 1
        return self._ids - 1

    def const(self, name: str, type: str, value: Any, descr: str) -> dict[str, Any]:
        """Add a constant, and return it, for `enum`; raises as `add`."""
        check_description(descr)
        constant = {
            "name": name,
            "type": type,
            "value": _converted(name, type, "value", value),
            **_place(),
            "description": descr,
            "ctype": _CPP[type],
            "cconsttype": _CPP_CONSTANT[type],
        }
        self.constants.append(constant)
        return constant

    def enum(self, constants: list[dict[str, Any]], description: str) -> str:
        """Return the edit method of a parameter that is one of some constants."""
        if len({constant["type"] for constant in constants}) != 1:
            raise ValueError("Inconsistent types in enum!")
        check_description(description)
        return repr({"enum": constants, "enum_description": description})

    def add(
        self,
        name: str,
        paramtype: str,
        level: int,
        description: str,
        default: Any = None,
        min: Any = None,
        max: Any = None,
        edit_method: str = "",
    ) -> None:
        """Add a parameter to the default group; see `Group.add`."""
        self.group.add(name, paramtype, level, description, default, min, max, edit_method)

    def add_group(self, name: str, type: str = "", state: bool = True) -> _Group:
        """Add a group, and return it; see `Group.add_group`."""
        return self.group.add_group(name, type, state)

    def generate(self, pkgname: str, nodename: str, name: str) -> int:
        """Write the module.

        Args:
            nodename: has no meaning.
            name: that of the file without ``.cfg``.

        Returns:
            0, for `exit`.
        """
        self.pkgname, self.nodename, self.name = pkgname, nodename, name
        print(f"Generating reconfiguration files for {name} in {pkgname}")
        text = _MODULE.format(
            name=name,
            package=pkgname,
            description=self.group.to_dict(),
            constants="".join(
                f"{name}_{each['name']} = {each['value']!r}\n" for each in self.constants
            ),
        )
        folder = os.path.join(self.py_gen_dir, "cfg")
        os.makedirs(folder, exist_ok=True)
        with open(os.path.join(folder, f"{name}Config.py"), "w", encoding="utf-8") as file:
            file.write(text)
        return 0
