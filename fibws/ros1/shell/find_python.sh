# Sets FIBWS_PYTHON to a Python with fibws, for the commands in bin/: the one of `fibws setup`, else
# the one that fibws was installed in, else the first on the PATH.
# $program is the command's own file; $0 may be a link to it.
fibws_has() { "$1" -P -c "import fibws" >/dev/null 2>&1; }
if [ -n "${FIBWS_PYTHON-}" ]; then
    if ! command -v "$FIBWS_PYTHON" >/dev/null; then
        echo "${0##*/}: FIBWS_PYTHON is $FIBWS_PYTHON, which does not exist. Where fibws is" \
            "installed, type: source <(fibws setup)" >&2
        exit 127
    fi
else
    for FIBWS_PYTHON in "${program%/*}/../../../../../../../bin/python3" python3 python ""; do
        if [ -n "$FIBWS_PYTHON" ] && fibws_has "$FIBWS_PYTHON"; then
            break
        fi
    done
    if [ -z "$FIBWS_PYTHON" ]; then
        echo "${0##*/}: no Python with fibws found. Where fibws is installed, type:" \
            "source <(fibws setup)" >&2
        exit 127
    fi
fi
