# Finds the Python that has fibws, for the commands in bin/: it is told by FIBWS_PYTHON after
# `source <(fibws setup)`, or else is the one that this was installed with, or the PATH's.
# $door is the command's own file, to which $0 may be a link.
fibws_has() { "$1" -P -c "import fibws" >/dev/null 2>&1; }
if [ -n "${FIBWS_PYTHON-}" ]; then
    if ! command -v "$FIBWS_PYTHON" >/dev/null; then
        echo "${0##*/}: FIBWS_PYTHON is $FIBWS_PYTHON, which is not there. Set up again where fibws" \
            "is installed: source <(fibws setup)" >&2
        exit 127
    fi
else
    for FIBWS_PYTHON in "${door%/*}/../../../../../../../bin/python3" python3 python ""; do
        if [ -n "$FIBWS_PYTHON" ] && fibws_has "$FIBWS_PYTHON"; then
            break
        fi
    done
    if [ -z "$FIBWS_PYTHON" ]; then
        echo "${0##*/}: No Python with fibws is found here. Where fibws is installed, type:" \
            "source <(fibws setup)" >&2
        exit 127
    fi
fi
