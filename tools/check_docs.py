#!/usr/bin/env python3
"""Fails on a link in a Markdown file of ours that leads nowhere, and on a section of docs/algorithms.md cited but not there."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")
CITED = re.compile(r"algorithms (\d+\.\d+)")


def files(*patterns):
    command = ["git", "ls-files", "-co", "--exclude-standard", *patterns]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()


def main():
    faults = []
    sections = set(re.findall(r"^### (\d+\.\d+) ", (ROOT / "docs/algorithms.md").read_text(), re.M))
    for name in files("*.cpp", "*.hpp", "*.md", "*.toml"):
        for cited in CITED.findall((ROOT / name).read_text()):
            if cited not in sections:
                faults.append(f"{name}: docs/algorithms.md has no section {cited}")
    names = files("*.md")
    for name in names:
        text = (ROOT / name).read_text()
        for target in LINK.findall(text):
            if not re.match(r"[a-z]+:", target) and not ((ROOT / name).parent / target).exists():
                faults.append(f"{name}: link to {target} leads nowhere")
    print("\n".join(faults) if faults else f"docs: links of {len(names)} pages lead somewhere")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
