#!/bin/sh
# bootstrap.sh PYTHON VENV: check what only the system can provide, then make the virtual
# environment VENV. Whatever is missing is said in one line with the command that installs it. Only
# LCM's glib is installed by apt-get, where root asks: a bare system has all else.
set -eu
python=$1
venv=$2

fail() {
    echo "saddlewalk: $*" >&2
    exit 1
}

command -v "$python" >/dev/null ||
    fail "$python is missing; as root: apt-get install -y python3 python3-venv"
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
    fail "$("$python" --version) is too old: 3.11 or newer is needed, name one with make PYTHON=..."

missing=''
packages=''
need() {
    missing="$missing${missing:+, }$1"
    packages="$packages $2"
}
has_glib() {
    "$python" -c 'import ctypes; ctypes.CDLL("libglib-2.0.so.0")' 2>/dev/null
}
may_install() {
    [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null
}
install() {
    echo "saddlewalk: libglib-2.0 (for LCM) is missing: installing $1 by apt-get, as root"
    apt-get install -qq -y "$1" >/dev/null 2>&1 ||
        { apt-get update -qq && apt-get install -qq -y "$1"; } >/dev/null 2>&1
}
"$python" -c 'import ensurepip, venv' 2>/dev/null || need "python's venv module" python3-venv
printf '#include <stdio.h>\nint main(void) { return 0; }\n' |
    "${CC:-cc}" -x c - -o /dev/null 2>/dev/null || need 'a C compiler' 'gcc libc6-dev'
has_glib || { may_install && install libglib2.0-0 && has_glib; } ||
    need 'libglib-2.0 (for LCM)' libglib2.0-0
[ -z "$missing" ] || fail "missing: $missing; as root: apt-get install -y$packages"

"$python" -m venv --clear "$venv"
