#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that docs/cli.md equals the page generated from the program's tables of options.

usage: cli_docs_test.py CLI_MARKDOWN PAGE
"""
import difflib
import subprocess
import sys
from pathlib import Path

generated = subprocess.run([sys.argv[1]], check=True, capture_output=True, text=True).stdout
committed = Path(sys.argv[2]).read_text()
if generated != committed:
    sys.stdout.writelines(difflib.unified_diff(committed.splitlines(True), generated.splitlines(True), "docs/cli.md", "--help"))
    sys.exit("docs/cli.md differs from the tables of --help: run scripts/cli_docs.sh")
