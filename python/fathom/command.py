# SPDX-License-Identifier: Apache-2.0
"""The command ``fathom`` of the wheel: replaces itself by the program."""
import os
import pathlib
import sys

from .denoiser import point_to_denoiser


def main() -> None:
    """Runs the bundled program with the arguments of this process."""
    program = pathlib.Path(__file__).parent / "bin" / "fathom"
    point_to_denoiser()
    os.execv(program, [str(program), *sys.argv[1:]])
