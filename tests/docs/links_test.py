#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that relative links and #anchors of the documents resolve, and that docs/README.md leads to each page of docs/.

usage: links_test.py ROOT

Covers the pages of the root such as README.md, every page of docs/, and the README.md of every folder. Web links are not
followed, and code blocks are ignored.
"""
import pathlib
import re
import sys
import unittest
from html import unescape
from urllib.parse import unquote

ROOT = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve()
LEFT_OUT = {"build", ".git", ".cache"}

LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\])*\]\(<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\)")
REFERENCE = re.compile(r"^ {0,3}\[[^\]]+\]:\s*<?([^\s>]+)", re.MULTILINE)
ATTRIBUTE = re.compile(r"<(?:img|a|source)\b[^>]*?\b(?:src|href|srcset)=\"([^\"]+)\"")
HEADING = re.compile(r"^ {0,3}#{1,6}\s+(.*?)\s*#*\s*$")
OWN_ANCHOR = re.compile(r"<a\s+(?:id|name)=\"([^\"]+)\"")


def pages():
    found = set(ROOT.glob("*.md")) | set((ROOT / "docs").rglob("*.md"))
    found |= {page for page in ROOT.rglob("README.md") if not LEFT_OUT & set(page.relative_to(ROOT).parts)}
    return sorted(found)


def prose(text):
    """The text without code: fenced blocks, indented blocks after an empty line, and code spans."""
    lines, fence, indented, empty, in_list = [], None, False, True, False
    for line in text.splitlines():
        mark = re.match(r"\s*(```+|~~~+)", line)
        if fence:
            if mark and mark.group(1).startswith(fence):
                fence = None
            line = ""
        elif mark:
            fence, line = mark.group(1), ""
        else:
            in_list = bool(re.match(r"\s*([-*+]|\d+[.)])\s", line)) or (in_list and (not line.strip() or line[0] == " "))
            indented = line.startswith("        " if in_list else "    ") and (empty or indented)
            if indented:
                line = ""
        empty = not line.strip() and not indented
        lines.append(line)
    return re.sub(r"(`+)(?!`)(.+?)(?<!`)\1(?!`)", lambda m: "`" * len(m.group(0)), "\n".join(lines))


def links(text):
    words = prose(text)
    for pattern in (LINK, REFERENCE, ATTRIBUTE):
        for match in pattern.finditer(words):
            yield unescape(match.group(1))


def anchors(text):
    """Anchors that GitHub derives from the headings."""
    found, count, fenced = set(), {}, False
    for line in text.splitlines():
        if re.match(r"\s*(```|~~~)", line):
            fenced = not fenced
        heading = None if fenced else HEADING.match(line)
        if heading:
            words = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1))
            words = re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")
            times = count.get(words, 0)
            count[words] = times + 1
            found.add(f"{words}-{times}" if times else words)
        found.update(OWN_ANCHOR.findall(line))
    return found


def target(page, link):
    """(file, anchor) of a relative link of a page; None for a web link."""
    if re.match(r"[a-zA-Z][a-zA-Z0-9+.-]*:", link):
        return None
    name, _, anchor = link.partition("#")
    return ((page.parent / unquote(name)).resolve() if name else page), unquote(anchor)


class Links(unittest.TestCase):
    def test_each_link_leads_somewhere(self):
        broken = []
        for page in pages():
            for link in links(page.read_text(encoding="utf-8")):
                place = target(page, link)
                if place is None:
                    continue
                file, anchor = place
                if ROOT != file and ROOT not in file.parents:
                    broken.append(f"{page.relative_to(ROOT)}: {link}: is outside the repository")
                elif not file.exists():
                    broken.append(f"{page.relative_to(ROOT)}: {link}: no such file")
                elif anchor and file.suffix == ".md" and anchor not in anchors(file.read_text(encoding="utf-8")):
                    broken.append(f"{page.relative_to(ROOT)}: {link}: no such heading")
        self.assertEqual([], broken, "\n" + "\n".join(broken))

    def test_each_page_of_docs_is_reachable(self):
        start = ROOT / "docs" / "README.md"
        seen, waiting = {start}, [start]
        while waiting:
            page = waiting.pop()
            for link in links(page.read_text(encoding="utf-8")):
                place = target(page, link)
                if place and place[0] not in seen and place[0].exists():
                    seen.add(place[0])
                    # Links are followed only from pages in docs/, because the index itself must lead to all of them.
                    if place[0].suffix == ".md" and ROOT / "docs" in place[0].parents:
                        waiting.append(place[0])
        lost = [str(page.relative_to(ROOT)) for page in sorted((ROOT / "docs").rglob("*.md")) if page not in seen]
        self.assertEqual([], lost, "no link from docs/README.md leads to " + ", ".join(lost))

    def test_the_test_itself(self):
        text = ("# A title, `--with` (code)\n## Twice\n## Twice\n[a](b.md#c) ![i](i.png) [w](https://x.org) `[no](n.md)`\n\n"
                "    [no](code.md)\n\n- item\n\n  [yes](y.md)\n\n```\n[no](f.md)\n# No\n```\n<img src=\"j.png\">\n")
        self.assertEqual(["b.md#c", "i.png", "https://x.org", "y.md", "j.png"], list(links(text)))
        self.assertEqual({"a-title---with-code", "twice", "twice-1"}, anchors(text))
        page = ROOT / "docs" / "x.md"
        self.assertEqual((ROOT / "README.md", "a"), target(page, "../README.md#a"))
        self.assertIsNone(target(page, "mailto:a@b"))


if __name__ == "__main__":
    unittest.main()
