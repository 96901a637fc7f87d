#!/usr/bin/env python3
"""Fails when a fault code has no row in the table behind `raysteer explain`, or no code uses it."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def main():
    declared = re.findall(r"^\s*(k\w+) = \d+,", (ROOT / "hal/base/rcode.hpp").read_text().split("enum class RCode")[1], re.M)
    rows = set(re.findall(r"RCode::(k\w+)", (ROOT / "hal/base/rcode.cpp").read_text()))
    files = subprocess.run(["git", "ls-files", "*.cpp", "*.hpp"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    used = set()
    for path in files:
        if not path.startswith(("hal/base/rcode", "tests/")):
            used |= set(re.findall(r"RCode::(k\w+)", (ROOT / path).read_text()))
    faults = [f"rcode.cpp: {code} has no row" for code in declared if code not in rows]
    faults += [f"rcode.hpp: nothing raises {code}; delete it" for code in declared if code != "kNone" and code not in used]
    print("\n".join(faults) if faults else f"rcodes: {len(declared) - 1} codes, each explained and raised")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
