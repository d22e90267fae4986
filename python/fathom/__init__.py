# SPDX-License-Identifier: Apache-2.0
"""Fathom, a path tracer for CPUs: renders 3D models to physically correct images.

>>> import fathom
>>> image = fathom.render("model.glb", size=(960, 540), spp=128)
>>> image.save("model.png")

docs/python.md is the guide, docs/scene-format.md lists the parameters of materials, lights and cameras.
"""
from . import options
from ._fathom import Error, ImageError, __version__, simd_name
from .difference import Difference, diff
from .image import Film, HdrLayers, Image, Interrupted
from .parameters import Camera, Environment, Light, Material, ParameterError, Texture
from .progress import Progress
from .rendering import render
from .scene import Mesh, Node, Scene, SceneWarning, load
from .views import ObjectMask, SceneObject, View, render_views

__all__ = ["Camera", "Difference", "Environment", "Error", "Film", "HdrLayers", "Image", "ImageError", "Interrupted", "Light",
           "Material", "Mesh", "Node", "ObjectMask", "ParameterError", "Progress", "Scene", "SceneObject", "SceneWarning",
           "Texture", "View", "diff", "load", "options", "render", "render_views", "simd_name"]
