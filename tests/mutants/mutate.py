"""Gate of `make mutants`: the unit tests notice when an operator, constant or statement changes.

usage: mutate.py PART SAMPLE SEED LEAST

PART is core or wire. SAMPLE mutants, drawn with SEED (0: all there are), are compiled one by one,
and the unit tests run until one fails; where none does, the hashes of same_bits.txt are compared. A
mutant with the original's object code is none. Survivors are listed, but for those of
equivalent.toml, which says why no test can tell them. Exit status 1 if less than LEAST percent of
the others are killed, by more than two standard errors of a sample.
"""

import math
import random
import re
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue
from time import monotonic
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
FIRMWARE = ROOT / "firmware"
BUILD = ROOT / "build"  # for what is generated: wire_signals.h, golden_runs.h, Unity
EQUIVALENT = Path(__file__).with_name("equivalent.toml")
WORKERS = 2
TIMEOUT_S = 60

PARTS = {"core": FIRMWARE / "core/src", "wire": FIRMWARE / "wire/src"}
FOLDERS = ["core/src", "joints/src", "wire/src", "port_common", "port_mcu"]
INCLUDES = [
    *(FIRMWARE / f for f in ("core/include", "joints/include", "wire/include", *FOLDERS)),
    *(BUILD / f for f in ("firmware/wire/signals", "tests/golden", "unity")),
]
UNITY = ["-DUNITY_NAN_NOT_EQUAL_NAN", "-DUNITY_INCLUDE_DOUBLE", "-DUNITY_SUPPORT_64"]
TARGETS = ROOT / "tests/targets"
HASHES = ("same_bits", "sequences", "elementary")
BITS = (TARGETS / "same_bits.txt").read_bytes()
# Of the host process, and what takes a function's name.
OTHER_TESTS = {"test_bus_link", "test_elementary"}

# What is replaced by what, within one line of code.
OPERATORS = [
    (r" < ", " <= "),
    (r" <= ", " < "),
    (r" > ", " >= "),
    (r" >= ", " > "),
    (r" == ", " != "),
    (r" != ", " == "),
    (r" && ", " || "),
    (r" \|\| ", " && "),
    (r" \+ ", " - "),
    (r" - ", " + "),
    (r" \* ", " / "),
    (r" / ", " * "),
    (r" \+= ", " -= "),
    (r" << ", " >> "),
    (r" & ", " | "),
    (r" \| ", " & "),
    (r"(?<=[( ])-(?=[a-z])", ""),
    (r"\btrue\b", "false"),
    (r"\bfalse\b", "true"),
    (r"\b0\.0f", "1.0f"),
    (r"\b1\.0f", "0.0f"),
    (r"\b0\.5f", "1.0f"),
    (r"\b2\.0f", "1.0f"),
    (r"\b0u\b", "1u"),
    (r"\b1u\b", "2u"),
    (r"\bif \((.*)\) \{$", r"if (!(\1)) {"),
    (r"\bsaddle_larger\(", "saddle_smaller("),
    (r"\bsaddle_smaller\(", "saddle_larger("),
    (r"^(\s+)(?!return|const|static|saddle_\w+_t )([^(){}]+ [-+*/|&]?= .*;)$", r"\1;"),
    (r"^(\s+)\w+\(.*\);$", r"\1;"),
]


class Mutant(NamedTuple):
    file: Path
    number: int
    before: str
    after: str
    change: str  # what the operator replaces by what, such as "+ by -"


class Workshop(NamedTuple):
    """Where a worker compiles and runs its mutants."""

    folder: Path

    @property
    def library(self) -> Path:
        return self.folder / "libfirmware.so"


def code_lines(file: Path) -> Iterator[tuple[int, str]]:
    """Lines within functions, without comments."""
    in_comment = False
    in_function = False
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines()):
        text = line.strip()
        if in_comment or text.startswith("/*"):
            in_comment = "*/" not in line
        elif line == "{":
            in_function = True
        elif line == "}":
            in_function = False
        elif in_function and text and not text.startswith("//"):
            yield number, line


def mutants_of(file: Path) -> Iterator[Mutant]:
    for number, line in code_lines(file):
        code = line.split("  /*")[0].split(" /*")[0].rstrip()
        for pattern, replacement in OPERATORS:
            for match in re.finditer(pattern, code):
                after = code[: match.start()] + match.expand(replacement) + code[match.end() :]
                yield Mutant(file, number, code, after, change_of(match, replacement))


def change_of(match: re.Match[str], replacement: str) -> str:
    return f"{match[0].strip()} by {match.expand(replacement).strip()}"


def compile_c(source: Path, target: Path, *flags: str) -> bool:
    command = ["gcc", "-std=c99", "-O1", "-w", "-fPIC", "-ffp-contract=off", "-fno-math-errno"]
    command += [*flags, *(f"-I{folder}" for folder in INCLUDES), str(source), "-o", str(target)]
    return subprocess.run(command, capture_output=True).returncode == 0


def version_flag() -> str:
    dbc = (FIRMWARE / "wire/saddlewalk.dbc").read_text(encoding="utf-8")
    return "-DSADDLE_WIRE_VERSION=" + re.findall(r'^VERSION "(\d+)"', dbc, re.M)[0]


def objects_of(folder: Path) -> dict[Path, Path]:
    sources = [
        s for f in FOLDERS for s in sorted((FIRMWARE / f).rglob("*.c")) if "mps2" not in str(s)
    ]
    return {
        source: folder / ("_".join(source.relative_to(FIRMWARE).parts) + ".o") for source in sources
    }


def link(workshop: Workshop, objects: dict[Path, Path]) -> None:
    command = ["gcc", "-shared", "-o", workshop.library, *objects.values(), "-lm"]
    subprocess.run(command, check=True, capture_output=True)


def build(folder: Path) -> tuple[dict[Path, Path], list[Path]]:
    """All objects, and the programs that test them, whose library each worker has for itself."""
    objects = objects_of(folder)
    with ThreadPoolExecutor(max_workers=WORKERS) as pool:
        flags = ("-c", version_flag())
        if not all(pool.map(lambda pair: compile_c(*pair, *flags), objects.items())):
            sys.exit("the firmware does not compile")
        link(Workshop(folder), objects)
        compile_c(BUILD / "unity/unity.c", folder / "unity.o", "-c", *UNITY)
        tests = [
            t for t in sorted((ROOT / "tests/unit").glob("test_*.c")) if t.stem not in OTHER_TESTS
        ]
        programs = {(test, folder / "unity.o"): folder / test.stem for test in tests}
        programs[tuple(TARGETS / f"{name}.c" for name in HASHES)] = folder / HASHES[0]
        flags = (version_flag(), *UNITY, f"-L{folder}")
        linked = (
            "-Wl,-rpath,.",
            "-Wl,--unresolved-symbols=ignore-in-shared-libs",
            "-lfirmware",
            "-lm",
        )
        done = list(pool.map(lambda p: compile_test(*p, flags, linked), programs.items()))
    if not all(done):
        sys.exit("the unit tests do not compile")
    return objects, list(programs.values())


def compile_test(
    sources: tuple[Path, ...], program: Path, flags: tuple[str, ...], linked: tuple[str, ...]
) -> bool:
    command = ["gcc", "-std=c99", "-O1", "-w", *(f"-I{folder}" for folder in INCLUDES)]
    command += [*map(str, sources), *flags, *linked, "-o", str(program)]
    return subprocess.run(command, capture_output=True).returncode == 0


def passes(program: Path, folder: Path) -> bool:
    try:
        done = subprocess.run([program], cwd=folder, capture_output=True, timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0 and (program.name != HASHES[0] or done.stdout == BITS)


def fate(workshop: Workshop, programs: list[Path], module: str) -> str:
    """The module's own test first: most die there."""
    for program in sorted(programs, key=lambda program: program.name != f"test_{module}"):
        if not passes(program, workshop.folder):
            return "hashed" if program.name == HASHES[0] else "killed"
    return "survived"


class Run:
    """One run over the mutants of a part."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.objects, programs = build(folder)
        times = {program: self.time_of(program) for program in programs}
        self.programs = sorted(times, key=lambda p: (p.name == HASHES[0], times[p]))
        self.workshops: SimpleQueue[Workshop] = SimpleQueue()
        for number in range(WORKERS):
            workshop = Workshop(folder / f"worker{number}")
            workshop.folder.mkdir()
            self.workshops.put(workshop)

    def time_of(self, program: Path) -> float:
        began = monotonic()
        if not passes(program, self.folder):
            sys.exit(f"{program.name} fails without a mutant")
        return monotonic() - began

    def outcome(self, mutant: Mutant) -> str:
        """killed by a unit test, hashed: by the hashes alone, survived, same (code) or invalid."""
        workshop = self.workshops.get()
        try:
            lines = mutant.file.read_text(encoding="utf-8").splitlines()
            lines[mutant.number] = mutant.after
            source = workshop.folder / mutant.file.name
            source.write_text("\n".join(lines) + "\n", encoding="utf-8")
            mutated = workshop.folder / "mutant.o"
            if not compile_c(source, mutated, "-c", version_flag()):
                return "invalid"
            if mutated.read_bytes() == self.objects[mutant.file].read_bytes():
                return "same"
            link(workshop, self.objects | {mutant.file: mutated})
            return fate(workshop, self.programs, mutant.file.stem)
        finally:
            self.workshops.put(workshop)


class Equivalents:
    """What no test can tell: a mutant by its line before and after, any mutant of a line, or a
    change wherever a file has it."""

    def __init__(self) -> None:
        listed = tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))["mutant"]
        self.lines = {(m["file"], m["before"], m.get("after")) for m in listed if "before" in m}
        self.changes = {(m["file"], m["change"]) for m in listed if "change" in m}

    def __contains__(self, mutant: Mutant) -> bool:
        name = str(mutant.file.relative_to(ROOT))
        before, after = mutant.before.strip(), mutant.after.strip()
        of_line = {(name, before, after), (name, before, None)}
        return bool(of_line & self.lines) or (name, mutant.change) in self.changes


def main() -> None:
    part, (sample, seed, least) = sys.argv[1], map(int, sys.argv[2:5])
    every = [m for file in sorted(PARTS[part].rglob("*.c")) for m in mutants_of(file)]
    random.Random(seed).shuffle(every)
    excused = Equivalents()
    drawn = [m for m in every if m not in excused][: sample or None]
    with tempfile.TemporaryDirectory() as folder:
        run = Run(Path(folder))
        with ThreadPoolExecutor(max_workers=WORKERS) as pool:
            outcomes = list(pool.map(run.outcome, drawn))
    for mutant, outcome in sorted(zip(drawn, outcomes, strict=True)):
        if outcome == "survived":
            place = f"{mutant.file.relative_to(ROOT)}:{mutant.number + 1}"
            print(f"{place}: survived: `{mutant.before.strip()}` -> `{mutant.after.strip()}`")
    by_tests, survived = outcomes.count("killed"), outcomes.count("survived")
    killed = by_tests + outcomes.count("hashed")
    share = killed / max(1, killed + survived)
    print(
        f"mutants: {part}: {killed} of {killed + survived} killed, {100 * share:.1f} %, "
        f"{by_tests} by the unit tests; of {len(every)} there are (seed {seed}; "
        f"{outcomes.count('same')} with the same code, {outcomes.count('invalid')} do not compile)"
    )
    wanted = least / 100
    error = math.sqrt(wanted * (1 - wanted) / max(1, killed + survived)) if sample else 0.0
    sys.exit(share < wanted - 2 * error)


if __name__ == "__main__":
    main()
