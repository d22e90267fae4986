# SPDX-License-Identifier: Apache-2.0
"""Stands in for the package mitsuba: writes the dictionaries of exporters/mitsuba.py as Mitsuba's XML."""
import xml.etree.ElementTree as xml

import numpy as np

ELEMENTS = {"path": "integrator", "volpath": "integrator", "perspective": "sensor", "hdrfilm": "film", "box": "rfilter", "independent": "sampler",
            "homogeneous": "medium", "hg": "phase", "area": "emitter", "point": "emitter", "spot": "emitter", "directional": "emitter",
            "constant": "emitter", "envmap": "emitter", "rectangle": "shape", "ply": "shape", "bsplinecurve": "shape"}
POINTS, VECTORS = {"position"}, {"direction"}


class ScalarTransform4f:
    """The few transforms that the exporter uses."""

    def __init__(self, matrix=None):
        self.matrix = np.eye(4) if matrix is None else np.array(matrix, float)

    def look_at(self, origin, target, up):
        origin, target, up = (np.array(x, float) for x in (origin, target, up))
        forward = (target - origin) / np.linalg.norm(target - origin)
        left = np.cross(up, forward) / np.linalg.norm(np.cross(up, forward))
        matrix = np.eye(4)
        matrix[:3] = np.stack([left, np.cross(forward, left), forward, origin], -1)
        return ScalarTransform4f(matrix)

    def rotate(self, axis, degrees):
        assert list(axis) == [0, 1, 0]
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        return ScalarTransform4f([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]])


def add(parent, name, value):
    if isinstance(value, ScalarTransform4f):
        transform = xml.SubElement(parent, "transform", name=name)
        xml.SubElement(transform, "matrix", value=" ".join(f"{x:.9g}" for x in value.matrix.ravel()))
    elif not isinstance(value, dict):
        add_value(parent, name, value)
    elif value["type"] == "ref":
        xml.SubElement(parent, "ref", id=value["id"])
    elif value["type"] == "rgb":
        xml.SubElement(parent, "rgb", name=name, value=" ".join(f"{float(x):.9g}" for x in value["value"]))
    else:
        extra = {"id": value["id"]} if "id" in value else {}
        extra |= {"name": "interior"} if name == "interior" else {}
        element = xml.SubElement(parent, ELEMENTS.get(value["type"], "bsdf"), type=value["type"], **extra)
        for key, part in value.items():
            if key not in ("type", "id"):
                add(element, key, part)


def add_value(parent, name, value):
    if name in POINTS | VECTORS:
        xml.SubElement(parent, "point" if name in POINTS else "vector", name=name, value=" ".join(f"{x:.9g}" for x in value))
        return
    kind = {bool: "boolean", int: "integer", float: "float", str: "string"}[type(value)]
    xml.SubElement(parent, kind, name=name, value=str(value).lower() if kind == "boolean" else str(value))


def write(scene, path):
    root = xml.Element("scene", version="3.0.0")
    for key, part in scene.items():
        if key != "type":
            add(root, key, part)
    xml.ElementTree(root).write(path)
    return path
