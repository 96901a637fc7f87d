#!/usr/bin/env python3
"""Fails on a link in a Markdown file of ours that leads nowhere, and on a path of this machine."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")


def main():
    files = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True)
    faults = []
    names = files.stdout.split()
    for name in names:
        text = (ROOT / name).read_text()
        for target in LINK.findall(text):
            if not re.match(r"[a-z]+:", target) and not ((ROOT / name).parent / target).exists():
                faults.append(f"{name}: link to {target} leads nowhere")
    print("\n".join(faults) if faults else f"docs: links of {len(names)} pages lead somewhere")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
