#!/usr/bin/env python3
"""Fails when a fault code has no row in the table behind `raysteer explain`, or no code uses it."""

import pathlib
import re
import subprocess
import sys

# Codes of what is being built (self-calibration, the device) were declared at once, since each new one rebuilds
# everything; they may still wait for who raises them. Whoever lands the last of those parts empties this.
WAITING = {908, 909, *range(620, 628), *range(1101, 1400)}

ROOT = pathlib.Path(__file__).resolve().parent.parent


def main():
    numbers = re.findall(r"^\s*(k\w+) = (\d+),", (ROOT / "hal/base/rcode.hpp").read_text().split("enum class RCode")[1], re.M)
    declared = [code for code, number in numbers]
    waiting = {code for code, number in numbers if int(number) in WAITING}
    rows = set(re.findall(r"RCode::(k\w+)", (ROOT / "hal/base/rcode.cpp").read_text()))
    files = subprocess.run(["git", "ls-files", "*.cpp", "*.hpp"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    used = set()
    for path in files:
        if not path.startswith(("hal/base/rcode", "tests/")):
            used |= set(re.findall(r"RCode::(k\w+)", (ROOT / path).read_text()))
    faults = [f"rcode.cpp: {code} has no row" for code in declared if code not in rows]
    faults += [f"rcode.hpp: nothing raises {code}; delete it" for code in declared if code != "kNone" and code not in used | waiting]
    print("\n".join(faults) if faults else f"rcodes: {len(declared) - 1} codes, each explained, {len(waiting - used)} still wait for who raises them")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
