# SPDX-License-Identifier: Apache-2.0
"""Open Image Denoise from the package pyoidn."""
import importlib.util
import os
import pathlib


def point_to_denoiser() -> None:
    """Sets FATHOM_OIDN to the library of pyoidn, if that is installed for this interpreter and the variable is not set."""
    if "FATHOM_OIDN" in os.environ:
        return
    package = importlib.util.find_spec("pyoidn")
    for folder in (package.submodule_search_locations if package else None) or ():
        library = pathlib.Path(folder, "oidn", "lib")
        if (library / "libOpenImageDenoise.so.2").exists():
            os.environ["FATHOM_OIDN"] = str(library)
