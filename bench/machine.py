# SPDX-License-Identifier: Apache-2.0
"""Describes the machine on which figures are measured."""
import platform


def processor():
    for line in open("/proc/cpuinfo", encoding="utf-8"):
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()
