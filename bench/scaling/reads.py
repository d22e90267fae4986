#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""File system requests of a render: names, opens, reads and writes, traced with strace.

    bench/scaling/reads.py FATHOM render SCENE [OPTION]...      prints JSON, the input of model.py
"""
import json
import os
import re
import subprocess
import sys
import tempfile

NAMES = {"openat", "open", "newfstatat", "stat", "lstat", "statx", "access", "faccessat2", "readlink", "readlinkat", "rename", "renameat2", "linkat",
         "unlink", "unlinkat"}
CALLS = ",".join(sorted(NAMES | {"fstat", "read", "pread64", "readv", "write", "pwrite64", "mmap", "fsync"}))
# Local files, which are not on the file server.
LOCAL = re.compile(r"^/(proc|sys|dev|usr|lib|lib64|etc|run)(/|$)")


def traced(words):
    with tempfile.TemporaryDirectory() as folder:
        log = os.path.join(folder, "strace.log")
        subprocess.run(["strace", "-f", "-y", "-qq", "-o", log, "-e", "trace=" + CALLS, *words], check=True, stderr=subprocess.DEVNULL)
        with open(log, errors="replace") as lines:
            yield from lines


def asked(words, local=LOCAL):
    """By file on the server: numbers of lookups, opens, reads and writes, and bytes."""
    files = {}
    for line in traced(words):
        call = re.match(r"\d+ +(\w+)\((.*)\) += (-?\d+)", line)
        if not call:
            continue
        name, arguments, result = call[1], call[2], int(call[3])
        of_descriptor = re.match(r"\d+<([^>]*)>", arguments)
        named = re.search(r'"([^"]*)"', arguments)
        path = of_descriptor[1] if of_descriptor and name not in NAMES else named[1] if named and name in NAMES else None
        if not path:
            continue
        path = os.path.normpath(os.path.join(os.getcwd(), path))
        if local.match(path):
            continue
        file = files.setdefault(path, {"names": 0, "opens": 0, "reads": 0, "read_bytes": 0, "writes": 0, "written_bytes": 0, "maps": 0, "syncs": 0})
        if name in NAMES:
            file["names"] += 1
            file["opens"] += name.startswith("open") and result >= 0
        elif "read" in name and result > 0:
            file["reads"] += 1
            file["read_bytes"] += result
        elif "write" in name and result > 0:
            file["writes"] += 1
            file["written_bytes"] += result
        elif name == "fsync":
            file["syncs"] += 1
        elif name == "mmap":
            file["maps"] += 1
    return files


def total(files):
    return {key: sum(file[key] for file in files.values()) for key in next(iter(files.values()))}


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    found = asked(sys.argv[1:])
    json.dump({"files": found, "all": total(found)}, sys.stdout, indent=1)
    print()
