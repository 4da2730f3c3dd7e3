"""Gate of `make coverage`: every branch taken both ways, every condition with an effect of its own.

usage: gate.py BUILD

Reads what the C tests of BUILD (preset `coverage`) left in BUILD/profiles. What no test can reach
is in justified.toml with the reason. Exit status 1 if a gap is not listed there, or if something
listed is no gap any more.
"""

import json
import subprocess
import sys
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[2]
JUSTIFIED = Path(__file__).with_name("justified.toml")
PARTS = ["core/src", "joints/src", "wire", "port_common", "port_mcu"]
FIRMWARE = [ROOT / "firmware" / part for part in PARTS]
LLVM = "22"


class Gap(NamedTuple):
    """An outcome that no test reached. missing: true, false, or effect (MC/DC: no two tests differ
    in the decision by this condition alone)."""

    file: str
    condition: str
    missing: str


def text_at(source: list[str], place: tuple[int, ...]) -> str:
    """The source at a place; its end is exclusive."""
    first, column, last, end = place
    lines = source[first - 1 : last]
    lines[-1] = lines[-1][: end - 1]
    lines[0] = lines[0][column - 1 :]
    return " ".join(line.strip() for line in lines)


def gaps_of(report: dict[str, Any], file: str) -> list[tuple[int, Gap]]:
    """The gaps in one file, each with its line."""
    source = (ROOT / file).read_text(encoding="utf-8").splitlines()
    gaps = []
    counts: dict[tuple[int, ...], tuple[int, int]] = {}  # a macro's place counts once
    for *place, true, false, _, _, _ in report["branches"]:
        before = counts.get(tuple(place), (0, 0))
        counts[tuple(place)] = (before[0] + true, before[1] + false)
    for place, outcomes in counts.items():
        # A macro's `while (0)` has no outcomes to llvm-cov either, in functions that were called.
        constant = text_at(source, place) == "0"
        for count, missing in zip(outcomes, ("true", "false"), strict=True):
            if count == 0 and not constant:
                gaps.append((place[0], Gap(file, text_at(source, place), missing)))
    for decision in report["mcdc_records"]:
        begin, end = tuple(decision[:2]), tuple(decision[2:4])
        conditions = sorted(place for place in counts if begin <= place[:2] and place[2:] <= end)
        has_effect = next(field for field in decision if isinstance(field, list))
        for place, effective in zip(conditions, has_effect, strict=True):
            if not effective:
                gaps.append((place[0], Gap(file, text_at(source, place), "effect")))
    counted = sum(report["summary"][kind]["notcovered"] for kind in ("branches", "mcdc"))
    if len(gaps) != counted:
        sys.exit(f"{file}: llvm-cov counts {counted} gaps and lists {len(gaps)}")
    return gaps


def export(build: Path) -> dict[str, Any]:
    """llvm-cov's report on the firmware's files."""
    merged = build / "coverage.profdata"
    profiles = sorted((build / "profiles").glob("*.profraw"))
    subprocess.run([f"llvm-profdata-{LLVM}", "merge", "-o", merged, *profiles], check=True)
    programs = [part for test in (build / "bin").glob("test_*") for part in ("-object", test)]
    command = [f"llvm-cov-{LLVM}", "export", f"-instr-profile={merged}", *programs[1:], *FIRMWARE]
    return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["data"][0]


def main() -> None:
    coverage = export(Path(sys.argv[1]).resolve())
    listed = tomllib.loads(JUSTIFIED.read_text(encoding="utf-8"))["condition"]
    stale = Counter(Gap(c["file"], c["text"], missing) for c in listed for missing in c["missing"])
    found, open_gaps = 0, 0
    for report in coverage["files"]:
        file = str(Path(report["filename"]).relative_to(ROOT))
        for line, gap in gaps_of(report, file):
            found += 1
            if stale[gap]:
                stale[gap] -= 1
            else:
                open_gaps += 1
                print(f"{file}:{line}: no test reaches `{gap.condition}`: {gap.missing}")
    for gap in stale.elements():
        print(f"{JUSTIFIED.name}: tests reach `{gap.condition}` of {gap.file}: {gap.missing}")
    branches, conditions = (coverage["totals"][kind]["count"] for kind in ("branches", "mcdc"))
    print(
        f"coverage: of {branches} branches and {conditions} conditions (MC/DC) the tests miss "
        f"{open_gaps} without a reason and {found - open_gaps} with one"
    )
    sys.exit(open_gaps > 0 or stale.total() > 0)


if __name__ == "__main__":
    main()
