"""Worst-case stack of a function: the deepest way through the call graph.

Frames and calls come from gcc's -fcallgraph-info=su; those of the compiler's own routines, which
have no such file, from the disassembled image.
"""

import re
import subprocess
from collections.abc import Iterable
from pathlib import Path

NODE = re.compile(
    r'node: \{ title: "(?P<name>[^"]+)" label: "[^"]*\\n(?P<bytes>\d+) bytes \((.*?)\)'
)
EDGE = re.compile(r'edge: \{ sourcename: "(?P<caller>[^"]+)" targetname: "(?P<callee>[^"]+)"')
LABEL = re.compile(r"^(?P<address>[0-9a-f]+) <(?P<name>[^>]+)>:", re.MULTILINE)
PUSH = re.compile(r"\t(?P<v>v?)push\s+\{(?P<registers>[^}]*)\}")
LOWER = re.compile(r"\t(?:sub(?:\.w|w)?\s+sp,(?: sp,)? #|addi\s+sp,sp,-)(?P<bytes>\d+)")
STORE = re.compile(r"\tstr(?:d|\.w)?\s+.*\[sp, #-(?P<bytes>\d+)\]!")
BRANCH = re.compile(r"\t(?:b|bl|j|jal)[a-z.]*\s[^<]*\b(?P<address>[0-9a-f]+) <")
INDIRECT = re.compile(r"\tblx\s+r\d|\tjalr\s+(?:ra,)?[at]\d")


class CallGraph:
    """Bytes of every function's frame, and whom it calls."""

    def __init__(self) -> None:
        self.frames: dict[str, int] = {}
        self.calls: dict[str, set[str]] = {}

    def add(self, name: str, frame: int = 0) -> None:
        self.frames[name] = self.frames.get(name, 0) + frame
        self.calls.setdefault(name, set())

    def worst(self, name: str, above: tuple[str, ...] = ()) -> int:
        """Bytes, callees included. ValueError: recursion, or a function that is not known."""
        if name in above or name not in self.frames:
            what = "recursion" if name in above else "a frame of unknown size"
            raise ValueError(f"{what}: {' calls '.join((*above, name))}")
        below = (self.worst(callee, (*above, name)) for callee in self.calls[name])
        return self.frames[name] + max(below, default=0)


def of_compiler(files: Iterable[Path]) -> CallGraph:
    graph = CallGraph()
    text = "\n".join(file.read_text() for file in files)
    for node in NODE.finditer(text):
        if node[3] != "static":
            raise ValueError(f"{node['name']} has a frame that is {node[3]}")
        graph.add(node["name"], int(node["bytes"]))
    for edge in EDGE.finditer(text):
        graph.calls.setdefault(edge["caller"], set()).add(edge["callee"])
    return graph


def register_bytes(registers: str, size: int) -> int:
    count = 0
    for name in registers.split(","):
        first, _, last = name.strip().partition("-")
        count += int(last[1:]) - int(first[1:]) + 1 if last else 1
    return count * size


def lowered(line: str) -> int:
    """Bytes by which an instruction lowers the stack pointer."""
    if push := PUSH.search(line):
        return register_bytes(push["registers"], 8 if push["v"] and "d" in push[2] else 4)
    step = LOWER.search(line) or STORE.search(line)
    return int(step["bytes"]) if step else 0


def of_image(disassembly: str) -> CallGraph:
    """By addresses: objdump names a branch by any symbol of that value, a mere number too."""
    graph = CallGraph()
    functions = {int(at["address"], 16): at["name"] for at in LABEL.finditer(disassembly)}
    name = ""
    for line in disassembly.splitlines():
        if label := LABEL.match(line):
            name = label["name"]
            graph.add(name)
        elif name:
            graph.add(name, lowered(line))
            if INDIRECT.search(line):
                graph.calls[name].add("__indirect_call")
            branch = BRANCH.search(line)
            callee = functions.get(int(branch["address"], 16)) if branch else None
            if callee and callee != name:
                graph.calls[name].add(callee)
    return graph


def aliases(nm: str, image: Path) -> dict[str, list[str]]:
    """All names of each address with a function."""
    lines = subprocess.run([nm, image], check=True, text=True, stdout=subprocess.PIPE).stdout
    names: dict[str, list[str]] = {}
    for address, kind, name in (line.split() for line in lines.splitlines() if line[0] != " "):
        if kind in "TtWw":
            names.setdefault(address, []).append(name)
    return {name: same for same in names.values() for name in same}


def call_graph(files: Iterable[Path], disassembly: str, nm: str, image: Path) -> CallGraph:
    """The compiler's call graph, completed from the image."""
    graph = of_compiler(files)
    linked = of_image(disassembly)
    same = aliases(nm, image)
    for name in {callee for callees in graph.calls.values() for callee in callees} | set(
        linked.frames
    ):
        known = next((alias for alias in same.get(name, [name]) if alias in linked.frames), None)
        if name not in graph.frames and known:
            graph.frames[name] = linked.frames[known]
            graph.calls[name] = linked.calls[known]
    return graph
