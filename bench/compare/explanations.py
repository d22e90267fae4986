# SPDX-License-Identifier: Apache-2.0
"""Why references of peers differ from Fathom's. `counts`: the difference doesn't make the peer's task easier, so its
efficiency is compared anyway."""
import fnmatch

EXPLANATIONS = [
    {"renderer": "luxcore*", "scene": "metals", "counts": True,
     "text": "LuxCore's rough metals have Schlick's distribution of normals, not GGX"},
    {"renderer": "luxcore*", "scene": "cornell-glossy", "counts": True,
     "text": "LuxCore's rough metals have Schlick's distribution of normals, not GGX"},
    {"renderer": "luxcore*", "scene": "environment", "counts": True,
     "text": "LuxCore's rough metals have Schlick's distribution of normals, not GGX"},
    {"renderer": "cycles", "scene": "caustic-*-area", "counts": False,
     "text": "path tracing alone: a few bright samples decide the caustic, so that the reference is not converged"},
    {"renderer": "cycles", "scene": "caustic-*", "counts": False, "text": "path tracing finds no caustic of a lamp without surface: it is missing"},
    {"renderer": "luxcore", "scene": "caustic-*", "counts": False, "text": "path tracing finds no caustic of a lamp without surface: it is missing"},
    {"renderer": "mitsuba", "scene": "caustic-*", "counts": False, "text": "path tracing finds no caustic of a lamp without surface: it is missing"},
    {"renderer": "mitsuba-ptracer", "scene": "caustic-pool-*", "counts": False, "text": "light tracing shows nothing behind water"},
    {"renderer": "*", "scene": "caustic-pool-*", "counts": False,
     "text": "Fathom's default shows no caustic of a lamp without surface behind water (fathom-caustics-merged does), and meets that of the square by chance"},
    {"renderer": "mitsuba", "scene": "room-veach-bidir", "counts": True,
     "text": "single bright pixels: its path tracing meets the caustics of the glass egg by chance, and its reference is not converged"},
]


def explanation(renderer, scene):
    for entry in EXPLANATIONS:
        if fnmatch.fnmatch(renderer, entry["renderer"]) and fnmatch.fnmatch(scene, entry["scene"]):
            return entry
    return None
