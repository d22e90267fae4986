# SPDX-License-Identifier: Apache-2.0
"""Writes images for the page."""
import matplotlib.image
import numpy as np

matplotlib.use("Agg")


def write_png(path, image, reference):
    """sRGB, exposed so that the brightest hundredth of the reference is white."""
    white = max(1e-9, float(np.percentile(reference.mean(-1), 99)))
    linear = np.clip(np.nan_to_num(image) / white, 0, 1)
    srgb = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    matplotlib.image.imsave(path, np.round(255 * srgb).astype(np.uint8))
