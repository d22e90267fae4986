# SPDX-License-Identifier: Apache-2.0
"""Reads OpenEXR images as arrays, and compares them."""
import numpy as np
import OpenEXR


def picture(path):
    channels = OpenEXR.File(str(path)).channels()
    for name in ("RGB", "RGBA"):
        if name in channels:
            return np.asarray(channels[name].pixels, dtype=np.float64)[..., :3]
    # Uses the first layer of files with several layers.
    ends = [next(c for c in channels if c == k or c.endswith("." + k)) for k in "RGB"]
    return np.stack([np.asarray(channels[c].pixels, dtype=np.float64) for c in ends], -1)


def relmse(picture, reference):
    """relMSE without the largest 0.1 % of errors; 0.01 in the denominator is for an image of mean 0.12, and is scaled
    to the reference."""
    error = ((picture - reference) ** 2 / (reference ** 2 + 0.01 * (reference.mean() / 0.12) ** 2)).ravel()
    return np.sort(error)[:-max(1, len(error) // 1000)].mean()
