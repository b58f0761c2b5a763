"""Text for ``source``, in sh's language as bash, zsh and dash have it in common."""

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
                echo "Write PACKAGE or PACKAGE/FOLDER." >&2
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
_fibws_door_completion() {
    local words
    case ${1##*/} in
%(cases)s
    esac
    COMP_CWORD=$((COMP_CWORD + ${#words[@]}))
    COMP_WORDS=(fibws "${words[@]}" "${COMP_WORDS[@]:1}")
    _fibws_completion fibws
}
complete -o nosort -F _fibws_door_completion %(doors)s
fi
"""

_ZSH = """\
%(fibws)s
_fibws_door_completion() {
    local -a door
    case $service in
%(cases)s
    esac
    (( CURRENT += $#door ))
    words=(fibws $door "${(@)words[2,-1]}")
    _fibws_completion
}
compdef _fibws_door_completion %(doors)s
"""


def assignments(changes: Changes) -> str:
    """The commands that give variables their new values."""
    return "".join(
        f"unset {name}\n" if value is None else f"export {name}={quote(value)}\n"
        for name, value in changes.items()
    )


def begin(changes: Changes, bash: str, zsh: str) -> str:
    """All that a shell needs in which fibws stands in for ROS 1.

    Args:
        changes: of `fibws.ros1.shell.environment.set_up`.
        bash: what completes ``fibws`` in bash.
        zsh: what does so in zsh.
    """
    bash = _BASH % _completed(bash, "words=({words})")
    zsh = _ZSH % _completed(zsh, "door=({words})")
    return f"""\
{assignments(changes)}{_FUNCTIONS}\
if [ -n "${{BASH_VERSION-}}" ]; then
    case $- in *i*) eval {quote(bash)} ;; esac
elif [ -n "${{ZSH_VERSION-}}" ]; then
    if command -v compdef >/dev/null; then eval {quote(zsh)}; fi
fi
"""


def end(changes: Changes) -> str:
    """What takes `begin` back.

    Args:
        changes: of `fibws.ros1.shell.environment.undo`.
    """
    doors = " ".join(ALIASES)
    return f"""\
{assignments(changes)}{_NO_FUNCTIONS}\
if [ -n "${{BASH_VERSION-}}" ]; then
    complete -r {doors} 2>/dev/null || :
elif [ -n "${{ZSH_VERSION-}}" ]; then
    if command -v compdef >/dev/null; then compdef -d {doors}; fi
fi
"""


def _completed(fibws: str, assignment: str) -> dict[str, str]:
    cases = [f"        {door}) {assignment.format(words=ALIASES[door])} ;;" for door in ALIASES]
    return {"fibws": fibws, "cases": "\n".join(cases), "doors": " ".join(ALIASES)}
