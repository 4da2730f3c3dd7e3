"""What core, wire and joints cost on a target: flash, memory, stack, instructions of a tick.

usage: costs.py measure TARGET BUILD_DIR PLUGIN COMPILER COMPILER_FLAGS EMULATOR...
       costs.py table OUT.md BUILD_DIR...

`measure` writes BUILD_DIR/costs.json and compares it with budgets.toml: exit status 1 if a budget
is passed. `table` writes what was measured on all targets as a page of Markdown.
"""

import json
import re
import shlex
import statistics
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path

import stack

HERE = Path(__file__).parent
LEVELS = ["Os", "O2"]
CORE = "init tick join plan_at score_plan config_default config_check".split()
WIRE = "accept decode_command decode_measured encode_output".split()
JOINTS = "legs_default legs_check inverse inverse_of_com forward".split()
JOINTS += "estimator_default estimator_init estimator_update".split()
JOINTS += "drive_default drive_check joint_commands".split()
JOINTS += "joint_walk_default joint_walk_check joint_walk_init joint_walk_update".split()
# Function -> what its calls are counted as. The order is count_calls' numbering.
COUNTED = {
    "saddle_init": "init",
    "saddle_plan_at": "plan_at",
    "saddle_tick": "tick",
    "saddle_wire_accept": "receive",
    "saddle_wire_decode_command": "receive",
    "saddle_wire_decode_measured": "receive",
    "saddle_wire_encode_output": "encode",
    "saddle_inverse_of_com": "inverse",
    "saddle_estimator_update": "estimate",
    "saddle_joint_walk_update": "intent",
    "saddle_joint_commands": "command",
}
MODES = ["standing", "starting", "walking", "stopping"]
TURNING = "turning"  # in any mode, on a bent way
LEVEL_NAMES = ["unknown", "stable", "caution", "unstable"]
MEDIAN = 1  # in the rows of by_kind()
DOUBLE_HELPER = re.compile(r"__aeabi_(d|[a-z0-9]+2d$)|__[a-z]+df\w*$|__extendsfdf2|__truncdfsf2")

Costs = dict[str, float | list[str]]


def output_of(command: list) -> str:
    """What it printed; an image prints to QEMU's standard error."""
    words = [*map(str, command)]
    done = subprocess.run(
        words, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=200
    )
    if done.returncode:
        sys.exit(f"{' '.join(words)}\n{done.stdout[-500:]}")
    return done.stdout


class Tools:
    """A target's compiler and emulator, and the build that they are asked about."""

    def __init__(self, build: Path, plugin: Path, compiler: str, flags: str, emulator: list[str]):
        self.build, self.plugin, self.emulator = build, plugin, emulator
        self.compiler = compiler
        self.flags = [flag for flag in shlex.split(flags) if not flag.startswith("--specs")]

    def tool(self, name: str) -> str:
        return self.compiler.removesuffix("gcc") + name

    def library(self, part: str, level: str) -> Path:
        return self.build / "lib" / f"lib{part}_{level}.a"

    def image(self, level: str) -> Path:
        return self.build / "bin" / f"benchmark_{level}"


def flash(tools: Tools, part: str, level: str, roots: Iterable[str]) -> int:
    """Bytes of code and constants that a program links which calls all of `roots`."""
    linked = tools.build / f"flash_{part}_{level}"
    keep = [f"-Wl,-u,{root}" for root in roots]
    options = ["-nostdlib", "-Wl,--gc-sections,--unresolved-symbols=ignore-all,-e,0"]
    library = tools.library(part, level)
    output_of([tools.compiler, *tools.flags, *options, *keep, library, "-o", linked])
    text, data, *_ = output_of([tools.tool("size"), linked]).splitlines()[1].split()
    return int(text) + int(data)


def undefined(tools: Tools, part: str, level: str) -> list[str]:
    """What an archive needs of others, but for our own."""
    listing = output_of([tools.tool("nm"), "-u", tools.library(part, level)])
    names = {line.split()[-1] for line in listing.splitlines() if line.lstrip().startswith("U ")}
    return sorted(name for name in names if not name.startswith("saddle_"))


def call_options(disassembly: str) -> Iterator[str]:
    """count_calls' arguments: where each function begins, and where its calls return to."""
    lines = disassembly.splitlines()
    for name in COUNTED:
        entry = re.search(rf"^([0-9a-f]+) <{name}>:", disassembly, re.MULTILINE)
        calls = re.compile(rf"\t(?:bl|jal)\b.*<{name}>$")
        after = [
            lines[i + 1].split(":")[0].strip() for i in range(len(lines)) if calls.search(lines[i])
        ]
        jumps = re.search(rf"\t(?:b|b\.w|b\.n|j)\t.*<{name}>$", disassembly)
        if entry is None or not after or jumps:
            sys.exit(f"{name} is not called by plain calls: it cannot be counted")
        yield "call=" + ":".join(f"0x{address}" for address in [entry[1], *after])


def run_benchmark(tools: Tools, level: str, disassembly: str) -> tuple[list[str], list[str]]:
    """What the image printed, and the counted calls, line by line."""
    counts = tools.build / f"calls_{level}.txt"
    plugin = ",".join([f"{tools.plugin}", f"out={counts}", *call_options(disassembly)])
    program, *options = tools.emulator
    printed = output_of([program, "-plugin", plugin, *options, tools.image(level)])
    return printed.splitlines(), counts.read_text().splitlines()


def instructions(calls: list[str]) -> dict[str, list[int]]:
    """Counts of each call; what is received, summed up between two ticks."""
    counts: dict[str, list[int]] = {name: [] for name in COUNTED.values()}
    names = list(COUNTED.values())
    received = 0
    for line in calls:
        index, count = map(int, line.split())
        if names[index] == "receive":
            received += count
            continue
        counts[names[index]].append(count)
        if names[index] == "tick":
            counts["receive"].append(received)
            received = 0
    return counts


def kinds_of_ticks(printed: list[str]) -> Iterator[set[str]]:
    for line in printed:
        if line.startswith("tick "):
            _, mode, level, faults, status, turns = line.split()
            refused = status != "0"
            invalid = {"invalid input"} if refused or faults != "0" else set()
            motion = TURNING if turns == "1" else MODES[int(mode)]
            yield invalid if refused else {motion, LEVEL_NAMES[int(level)], *invalid}


def measure_level(tools: Tools, level: str) -> tuple[Costs, dict[str, list[float]], list[str]]:
    disassembly = output_of([tools.tool("objdump"), "-d", "--no-show-raw-insn", tools.image(level)])
    printed, calls = run_benchmark(tools, level, disassembly)
    counts = instructions(calls)
    labels = list(kinds_of_ticks(printed))
    if len(labels) != len(counts["tick"]) or not labels:
        sys.exit(f"{len(labels)} ticks were printed, {len(counts['tick'])} were counted")
    folders = [
        tools.build / "tests" / "targets" / "CMakeFiles" / f"{part}_{level}.dir"
        for part in ("core", "wire", "joints")
    ]
    files = [file for folder in folders for file in folder.rglob("*.ci")]
    graph = stack.call_graph(files, disassembly, tools.tool("nm"), tools.image(level))
    kinds = by_kind(labels, counts["tick"])
    costs: Costs = {
        "flash_core": flash(tools, "core", level, [f"saddle_{name}" for name in CORE]),
        "flash_wire": flash(tools, "wire", level, [f"saddle_wire_{name}" for name in WIRE]),
        "flash_joints": flash(tools, "joints", level, [f"saddle_{name}" for name in JOINTS]),
        "stack_tick": graph.worst("saddle_tick"),
        "stack_init": graph.worst("saddle_init"),
        "stack_wire": max(graph.worst(f"saddle_wire_{name}") for name in WIRE),
        "stack_joints": max(graph.worst(f"saddle_{name}") for name in JOINTS),
        "init": max(counts["init"]),
        "tick_median": statistics.median_low(counts["tick"]),
        "walking_median": kinds["walking"][MEDIAN],
        "tick_max": max(counts["tick"]),
        "plan_at_max": max(counts["plan_at"]),
        "receive_max": max(counts["receive"]),
        "encode_max": max(counts["encode"]),
        "inverse_max": max(counts["inverse"]),
        "estimate_max": max(counts["estimate"]),
        "intent_max": max(counts["intent"]),
        "command_max": max(counts["command"]),
        "undefined_core": undefined(tools, "core", level),
        "undefined_wire": undefined(tools, "wire", level),
        "undefined_joints": undefined(tools, "joints", level),
    }
    for median in ("tick", "walking"):
        costs[f"tick_max_to_{median}_median"] = round(
            costs["tick_max"] / costs[f"{median}_median"], 3
        )
    return costs, kinds, printed


def by_kind(kinds: list[set[str]], ticks: list[int]) -> dict[str, list[float]]:
    """Minimum, median, maximum and number of the ticks of each kind."""
    table = {}
    for kind in [*MODES, TURNING, *LEVEL_NAMES, "invalid input"]:
        counts = [count for count, names in zip(ticks, kinds, strict=True) if kind in names]
        if not counts:
            sys.exit(f"the benchmark has no tick that is {kind}")
        table[kind] = [min(counts), statistics.median_low(counts), max(counts), len(counts)]
    return table


def passed(costs: dict[str, Costs], budgets: dict[str, Costs]) -> Iterator[str]:
    """The budgets that are passed or missing, and symbols that none allows, in words."""
    for section, values in costs.items():
        allowed = budgets.get(section, {})
        for name, value in values.items():
            if name not in allowed:
                yield f"{section}.{name} is {value} and has no budget"
            elif isinstance(value, list):
                for symbol in sorted(set(value) - set(allowed[name])):
                    yield f"{section}.{name}: needs {symbol}, which is not allowed"
                for symbol in filter(DOUBLE_HELPER.match, value):
                    yield f"{section}.{name}: {symbol} calculates with doubles"
            elif value > allowed[name]:
                yield f"{section}.{name} is {value}, its budget is {allowed[name]}"


def measure(target: str, build: Path, tools: Tools) -> None:
    costs: dict[str, Costs] = {}
    kinds = {}
    printed: list[str] = []
    for level in LEVELS:
        costs[level], kinds[level], printed = measure_level(tools, level)
    sizes = (line.split() for line in printed if line.startswith("size "))
    costs["bytes"] = {name: int(value) for _, name, value in sizes}
    version = output_of([tools.compiler, "--version"]).splitlines()[0]
    result = {"target": target, "compiler": version, "costs": costs, "ticks": kinds}
    (build / "costs.json").write_text(json.dumps(result, indent=1))
    budgets = tomllib.loads((HERE / "budgets.toml").read_text())
    complaints = list(passed(costs, budgets.get(target, {})))
    sys.exit("\n".join(complaints) or None)


# ---- the page ------------------------------------------------------------------------------


ROWS = [
    ("Os", "flash_core", "flash of the core, -Os, bytes"),
    ("O2", "flash_core", "flash of the core, -O2"),
    ("Os", "flash_wire", "flash of the wire, -Os"),
    ("O2", "flash_wire", "flash of the wire, -O2"),
    ("Os", "flash_joints", "flash of the joints, -Os"),
    ("O2", "flash_joints", "flash of the joints, -O2"),
    ("bytes", "context", "context, bytes"),
    ("bytes", "config", "config (a copy is in the context)"),
    ("bytes", "input", "input"),
    ("bytes", "output", "output"),
    ("bytes", "receiver", "receiver of the wire"),
    ("bytes", "estimator", "estimator of the joints"),
    ("bytes", "joint_walk", "walking layer of the joints"),
    ("O2", "stack_tick", "stack of a tick, -O2, bytes"),
    ("Os", "stack_tick", "stack of a tick, -Os"),
    ("O2", "stack_init", "stack of init, -O2"),
    ("O2", "stack_wire", "stack of the wire, -O2"),
    ("O2", "stack_joints", "stack of the joints, -O2"),
    ("O2", "init", "init, -O2, instructions"),
    ("O2", "tick_median", "any tick, -O2, median"),
    ("O2", "walking_median", "tick of a walk, -O2, median"),
    ("O2", "tick_max", "any tick, -O2, maximum"),
    ("O2", "tick_max_to_tick_median", "maximum / median of any"),
    ("O2", "tick_max_to_walking_median", "maximum / median of a walk"),
    ("Os", "tick_median", "any tick, -Os, median"),
    ("Os", "walking_median", "tick of a walk, -Os, median"),
    ("Os", "tick_max", "any tick, -Os, maximum"),
    ("O2", "plan_at_max", "plan between ticks, -O2, maximum"),
    ("O2", "receive_max", "wire: receive 4 frames, -O2, maximum"),
    ("O2", "encode_max", "wire: encode the output, -O2, maximum"),
    ("O2", "inverse_max", "joints under a CoM, -O2, maximum"),
    ("O2", "estimate_max", "update of the estimator, -O2, maximum"),
    ("O2", "intent_max", "walking layer of the joints, -O2, maximum"),
    ("O2", "command_max", "commands of all joints, -O2, maximum"),
    ("O2", "undefined_core", "external symbols of the core, -O2"),
    ("O2", "undefined_wire", "external symbols of the wire, -O2"),
    ("O2", "undefined_joints", "external symbols of the joints, -O2"),
]

INTRODUCTION = """\
# What it costs

Written by `make test-targets`; `tests/targets/budgets.toml` holds the limits
that fail the build, and `tests/targets/costs.py` defines each number. Instructions are
counted in QEMU, call by call, callees included; they are not cycles. Flash is what a program links
that calls the whole interface, code and constants, without the compiler's own routines. Stack is
the deepest path through the call graph. {ticks} ticks were measured: a wearer who follows the plan
and is pushed, the same with absurd numbers, with NaN, and with turns. Most of them are standing
ticks, which are cheap, so the median of a walk is more informative than that of all.
"""


def cell(value: float | list[str]) -> str:
    if isinstance(value, list):
        return ", ".join(f"`{name}`" for name in value) or "nothing"
    return f"{value:,}"


def aim_cell(value: float | list[str], aim: float | list[str] | None) -> str:
    if aim is None:
        return ""
    if isinstance(aim, list):
        return f"{cell(aim)}: {'met' if value == aim else '**not met**'}"
    return f"{aim:,}: {'met' if value <= aim else '**not met**'}"


def row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def page(results: list[dict], aims: dict) -> Iterator[str]:
    first = results[0]
    number = sum(entry[3] for entry in list(first["ticks"]["O2"].values())[: len(MODES) + 1])
    yield INTRODUCTION.format(ticks=f"{number:,}")
    names = [result["target"] for result in results]
    yield row(["", *names, f"aim for {names[0]}"])
    yield row(["---"] + ["---:"] * len(names) + ["---"])
    for section, name, text in ROWS:
        values = [result["costs"][section][name] for result in results]
        aim = aims.get(section, {}).get(name)
        yield row([text, *map(cell, values), aim_cell(values[0], aim)])
    yield f"\n## A tick on {names[0]}, -O2, by what it does\n"
    yield row(["kind of tick", "minimum", "median", "maximum", "ticks"])
    yield row(["---", "---:", "---:", "---:", "---:"])
    for kind, values in first["ticks"]["O2"].items():
        yield row([kind, *map(cell, values)])
    yield "\nCompilers: " + "; ".join(dict.fromkeys(result["compiler"] for result in results)) + "."


def table(out: Path, builds: list[Path]) -> None:
    results = [json.loads((build / "costs.json").read_text()) for build in builds]
    aims = tomllib.loads((HERE / "budgets.toml").read_text())["aims"]
    out.write_text("\n".join(page(results, aims)) + "\n")


def main() -> None:
    command, *arguments = sys.argv[1:]
    if command == "table":
        table(Path(arguments[0]), [Path(build) for build in arguments[1:]])
    else:
        target, build, plugin, compiler, flags, *emulator = arguments
        measure(target, Path(build), Tools(Path(build), Path(plugin), compiler, flags, emulator))


if __name__ == "__main__":
    main()
