#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the recipes of farm/ for schedulers: they are valid by the schedulers' own rules, and their commands render the
image of one run.

    farm_test.py FATHOM PICTURE_HASH BUILD_FOLDER

Python packages are searched for in BUILD_FOLDER/../farm, where scripts/test-farm.sh installs them, and in this Python.
Tests of missing packages are skipped, with a line for each.
"""
import os
import re
import sys
import unittest
from pathlib import Path

if len(sys.argv) != 4:
    sys.exit(__doc__)
PYTHON = Path(sys.argv[3]).resolve().parent / "farm" / "bin" / "python"
if PYTHON.exists() and Path(sys.prefix) != PYTHON.parents[1]:
    os.execv(PYTHON, [str(PYTHON), *sys.argv])

from container_test import Container  # noqa: E402
from documents_test import Documents  # noqa: E402
from runners_test import Dask, OpenJobDescription, Parallel  # noqa: E402
from schedulers_test import AwsBatch, Kubernetes, OpenCue  # noqa: E402

TESTS = [Kubernetes, AwsBatch, OpenCue, OpenJobDescription, Parallel, Dask, Container, Documents]


class Result(unittest.TextTestResult):
    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        self.stream.writeln(f"skipped: {re.sub(r'.*[.]', '', test.id().rsplit('.', 1)[0])}: {reason}")


if __name__ == "__main__":
    loader = unittest.defaultTestLoader
    suite = unittest.TestSuite(loader.loadTestsFromTestCase(case) for case in TESTS)
    result = unittest.TextTestRunner(resultclass=Result).run(suite)
    sys.exit(not result.wasSuccessful())
