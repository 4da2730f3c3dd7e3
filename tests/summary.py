"""Add up JUnit reports (ctest's, pytest's) into one closing line: `N passed, N failed`.

usage: summary.py REPORT.xml...

Exit status 1 if a test failed, if a report is missing or empty (its runner broke down: one
failure), or if CI or SADDLEWALK_ALL is set and a test was left out.
"""

import os
import sys
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree


def outcome(case: ElementTree.Element) -> str:
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    return "skipped" if case.find("skipped") is not None else "passed"


def count(report: Path) -> Counter:
    try:
        cases = list(ElementTree.parse(report).iter("testcase"))
    except (OSError, ElementTree.ParseError) as error:
        print(f"{report}: {error}")
        cases = []
    return Counter(map(outcome, cases)) if cases else Counter(failed=1)


def main() -> None:
    total = sum((count(Path(report)) for report in sys.argv[1:]), Counter())
    none_left_out = os.environ.get("CI") or os.environ.get("SADDLEWALK_ALL")
    if total["skipped"] and none_left_out:
        print(f"{total['skipped']} tests were left out, and CI leaves none out")
    skipped = f", {total['skipped']} skipped" if total["skipped"] else ""
    print(f"{total['passed']} passed, {total['failed']} failed{skipped}")
    sys.exit(bool(total["failed"] or (total["skipped"] and none_left_out)))


if __name__ == "__main__":
    main()
