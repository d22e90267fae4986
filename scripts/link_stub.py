#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes a library to link with instead of a newer one: it has the symbols of the newer one that existed in old versions.

usage: link_stub.py COMPILER LIBRARY OUTPUT NAMESPACE=VERSION...

A program that is linked with OUTPUT runs with LIBRARY of the given versions, such as GLIBC=2.28, and later. Functions of
OUTPUT can't be called. Symbols that came later are missing in it, and older versions replace those that came later.
"""
from __future__ import annotations

import pathlib
import re
import subprocess
import sys
import tempfile


def number(version: str) -> tuple[int, ...]:
    """The version as numbers; symbols without a number, as GLIBC_PRIVATE, are newer than all."""
    return tuple(map(int, version.split("."))) if re.fullmatch(r"[0-9.]+", version) else (9999,)


def old_symbols(library: str, newest: dict[str, str]) -> dict[str, tuple[str, str, int]]:
    """Maps names to (version, type, size) of the newest version that is old enough."""
    table = subprocess.run(["readelf", "--dyn-syms", "--wide", library], check=True, capture_output=True, text=True).stdout
    found: dict[str, tuple[str, str, int]] = {}
    for line in table.splitlines():
        words = line.split()
        if len(words) < 8 or "@" not in words[7] or words[6] in ("UND", "ABS"):
            continue
        name, version = re.split("@+", words[7])
        namespace, _, digits = version.rpartition("_")
        if namespace not in newest or number(digits) > number(newest[namespace]):
            continue
        if name not in found or number(found[name][0].rpartition("_")[2]) < number(digits):
            found[name] = (version, words[3], int(words[2], 0))
    return found


def assembly(symbols: dict[str, tuple[str, str, int]]) -> str:
    lines = []
    for i, (name, (version, kind, size)) in enumerate(sorted(symbols.items())):
        section, type_name = {"OBJECT": (".data", "object"), "TLS": ('.section .tbss,"awT",@nobits', "tls_object")}.get(kind, (".text", "function"))
        lines += [section, f".globl stub{i}", f".type stub{i},@{type_name}", f"stub{i}: .zero {size or 1}", f".size stub{i},{size or 1}",
                  f'.symver stub{i},"{name}@@{version}"']
    return "\n".join(lines) + "\n"


def version_script(symbols: dict[str, tuple[str, str, int]]) -> str:
    versions = sorted({version for version, _, _ in symbols.values()})
    return "".join(f"{version} {{ }};\n" for version in versions) + "HIDDEN { local: stub*; };\n"


def main() -> None:
    compiler, library, output = sys.argv[1:4]
    symbols = old_symbols(library, dict(word.split("=") for word in sys.argv[4:]))
    with tempfile.TemporaryDirectory() as folder:
        source, script = pathlib.Path(folder, "stub.s"), pathlib.Path(folder, "stub.map")
        source.write_text(assembly(symbols))
        script.write_text(version_script(symbols))
        subprocess.run([compiler, "-shared", "-nostdlib", source, "-o", output, f"-Wl,--version-script={script}",
                        f"-Wl,-soname,{pathlib.Path(library).name}"], check=True)


if __name__ == "__main__":
    main()
