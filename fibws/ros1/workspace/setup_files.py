"""The files in devel/ that a shell sources to have a workspace's packages, as setup.bash."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path
from shlex import quote
from typing import NamedTuple

from fibws.ros1.shell import environment
from fibws.ros1.workspace.place import DEVEL, SOURCE
from fibws.ros1.workspace.tree import File, Tree

MODULES = "lib/python3/dist-packages"
"""Where in devel/ the Python packages are that setup.py names."""


class Entry(NamedTuple):
    """A folder that belongs on a path, at its end if the last one counts there."""

    variable: str
    folder: Path
    at_end: bool = False


def entries(source: Path, devel: Path) -> list[Entry]:
    """What puts one workspace on the paths."""
    return [
        Entry("ROS_PACKAGE_PATH", source),
        Entry("CMAKE_PREFIX_PATH", devel),
        Entry("PYTHONPATH", devel / MODULES),
        # Of two folders with one package the later one counts.
        Entry("FIBWS_INTERFACES", devel / "share", at_end=True),
    ]


def setup_files(workspace: Path, below: Sequence[tuple[Path, Path]] = ()) -> Tree:
    """The files that put a workspace on the paths, for all shells.

    Args:
        workspace: its folder.
        below: source and devel folders of other workspaces that it builds on, the farthest first.
    """
    places = [*below, (workspace / SOURCE, workspace / DEVEL)]
    all_entries = [entry for place in places for entry in entries(*place)]
    return {
        **{f"setup.{shell}": _file(_sh(shell, all_entries)) for shell in ("bash", "sh", "zsh")},
        # Windows' own PowerShell takes a text without the mark for one in the old code page.
        "setup.ps1": _file("\ufeff" + _powershell(all_entries)),
        "setup.bat": _file(_batch(all_entries).replace("\n", "\r\n")),
    }


def _file(text: str) -> File:
    return File(text.encode())


_SH = """\
# Made by catkin_make. It puts this workspace on the paths of a shell: {how}

eval "$({python} -P -m fibws setup {shell} --quiet)" || :

__fibws_put() {{  # VARIABLE FOLDER first|last: on the path there is the folder then, once
    eval "__fibws_path=\\":\\${{$1-}}:\\""
    while :; do
        case "$__fibws_path" in
            *":$2:"*) __fibws_path="${{__fibws_path%%":$2:"*}}:${{__fibws_path#*":$2:"}}" ;;
            *) break ;;
        esac
    done
    __fibws_path="${{__fibws_path#:}}"
    __fibws_path="${{__fibws_path%:}}"
    if [ "$3" = first ]; then
        export "$1=$2${{__fibws_path:+:$__fibws_path}}"
    else
        export "$1=${{__fibws_path:+$__fibws_path:}}$2"
    fi
}}
{lines}
unset -f __fibws_put
unset __fibws_path
"""


def _sh(shell: str, entries: Sequence[Entry]) -> str:
    word = "." if shell == "sh" else "source"
    return _SH.format(
        how=f"{word} devel/setup.{shell}",
        python=quote(sys.executable),
        shell=shell,
        lines="\n".join(
            f"__fibws_put {entry.variable} {quote(str(entry.folder))} "
            f"{'last' if entry.at_end else 'first'}"
            for entry in entries
        ),
    )


_POWERSHELL = """\
# Made by catkin_make. It puts this workspace on the paths of a PowerShell: . devel\\setup.ps1

function Add-FibwsFolder($Variable, $Folder, $AtEnd) {{
    $separator = [IO.Path]::PathSeparator
    $old = [Environment]::GetEnvironmentVariable($Variable)
    $others = @("$old".Split($separator) | Where-Object {{ $_ -and $_ -ne $Folder }})
    $all = if ($AtEnd) {{ $others + @($Folder) }} else {{ @($Folder) + $others }}
    [Environment]::SetEnvironmentVariable($Variable, ($all -join $separator))
}}
{variables}
{lines}
Remove-Item Function:\\Add-FibwsFolder
"""


_POWERSHELL_QUOTES = re.compile("['\u2018-\u201b]")
"""PowerShell takes curly quotation marks for straight ones."""


def _powershell(entries: Sequence[Entry]) -> str:
    def text(value: object) -> str:
        return "'" + _POWERSHELL_QUOTES.sub(r"\g<0>\g<0>", str(value)) + "'"

    return _POWERSHELL.format(
        variables="\n".join(
            f"$env:{name} = {text(value)}" for name, value in _fixed_variables().items()
        ),
        lines="\n".join(
            f"Add-FibwsFolder {entry.variable} {text(entry.folder)} "
            f"{'$true' if entry.at_end else '$false'}"
            for entry in [_rospy(), *entries]
        ),
    )


_BATCH = """\
@echo off
rem Made by catkin_make. It puts this workspace on the paths of cmd: call devel\\setup.bat
rem The names of folders are in UTF-8, which cmd has to be told for as long as it reads them.
for /f "tokens=2 delims=:." %%p in ('chcp') do set "FIBWS_CODE_PAGE=%%p"
chcp 65001 >nul

{variables}
{lines}

chcp %FIBWS_CODE_PAGE% >nul
set "FIBWS_CODE_PAGE="
"""


def _batch(entries: Sequence[Entry]) -> str:
    def text(value: object) -> str:
        return str(value).replace("%", "%%")

    lines = []
    for variable, folder, at_end in [_rospy(), *entries]:
        path = f"%{variable}%;{text(folder)}" if at_end else f"{text(folder)};%{variable}%"
        lines.append(
            f'echo ";%{variable}%;" | findstr /l /i /c:";{text(folder)};" >nul '
            f'|| set "{variable}={path}"'
        )
    return _BATCH.format(
        variables="\n".join(
            f'set "{name}={text(value)}"' for name, value in _fixed_variables().items()
        ),
        lines="\n".join(lines),
    )


def _rospy() -> Entry:
    return Entry("PYTHONPATH", environment.PYTHON_FOLDER)


def _fixed_variables() -> dict[str, str]:
    return {environment.PYTHON: sys.executable, **environment.OF_ROS}
