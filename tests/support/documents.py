# SPDX-License-Identifier: Apache-2.0
"""Code blocks of Markdown documents."""
import re
import textwrap

# Beginnings of lines in code blocks that are printed by the program, not typed.
MESSAGE = re.compile(r"fathom: |warning: |error |caustics: |[\d.]+ % of ")


def dedented(lines):
    return textwrap.dedent("\n".join(lines)).split("\n")


def blocks(text):
    """(language, lines) of each code block: fenced, or indented after an empty line or a heading. Blocks in lists, too."""
    lines, number = text.splitlines(), 0
    while number < len(lines):
        fence = re.match(r" *```(\S*)$", lines[number])
        end = number + 1
        if fence:
            while lines[end].strip() != "```":
                end += 1
            yield fence[1], dedented(lines[number + 1:end])
            end += 1
        elif lines[number].startswith("    ") and (number == 0 or not lines[number - 1] or lines[number - 1].startswith("#")):
            while end < len(lines) and (lines[end].startswith("    ") or not lines[end]):
                end += 1
            yield "", [line for line in dedented(lines[number:end]) if line]
        number = end
