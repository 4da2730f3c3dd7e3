"""Gate: the longest way through a function of an image, in instructions, by its loops' bounds.

usage: longest.py OBJDUMP IMAGE

The bound of every loop of the core is in loops.toml. Blocks, branches and calls are those of the
disassembled image; the compiler's line numbers say which loop of the source one of the image is. A
loop counts as often as its bound says and once more for the test that ends it, each time by its
longest way; conditions are not followed, so a longest way may be one that nothing can go. Exit
status 1 if a loop has no bound, or a function a longer way than loops.toml allows.
"""

import re
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
CORE = ROOT / "firmware/core/src"
LIMITS = tomllib.loads(Path(__file__).with_name("loops.toml").read_text(encoding="utf-8"))
BOUNDS = {(loop["file"], loop["line"]): loop["most"] for loop in LIMITS["loop"]}
MOST = {line: max(n for (_, same), n in BOUNDS.items() if same == line) for _, line in BOUNDS}
IN_ALL = {loop["line"] for loop in LIMITS["loop"] if loop.get("in_all")}
LOOP = re.compile(r"^\s*((?:for|while) \(.*)$")

LABEL = re.compile(r"^([0-9a-f]{8}) <([^>]+)>:$")
PLACE = re.compile(r"^(/\S+):(\d+)(?: \(discriminator \d+\))?$")
CODE = re.compile(r"^ +([0-9a-f]+):\t(\S+)(?:\t(.*))?$")
CONDITION = "eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le"
JUMP = re.compile(rf"^(?:b({CONDITION})?(?:\.[nw])?|cbn?z)$")
RETURN = re.compile(rf"^(?:bx|pop|ldmia|ldr)({CONDITION})?(?:\.w)?$")


class Code(NamedTuple):
    address: int
    name: str
    operands: str
    line: str  # of the source, its text

    @property
    def target(self) -> int:
        return int(re.findall(r"\b([0-9a-f]+) <", self.operands)[0], 16)

    @property
    def returns(self) -> bool:
        what = self.operands.split("@")[0]
        last = what == "lr" if self.name.startswith("bx") else re.search(r"\bpc\b(?!,)", what)
        loads = self.name.startswith("ldr") and what.startswith("pc,")
        return bool(RETURN.match(self.name) and (last or loads))


Functions = dict[int, dict[int, Code]]


def source_line(files: dict[str, list[str]], file: str, number: int) -> str:
    """Empty for a file that is elsewhere, such as the compiler's own."""
    if file not in files:
        path = Path(file)
        files[file] = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return files[file][number - 1].strip() if files[file] else ""


def disassembled(objdump: str, image: str) -> tuple[Functions, dict[str, int]]:
    command = [objdump, "-d", "-l", "--no-show-raw-insn", image]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    functions: Functions = {}
    names: dict[str, int] = {}
    files: dict[str, list[str]] = {}
    body: dict[int, Code] = {}
    line = ""
    for row in text.splitlines():
        if label := LABEL.match(row):
            body = functions.setdefault(int(label[1], 16), {})
            names[label[2]] = int(label[1], 16)
            line = ""
        elif place := PLACE.match(row):
            line = source_line(files, place[1], int(place[2]))
        elif code := CODE.match(row):
            at = int(code[1], 16)
            body[at] = Code(at, code[2], code[3] or "", line)
    return functions, names


def ways(code: Code, after: int | None, body: dict[int, Code]) -> tuple[list[int], list[int]]:
    """The next instructions within the function, and what is called."""
    following = [after] if after is not None else []
    if jump := JUMP.match(code.name):
        unconditional = code.name.startswith("b") and not jump[1]
        inside = [code.target] if code.target in body else []
        called = [] if inside else [code.target]
        return inside + ([] if unconditional else following), called
    if code.name == "bl":
        return following, [code.target]
    if code.returns:
        return following if RETURN.match(code.name)[1] else [], []
    if code.name in {"blx", "tbb", "tbh"} or code.name.startswith("bx"):
        sys.exit(f"{code.address:x}: {code.name} {code.operands}: where this goes is not known")
    return following, []


class Graph:
    """The instructions of a function, from its entry. cost: with what they call."""

    cost: dict[int, int]

    def __init__(self, functions: Functions, entry: int) -> None:
        body = functions[entry]
        places = sorted(body)
        later = dict(zip(places, [*places[1:], None], strict=True))
        self.body, self.next, self.calls = body, {}, {}
        waiting = [entry]
        while waiting:
            at = waiting.pop()
            if at not in self.next:
                self.next[at], self.calls[at] = ways(body[at], later[at], body)
                waiting += self.next[at]

    def statement(self, loop: set[int], heads: set[int]) -> str:
        """Of the source: where the last branch is, else within; of several the most frequent."""
        back = {self.body[at].line for at in loop if heads & set(self.next[at])}
        within = {self.body[at].line for at in loop}
        for lines in (back, within):
            known = lines & set(MOST)
            if known:
                return max(known, key=lambda line: MOST[line])
        sys.exit(f"a loop without a bound in loops.toml at {min(loop):x}: {sorted(back)}")


def components(nodes: set[int], successors: dict[int, list[int]]) -> Iterator[list[int]]:
    """Tarjan's: strongly connected, those that are reached last first."""
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    stack: list[int] = []
    for root in sorted(nodes):
        work = [(root, iter(successors[root]))] if root not in index else []
        if work:
            index[root] = low[root] = len(index)
            stack.append(root)
        while work:
            at, rest = work[-1]
            for to in rest:
                if to not in nodes:
                    continue
                if to not in index:
                    index[to] = low[to] = len(index)
                    stack.append(to)
                    work.append((to, iter(successors[to])))
                    break
                if to in stack:
                    low[at] = min(low[at], index[to])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[at])
                if low[at] == index[at]:
                    cut = stack.index(at)
                    yield stack[cut:]
                    del stack[cut:]


class Longest:
    def __init__(self, functions: Functions) -> None:
        self.functions = functions
        self._shared: dict[int, int] = {}
        self.of = cache(self._of)

    def call(self, entry: int) -> int:
        """Of a call from outside, with what is counted over all of it."""
        self.of.cache_clear()
        self._shared.clear()
        return self.of(entry) + sum(self._shared.values())

    def _of(self, entry: int) -> int:
        graph = Graph(self.functions, entry)
        graph.cost = {
            at: 1 + max((self.of(callee) for callee in called), default=0)
            for at, called in graph.calls.items()
        }
        return self._way(graph, set(graph.next), {entry})

    def _way(self, graph: Graph, nodes: set[int], heads: set[int], again: bool = True) -> int:
        """From a head, to wherever it is longest; not `again`: not back to a head."""
        closed = set() if again else heads
        successors = {at: [to for to in graph.next[at] if to not in closed] for at in nodes}
        total: dict[int, int] = {}
        for part in components(nodes, successors):
            leaving = [total[to] for at in part for to in successors[at] if to in total]
            own = graph.cost[part[0]]
            if len(part) > 1 or part[0] in successors[part[0]]:
                loop = set(part)
                begun = {to for at in nodes - loop for to in successors[at] if to in loop}
                own = self._loop(graph, loop, begun | (heads & loop))
            total.update(dict.fromkeys(part, own + max(leaving, default=0)))
        return max(total[head] for head in heads)

    def _loop(self, graph: Graph, loop: set[int], heads: set[int]) -> int:
        once = len(heads) * self._way(graph, loop, heads, again=False)
        line = graph.statement(loop, heads)
        if line in IN_ALL:  # what ends it counts here, the rounds once
            self._shared[min(loop)] = MOST[line] * once
            return once
        return (MOST[line] + 1) * once


def loops_of_the_core() -> Iterable[tuple[str, str]]:
    for file in sorted(CORE.rglob("*.[ch]")):
        for row in file.read_text(encoding="utf-8").splitlines():
            if loop := LOOP.match(row):
                yield str(file.relative_to(CORE)), loop[1]


def main() -> None:
    objdump, image = sys.argv[1:]
    functions, names = disassembled(objdump, image)
    there = set(loops_of_the_core())
    wrong = [f"{file}: no bound: {line}" for file, line in sorted(there - set(BOUNDS))]
    wrong += [f"{file}: no such loop: {line}" for file, line in sorted(set(BOUNDS) - there)]
    longest = Longest(functions)
    for name, most in LIMITS["most"].items():
        found = longest.call(names[name])
        print(f"longest: {name}: at most {found:,} instructions")
        if found > most:
            wrong.append(f"{name}: {found} instructions, loops.toml allows {most}")
    sys.exit("\n".join(wrong) or None)


if __name__ == "__main__":
    sys.setrecursionlimit(10_000)
    main()
