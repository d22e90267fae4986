# SPDX-License-Identifier: Apache-2.0
"""Describes the machine on which figures are measured."""
import os
import platform
import subprocess


def processor():
    for line in open("/proc/cpuinfo", encoding="utf-8"):
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


def environment_of(kernel):
    """The environment in which Fathom uses this kernel; None: the best."""
    return {**os.environ, "FATHOM_KERNEL": kernel} if kernel else None


def kernels_of(program):
    """Kernels that are built and that this machine supports."""
    def runs(kernel):
        return subprocess.run([str(program), "version"], capture_output=True, env=environment_of(kernel)).returncode == 0
    return [kernel for kernel in ("avx512", "avx2", "base") if runs(kernel)]
