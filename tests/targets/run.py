"""Build and run the tests of the targets; each writes build-TARGET/reports/ctest.xml.

usage: run.py TARGET...

A target whose compiler, C library or emulator is missing is one skipped test, which says what
installs them. Where all bare-metal targets were measured, docs/costs.md is written anew.
"""

import shutil
import subprocess
import sys
from pathlib import Path
from xml.sax.saxutils import quoteattr

ROOT = Path(__file__).parents[2]
ARM = {
    "arm-none-eabi-gcc": "gcc-arm-none-eabi",
    "/usr/lib/picolibc/arm-none-eabi": "picolibc-arm-none-eabi",
    "qemu-system-arm": "qemu-system-arm",
}
RISCV = {
    "riscv64-unknown-elf-gcc": "gcc-riscv64-unknown-elf",
    "/usr/lib/picolibc/riscv64-unknown-elf": "picolibc-riscv64-unknown-elf",
    "qemu-system-riscv32": "qemu-system-misc",
}
BARE_METAL = {
    "cortex-m4f": ARM,
    "cortex-m7": ARM,
    "cortex-m33": ARM,
    "cortex-m3": ARM,
    "rv32imafc": RISCV,
}
# What a target needs (a program, or a path with wildcards), and the Debian package that has it.
NEEDS = {
    **BARE_METAL,
    "i686": {
        "i686-linux-gnu-gcc": "gcc-i686-linux-gnu",
        "/usr/i686-linux-gnu/lib/libc.a": "libc6-dev-i386-cross",
        "qemu-i386-static": "qemu-user-static",
    },
    "powerpc": {
        "powerpc-linux-gnu-gcc": "gcc-powerpc-linux-gnu",
        "/usr/powerpc-linux-gnu/lib/libc.a": "libc6-dev-powerpc-cross",
        "qemu-ppc-static": "qemu-user-static",
    },
    "wasm32": {
        "clang": "clang",
        "wasm-ld": "lld",
        "/usr/lib/wasm32-wasi/libc.a": "wasi-libc",
        "/usr/lib/llvm-*/lib/clang/*/lib/wasi/*": "libclang-rt-dev-wasm32",
        "node": "nodejs",
    },
}


def is_there(need: str) -> bool:
    if need.startswith("/"):
        return any(Path("/").glob(need[1:]))
    return shutil.which(need) is not None


def report_skip(target: str, missing: list[str]) -> None:
    packages = [NEEDS[target][need] for need in missing]
    text = f"missing: {', '.join(missing)}; as root: apt-get install -y {' '.join(packages)}"
    print(f"{target}: left out, {text}")
    report = ROOT / f"build-{target}" / "reports" / "ctest.xml"
    report.parent.mkdir(parents=True, exist_ok=True)
    report.write_text(
        f'<testsuite><testcase name="{target}"><skipped message={quoteattr(text)}/></testcase>'
        "</testsuite>\n"
    )


def run(target: str) -> None:
    """A step that fails leaves no report, which counts as a failure."""
    tools = Path(sys.executable).parent
    build = ROOT / f"build-{target}"
    steps = [
        [tools / "ninja", "-C", build, "--quiet", "tests"],
        [tools / "ctest", "--preset", target, "--quiet", "--output-junit", "reports/ctest.xml"],
    ]
    if not (build / "build.ninja").exists():
        steps.insert(0, [tools / "cmake", "--preset", target, "--log-level=WARNING"])
    for step in steps:
        if subprocess.run(step, cwd=ROOT, check=False).returncode:
            print(f"{target}: {step[0].name} failed; Testing/Temporary/LastTest.log has the output")
            return
    print(f"{target}: passed")


def main() -> None:
    targets = sys.argv[1:]
    for target in targets:
        report = ROOT / f"build-{target}" / "reports" / "ctest.xml"
        report.unlink(missing_ok=True)
        missing = [need for need in NEEDS[target] if not is_there(need)]
        if missing:
            report_skip(target, missing)
        else:
            run(target)
    measured = [ROOT / f"build-{target}" for target in BARE_METAL]
    if all((build / "costs.json").exists() for build in measured):
        costs = [ROOT / "tests/targets/costs.py", "table", ROOT / "docs/costs.md", *measured]
        subprocess.run([sys.executable, *costs], check=True)


if __name__ == "__main__":
    main()
