#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks quotes in documents: messages in the sources, and names of docs/library.md in the headers.

usage: names_test.py ROOT

A message is a line of a code block that begins like one, and in docs/troubleshooting.md also each line in a block marked `text`
and a code span of several words in the first column of a table. Its names and numbers are examples, so it is found if most pairs
of neighboring words occur in string literals of the sources.
"""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve()
sys.path.insert(0, str(ROOT / "tests" / "support"))
sys.dont_write_bytecode = True
from documents import MESSAGE, blocks  # noqa: E402

ENOUGH = 0.6
# Messages that are put together from single words or by a library; blocks_test.py makes the program print them.
COMPOSED = re.compile("needs about .* allows|contain degenerate triangles|The following argument was not expected")
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
# Separator of adjacent literals that the compiler joins.
JOINED = re.compile(r'"\s*"')


def string_literals():
    """All string literals of src and apps as one text; adjacent literals are joined, as in the compiler."""
    found = []
    for folder in "src", "apps":
        for file in sorted((ROOT / folder).rglob("*")):
            if file.suffix in (".cpp", ".h"):
                code = re.sub(r"^\s*(//|#include).*$", "", file.read_text(encoding="utf-8"), flags=re.MULTILINE)
                found += LITERAL.findall(JOINED.sub("", code))
    return "\n".join(found).replace('\\"', '"')


def messages(text):
    for block in re.findall(r"^ *```text\n(.*?)^ *```$", text, re.MULTILINE | re.DOTALL):
        yield from (line.strip() for line in block.splitlines() if line.strip())
    for cell in re.findall(r"^\| (`[^|]*`) \|", text, re.MULTILINE):
        yield from (span for span in re.findall(r"`([^`]+)`", cell) if span.count(" ") >= 2 and not span.startswith(("-", "fathom ")))


def share_found(message, literals):
    """Fraction of pairs of neighboring words that occur, without words with digits and names of the example."""
    words = message.removeprefix("fathom: ").removeprefix("warning: ").split()
    pairs = [f"{a} {b}" for a, b in zip(words, words[1:]) if re.fullmatch(r"[^\d']+[^\d':]", a) and re.fullmatch(r"[^\d']+", b)]
    return sum(pair.rstrip(".,;:)") in literals for pair in pairs) / max(1, len(pairs))


class Names(unittest.TestCase):
    def test_messages_of_troubleshooting(self):
        literals = string_literals()
        quoted = list(messages((ROOT / "docs" / "troubleshooting.md").read_text(encoding="utf-8")))
        self.assertGreater(len(quoted), 20)
        for message in quoted:
            with self.subTest(message=message):
                self.assertGreaterEqual(share_found(message, literals), ENOUGH, "the program prints no such message")
        self.assertLess(share_found("fathom: this message is nowhere in the sources of Fathom", literals), ENOUGH)

    def test_messages_in_code_blocks(self):
        literals = string_literals()
        for page in sorted((ROOT / "docs").glob("*.md")):
            lines = [line for _, block in blocks(page.read_text(encoding="utf-8")) for line in block]
            for message in filter(MESSAGE.match, lines):
                with self.subTest(page=page.name, message=message):
                    self.assertTrue(COMPOSED.search(message) or share_found(message, literals) >= ENOUGH)

    def test_names_of_the_library_guide(self):
        headers = "\n".join(header.read_text(encoding="utf-8") for header in sorted((ROOT / "include" / "fathom").rglob("*.h")))
        guide = (ROOT / "docs" / "library.md").read_text(encoding="utf-8")
        for header in sorted(set(re.findall(r"fathom/[\w/]+\.h", guide))):
            with self.subTest(header=header):
                self.assertTrue((ROOT / "include" / header).exists(), "no such header")
        spans = re.findall(r"`([A-Za-z_][\w:]*)(?:\(\))?`", guide) + re.findall(r"fathom::(\w+(?:::\w+)*)", guide)
        names = sorted({part for span in spans for part in span.split("::")} - {"fathom", "libfathom", "std", "vector", "what", "denoised", "roots"})
        self.assertGreater(len(names), 40)
        for name in names:
            with self.subTest(name=name):
                self.assertTrue(re.search(rf"\b{name}\b", headers), f"no public header has {name}")


if __name__ == "__main__":
    unittest.main()
