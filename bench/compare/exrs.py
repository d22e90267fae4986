# SPDX-License-Identifier: Apache-2.0
"""Reads OpenEXR images by bench/exr.py."""
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1]))
from exr import picture as read_exr  # noqa: E402,F401
