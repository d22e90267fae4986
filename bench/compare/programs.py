# SPDX-License-Identifier: Apache-2.0
"""Runs a program and measures it."""
import os
import subprocess
import tempfile
import time


def timed_run(command):
    """Exit status, what the program printed, elapsed seconds, and processor seconds of all its threads."""
    with tempfile.TemporaryFile("w+") as printed:
        start = time.perf_counter()
        process = subprocess.Popen([str(word) for word in command], stdout=printed, stderr=printed, stdin=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        printed.seek(0)
        return process.returncode, printed.read(), wall, usage.ru_utime + usage.ru_stime
