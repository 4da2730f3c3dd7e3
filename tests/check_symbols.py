"""A library needs nothing but sqrtf and keeps no globals: its archive's symbols must say so.

usage: check_symbols.py NM ARCHIVE

A libc call, a hidden double operation on a target without doubles, or a variable outside the
caller's context shows up here by name.
"""

import subprocess
import sys

# __stack_chk_fail: some distributions' compilers harden every function with it by default.
ALLOWED = {"sqrtf", "__stack_chk_fail", "_GLOBAL_OFFSET_TABLE_"}


def symbols(nm: str, archive: str) -> list[tuple[str, str, str]]:
    """(name, nm's class letter, section) of every symbol in every member."""
    command = [nm, "--format=sysv", archive]
    lines = subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE).stdout
    rows = [[cell.strip() for cell in line.split("|")] for line in lines.splitlines()]
    return [(row[0], row[2], row[6]) for row in rows if len(row) == 7]


def is_variable(kind: str, section: str) -> bool:
    """Constants that hold addresses lie in .data.rel.ro: written by the loader, then read-only."""
    return kind in "BbCDdGgSs" and not section.startswith(".data.rel.ro")


def main() -> None:
    found = symbols(*sys.argv[1:])
    if not found:
        sys.exit(f"{sys.argv[2]} has no symbols at all")
    defined = {name for name, kind, _ in found if kind not in "Uw"}
    needed = sorted({name for name, kind, _ in found if kind in "Uw"} - defined - ALLOWED)
    variables = sorted(name for name, kind, section in found if is_variable(kind, section))
    for name in needed:
        print(f"it calls {name}, which is not part of it")
    for name in variables:
        print(f"it has the variable {name}, which is not in the caller's context")
    sys.exit(bool(needed or variables))


if __name__ == "__main__":
    main()
