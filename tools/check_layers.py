#!/usr/bin/env python3
"""Fails on any include that crosses the layers of tools/layers.toml, and on CMake links that do."""

import pathlib
import re
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s+([<"])([^>"]+)[>"]')
LINK = re.compile(r"raysteer_library\((\S+)\s([^)]*)\)", re.DOTALL)
# Headers without a dot or slash are the standard library's; these are C's and POSIX's, free for all but hal.
POSIX = re.compile(r"^(sys|linux|arpa|netinet)/|^(unistd|fcntl|signal|poll|pthread|termios|dirent|errno|spawn|pty|immintrin|arm_neon)\.h$")


def row_of(path, layers):
    fitting = [folder for folder in layers if path.startswith(folder + "/")]
    return max(fitting, key=len, default=None)


def allowed_ours(target, folder, row):
    return any(target.startswith(own + "/") or target == own for own in [folder, *row["folders"]])


def include_faults(path, text, layers):
    folder = row_of(path, layers)
    if folder is None:
        yield f"{path}: no row in tools/layers.toml; add its folder there"
        return
    row = layers[folder]
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        quote, target = match.groups()
        if quote == '"':
            if not allowed_ours(target, folder, row):
                yield f"{path}:{number}: {folder} may not include {target}"
        elif "/" in target or "." in target:
            if POSIX.match(target) or "*" in row["outside"]:
                continue
            if target.split("/")[0] not in row["outside"]:
                yield f"{path}:{number}: {folder} may not use <{target}>"


def link_faults(path, text, layers):
    known = {folder for folder in layers}
    for match in LINK.finditer(text):
        folder = match.group(1)
        row_name = row_of(folder + "/", layers)
        if row_name is None:
            yield f"{path}: no row for {folder} in tools/layers.toml"
            continue
        for word in match.group(2).split():
            if (word in known or word.split("/")[0] in ("hal", "proto", "calib", "host", "firmware", "drivers", "sim")) and (
                "/" in word and not word.startswith("<") and "::" not in word and "$" not in word
            ):
                if not allowed_ours(word, row_name, layers[row_name]):
                    yield f"{path}: {folder} may not link {word}"


def main():
    layers = tomllib.loads((ROOT / "tools/layers.toml").read_text())["layers"]
    files = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=True)
    faults = []
    count = 0
    for path in files.stdout.split():
        file = ROOT / path
        if not file.is_file():
            continue
        if path.endswith((".hpp", ".cpp")):
            count += 1
            faults += include_faults(path, file.read_text(), layers)
        elif path.endswith("CMakeLists.txt") and path.count("/") == 2:
            faults += link_faults(path, file.read_text(), layers)
    print("\n".join(faults) if faults else f"layers: {count} files keep to tools/layers.toml")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
