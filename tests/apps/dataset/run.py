#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a test of data sets by the Python of the build folder, which has NumPy, or else by this one.

usage: run.py PYTHON TEST PROGRAM
"""
import os
import sys

python, *words = sys.argv[1:]
if not os.path.exists(python):
    python = sys.executable
os.execv(python, [python, "-B", *words])
