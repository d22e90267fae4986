# SPDX-License-Identifier: Apache-2.0
"""Why references of peers differ from Fathom's. `counts`: the difference doesn't make the peer's task easier, so its
efficiency is compared anyway."""
import fnmatch

EXPLANATIONS = []


def explanation(renderer, scene):
    for entry in EXPLANATIONS:
        if fnmatch.fnmatch(renderer, entry["renderer"]) and fnmatch.fnmatch(scene, entry["scene"]):
            return entry
    return None
