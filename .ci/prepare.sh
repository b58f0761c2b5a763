# Sourced by .ci/run and .ci/all: a new virtual environment with the locked versions.

# Install Debian packages if any is missing.
debian() {
    dpkg --status "$@" >/dev/null 2>&1 && return
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null
}

# Print a heading with the time since the start.
part() {
    printf '\n== %s (%d:%02d)\n' "$1" $((SECONDS / 60)) $((SECONDS % 60))
}

# Run a command in the background, with its output in a file until `finish` prints it.
begin() {
    local name=$1
    shift
    "$@" >"$temporary/$name" 2>&1 &
    running[$name]=$!
}

# Wait for a command that `begin` has started; fail if it failed.
finish() {
    local code=0
    wait "${running[$1]}" || code=$?
    part "$1"
    cat "$temporary/$1"
    return "$code"
}

declare -A running
temporary=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; rm -rf "$temporary"' EXIT
# Without bytecode, each of the many programs that the tests start would compile fibws again.
unset PYTHONDONTWRITEBYTECODE
export CI=true PIP_CONSTRAINT=$PWD/constraints.txt PIP_BUILD_CONSTRAINT=$PWD/constraints.txt

install() {
    python3 -m venv "$temporary/venv"
    export PATH="$temporary/venv/bin:$PATH"
    # The pip of Python 3.11 takes twice the time: it compares all files of all versions.
    python -m pip install --quiet --upgrade pip==26.3
    # Of the packages, only what is imported is compiled, when it first is.
    python -m pip install --quiet --no-compile -e '.[dev]'
    python -m compileall -q -j 0 fibws tests
}

check_page() {
    npm --prefix web ci --silent && npm --prefix web run --silent check &&
        npm --prefix web test --silent
}

lint() {
    ruff check . && ruff format --check . && mypy
}
