"""Run the fuzz targets of a build, each for its share of the time, two at once.

usage: run.py BUILD SECONDS

Each begins with the inputs of seeds/; what reached something new stays in BUILD/corpus. Exit status
1 if a property was broken or a sanitizer spoke; the input is then in BUILD/crashes.
"""

import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SEEDS = Path(__file__).with_name("seeds")
PROCESSES = 2


def run(target: Path, seconds: int) -> tuple[int, bool]:
    """Executions, and whether every one of them was sound."""
    corpus = target.parents[1] / "corpus" / target.name
    crashes = target.parents[1] / "crashes"
    for folder in (corpus, crashes):
        folder.mkdir(parents=True, exist_ok=True)
    command = [target, corpus, SEEDS / target.name, f"-max_total_time={seconds}", "-max_len=4096"]
    command += [f"-artifact_prefix={crashes}/{target.name}-", "-print_final_stats=1", "-timeout=10"]
    environment = os.environ | {"ASAN_OPTIONS": "detect_leaks=0"}
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    count = re.search(r"number_of_executed_units: (\d+)", done.stderr)
    if done.returncode or count is None:
        print(f"{target.name}:\n{done.stderr[-4000:]}")
    return int(count[1]) if count else 0, done.returncode == 0


def main() -> None:
    build, seconds = Path(sys.argv[1]).resolve(), int(sys.argv[2])
    targets = sorted((build / "bin").glob("fuzz_*"))
    share = max(1, seconds * PROCESSES // len(targets))
    with ThreadPoolExecutor(max_workers=PROCESSES) as pool:
        results = list(pool.map(lambda target: run(target, share), targets))
    counts = ", ".join(
        f"{target.name} {count:,}" for target, (count, _) in zip(targets, results, strict=True)
    )
    broken = sum(not sound for _, sound in results)
    print(f"fuzz: {broken} broken of {len(targets)} targets; executions: {counts}")
    sys.exit(broken > 0)


if __name__ == "__main__":
    main()
