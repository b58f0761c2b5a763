"""The scripts that ``fibws setup`` prints, in the language that sh, bash, zsh and dash share."""

from __future__ import annotations

from shlex import quote

from fibws.command_names import ALIASES
from fibws.ros1.shell.environment import PYTHON, Changes

_FUNCTIONS = f"""\
if ! command -v roscd >/dev/null 2>&1; then
    __fibws_has_roscd=yes
    __fibws_folder() {{
        case ${{1-}} in
            */*) set -- "${{1%%/*}}" "/${{1#*/}}" ;;
            ?*) set -- "$1" "" ;;
            *)
                if [ -n "${{CMAKE_PREFIX_PATH-}}" ]; then
                    printf '%s\\n' "${{CMAKE_PREFIX_PATH%%:*}}"
                    return
                fi
                echo "Missing argument: PACKAGE or PACKAGE/FOLDER" >&2
                return 2
                ;;
        esac
        set -- "$("${PYTHON}" -P -m fibws pkg find "$1")" "$2"
        [ -n "$1" ] && printf '%s\\n' "$1$2"
    }}
    roscd() {{ set -- "$(__fibws_folder "${{1-}}")" && [ -n "$1" ] && cd "$1"; }}
    rosls() {{ set -- "$(__fibws_folder "${{1-}}")" && [ -n "$1" ] && ls "$1"; }}
fi
"""

_NO_FUNCTIONS = """\
if [ -n "${__fibws_has_roscd-}" ]; then
    unset -f roscd rosls __fibws_folder
    unset __fibws_has_roscd
fi
"""

_BASH = """\
if (( BASH_VERSINFO[0] * 100 + BASH_VERSINFO[1] >= 404 )); then
%(fibws)s
_fibws_alias_completion() {
    local words
    case ${1##*/} in
%(cases)s
    esac
    COMP_CWORD=$((COMP_CWORD + ${#words[@]}))
    COMP_WORDS=(fibws "${words[@]}" "${COMP_WORDS[@]:1}")
    _fibws_completion fibws
}
complete -o nosort -F _fibws_alias_completion %(aliases)s
fi
"""

_ZSH = """\
%(fibws)s
_fibws_alias_completion() {
    local -a command
    case $service in
%(cases)s
    esac
    (( CURRENT += $#command ))
    words=(fibws $command "${(@)words[2,-1]}")
    _fibws_completion
}
compdef _fibws_alias_completion %(aliases)s
"""


def set_up(changes: Changes, bash: str, zsh: str) -> str:
    """Return the script that gives a shell ROS 1's commands.

    Args:
        changes: of `fibws.ros1.shell.environment.set_up`.
        bash: bash's completion of ``fibws``.
        zsh: zsh's completion of ``fibws``.
    """
    bash = _BASH % _completion(bash, "words=({words})")
    zsh = _ZSH % _completion(zsh, "command=({words})")
    return f"""\
{assignments(changes)}{_FUNCTIONS}\
if [ -n "${{BASH_VERSION-}}" ]; then
    case $- in *i*) eval {quote(bash)} ;; esac
elif [ -n "${{ZSH_VERSION-}}" ]; then
    if command -v compdef >/dev/null; then eval {quote(zsh)}; fi
fi
"""


def undo(changes: Changes) -> str:
    """Return the script that undoes `set_up`.

    Args:
        changes: of `fibws.ros1.shell.environment.undo`.
    """
    aliases = " ".join(ALIASES)
    return f"""\
{assignments(changes)}{_NO_FUNCTIONS}\
if [ -n "${{BASH_VERSION-}}" ]; then
    complete -r {aliases} 2>/dev/null || :
elif [ -n "${{ZSH_VERSION-}}" ]; then
    if command -v compdef >/dev/null; then compdef -d {aliases}; fi
fi
"""


def assignments(changes: Changes) -> str:
    """Return the commands that set and unset variables."""
    return "".join(
        f"unset {name}\n" if value is None else f"export {name}={quote(value)}\n"
        for name, value in changes.items()
    )


def _completion(fibws: str, assignment: str) -> dict[str, str]:
    cases = [f"        {name}) {assignment.format(words=ALIASES[name])} ;;" for name in ALIASES]
    return {"fibws": fibws, "cases": "\n".join(cases), "aliases": " ".join(ALIASES)}
