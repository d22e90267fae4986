# SPDX-License-Identifier: Apache-2.0
"""Errors of images and differences of references."""
import numpy as np

TRIM = 0.001  # the share of the largest errors that the trimmed figure leaves out: fireflies
BLOCKS = 8  # blocks per side in which references are compared


def squared(image, reference):
    """Relative squared errors. The floor of the denominator is 0.01 for a reference of mean 0.12, and scales with it."""
    floor = 0.01 * (reference.mean() / 0.12) ** 2
    return (image - reference) ** 2 / (reference**2 + floor)


def relmse(image, reference):
    """Mean of the relative squared errors, with all of them and without the largest."""
    ordered = np.sort(squared(image, reference).ravel())
    return float(ordered.mean()), float(ordered[:max(1, len(ordered) - round(TRIM * len(ordered)))].mean())


def block_means(image, blocks=BLOCKS):
    """Means of blocks x blocks parts of an image, over the channels."""
    rows = np.array_split(image.mean(-1), blocks, axis=0)
    return np.array([[part.mean() for part in np.array_split(row, blocks, axis=1)] for row in rows])


def compare_references(image, halves, other, other_halves):
    """How two references differ: the ratio of means, and the largest difference of blocks, relative to the block or to the mean of
    the image, whichever is larger. Standard errors of both are estimated from two halves of each reference."""
    mean, own, others = other.mean(), block_means(image), block_means(other)
    scale = np.maximum((own + others) / 2, mean)
    relative = (own - others) / scale
    largest = np.unravel_index(np.abs(relative).argmax(), relative.shape)
    # Differences of halves in all blocks, because those of the whole images have a single degree of freedom.
    rms = lambda divisor: np.hypot(*(np.sqrt(np.mean(((block_means(a) - block_means(b)) / divisor) ** 2)) / 2
                                     for a, b in (halves, other_halves)))
    return {"mean_ratio": float(image.mean() / mean), "mean_error": float(rms(mean) / np.sqrt(own.size)),
            "block": [int(i) for i in largest], "block_difference": float(relative[largest]), "block_error": float(rms(scale))}


def verdict(comparison, tolerance=0.01):
    """`equal`: means differ by at most 1 % and blocks by at most 3 % of the mean, apart from noise; `different`: by more than
    noise explains; `noisy`: means differ by more, but within three standard errors that are larger than the tolerance."""
    apart, error = abs(comparison["mean_ratio"] - 1), comparison["mean_error"]
    block, block_error = abs(comparison["block_difference"]), comparison["block_error"]
    if apart > tolerance + 3 * error or block > 3 * tolerance + 5 * block_error:
        return "different"
    return "equal" if apart <= tolerance else "noisy"
