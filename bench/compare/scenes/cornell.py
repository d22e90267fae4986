# SPDX-License-Identifier: Apache-2.0
"""The Cornell box of scenes/cornell-box.json in three variants: diffuse, with a mirror as back wall, and with a glossy tall box."""
from functools import partial

import neutral

ALUMINUM = {"kind": "conductor", "eta": [1.35, 0.96, 0.62], "k": [7.5, 6.4, 5.3], "alpha": 0.0}


def box(name, back="white", tall="white"):
    scene = neutral.scene(name, neutral.camera((280, 280, -800), (280, 280, 0), 40))
    scene["materials"] = {"white": {"kind": "diffuse", "color": [0.73] * 3}, "green": {"kind": "diffuse", "color": [0.12, 0.45, 0.15]},
                          "red": {"kind": "diffuse", "color": [0.65, 0.05, 0.05]}, "mirror": ALUMINUM,
                          "glossy": {**ALUMINUM, "alpha": 0.1}}
    scene["objects"] = [
        neutral.quad((555, 0, 0), (0, 0, 555), (0, 555, 0), material="green"),
        neutral.quad((0, 0, 0), (0, 555, 0), (0, 0, 555), material="red"),
        neutral.quad((0, 0, 0), (0, 0, 555), (555, 0, 0), material="white"),
        neutral.quad((0, 555, 0), (555, 0, 0), (0, 0, 555), material="white"),
        neutral.quad((0, 0, 555), (0, 555, 0), (555, 0, 0), material=back),
        neutral.quad((213, 554, 227), (130, 0, 0), (0, 0, 105), emission=[15.0] * 3),
        *neutral.box((130, 0, 65), (295, 165, 230), material="white"), *neutral.box((265, 0, 295), (430, 330, 460), material=tall)]
    return scene


SCENES = {"cornell": partial(box, "cornell"), "cornell-mirror": partial(box, "cornell-mirror", back="mirror"),
          "cornell-glossy": partial(box, "cornell-glossy", tall="glossy")}
