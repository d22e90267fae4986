# SPDX-License-Identifier: Apache-2.0
"""Builds a scene in bpy for Cycles. Points (x, y, z) become (x, -z, y)."""
import math

import neutral
import numpy as np


def z_up(points):
    points = np.asarray(points, float)
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], -1)


class Materials:
    def __init__(self, bpy, sources):
        self.bpy, self.sources, self.made = bpy, sources, {}

    def of(self, item):
        key = str(item.get("emission") or item.get("material"))
        if key not in self.made:
            self.made[key] = self.build(key, item)
        return self.made[key]

    def build(self, key, item):
        material = self.bpy.data.materials.new(key)
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        if item.get("emission"):
            material.cycles.emission_sampling = "FRONT"
            tree.links.new(one_sided_emission(tree, item["emission"]).outputs[0], output.inputs["Surface"])
            return material
        source = self.sources[item["material"]]
        if source["kind"] != "medium":
            tree.links.new(surface(tree, source).outputs[0], output.inputs["Surface"])
        if "sigma_s" in source:
            tree.links.new(volume(tree, source).outputs[0], output.inputs["Volume"])
        return material


def one_sided_emission(tree, emission):
    nodes, links = tree.nodes, tree.links
    light, black, mix, geometry = (nodes.new(f"ShaderNode{kind}") for kind in ("Emission", "BsdfDiffuse", "MixShader", "NewGeometry"))
    strength = max(emission)
    light.inputs["Color"].default_value = (*(x / strength for x in emission), 1)
    light.inputs["Strength"].default_value = strength
    black.inputs["Color"].default_value = (0, 0, 0, 1)
    links.new(geometry.outputs["Backfacing"], mix.inputs[0])
    links.new(light.outputs[0], mix.inputs[1])
    links.new(black.outputs[0], mix.inputs[2])
    return mix


def surface(tree, source):
    kind = source["kind"]
    node = tree.nodes.new({"diffuse": "ShaderNodeBsdfDiffuse", "conductor": "ShaderNodeBsdfMetallic", "dielectric": "ShaderNodeBsdfGlass",
                           "hair": "ShaderNodeBsdfHairPrincipled"}[kind])
    if kind == "diffuse":
        node.inputs["Color"].default_value = (*source["color"], 1)
    elif kind == "conductor":
        node.distribution, node.fresnel_type = "GGX", "PHYSICAL_CONDUCTOR"
        node.inputs["IOR"].default_value, node.inputs["Extinction"].default_value = source["eta"], source["k"]
        node.inputs["Roughness"].default_value = math.sqrt(source["alpha"])
    elif kind == "dielectric":
        node.distribution = "GGX"
        node.inputs["Color"].default_value = (1, 1, 1, 1)
        node.inputs["IOR"].default_value, node.inputs["Roughness"].default_value = source["ior"], math.sqrt(source["alpha"])
    else:
        node.model, node.parametrization = "CHIANG", "ABSORPTION"
        node.inputs["Absorption Coefficient"].default_value = source["sigma_a"]
        node.inputs["Roughness"].default_value, node.inputs["Radial Roughness"].default_value = source["beta_m"], source["beta_n"]
        node.inputs["Coat"].default_value, node.inputs["IOR"].default_value = 0, 1.55
        node.inputs["Offset"].default_value = math.radians(source["tilt_deg"])
        node.inputs["Random Roughness"].default_value = 0
    return node


def volume(tree, source):
    node = tree.nodes.new("ShaderNodeVolumeCoefficients")
    node.phase = "HENYEY_GREENSTEIN"
    node.inputs["Absorption Coefficients"].default_value = source["sigma_a"]
    node.inputs["Scatter Coefficients"].default_value = source["sigma_s"]
    node.inputs["Anisotropy"].default_value = source["g"]
    return node


def add_mesh(bpy, scene, name, positions, faces, material, normals=None):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(z_up(positions).tolist(), [], np.asarray(faces).tolist())
    mesh.materials.append(material)
    if normals is not None:
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        mesh.normals_split_custom_set_from_vertices(z_up(normals).tolist())
    scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def subdivided(curves, steps=6):
    """Points of cubic B-splines with their radii: Blender's curves pass through their points."""
    t = np.linspace(0, 1, steps, endpoint=False)[:, None]
    weights = np.stack([(1 - t)**3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3], 1)[..., 0] / 6
    parts = [np.einsum("sk,nkc->nsc", weights, curves[:, i:i + 4]) for i in range(curves.shape[1] - 3)]
    last = (curves[:, -3] + 4 * curves[:, -2] + curves[:, -1])[:, None] / 6
    return np.concatenate([*parts, last], 1)


def add_curves(bpy, scene, name, curves, material):
    points = subdivided(np.asarray(curves, float))
    data = bpy.data.hair_curves.new(name)
    data.add_curves([points.shape[1]] * len(points))
    data.attributes["position"].data.foreach_set("vector", z_up(points[..., :3]).astype(np.float32).ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", points[..., 3].astype(np.float32).ravel())
    data.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new(name, data))
    scene.cycles_curves.shape = "THICK"


def add_light(bpy, scene, source):
    import mathutils
    kind = source["kind"]
    light = bpy.data.lights.new(kind, {"point": "POINT", "spot": "SPOT", "sun": "SUN"}[kind])
    color = source["irradiance"] if kind == "sun" else source["intensity"]
    strength = max(color)
    light.color = [x / strength for x in color]
    light.energy = strength * (1 if kind == "sun" else 4 * math.pi)
    if kind == "sun":
        light.angle = 0
    else:
        light.shadow_soft_size = 0
    if kind == "spot":
        light.spot_size, light.spot_blend = 2 * math.radians(source["half_angle_deg"]), 0
    holder = bpy.data.objects.new(kind, light)
    if "position" in source:
        holder.location = z_up(source["position"]).tolist()
    if "direction" in source:
        holder.rotation_euler = mathutils.Vector(z_up(source["direction"]).tolist()).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(holder)


def add_sky(bpy, scene, sky):
    world = scene.world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs[0].default_value = (*(sky or {}).get("constant", [0, 0, 0]), 1)
    if sky and "image" in sky:
        image = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        image.image = bpy.data.images.load(sky["image"])
        world.node_tree.links.new(image.outputs["Color"], background.inputs[0])


def add_camera(bpy, scene, source, size):
    import mathutils
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.angle_y = "VERTICAL", math.radians(source["fov_y_deg"])
    lens.clip_start, lens.clip_end = 1e-3, 1e5
    scene.camera = bpy.data.objects.new("camera", lens)
    position, target, up = (z_up(source[key]) for key in ("position", "look_at", "up"))
    back = (position - target) / np.linalg.norm(position - target)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3] = np.stack([right, np.cross(back, right), back, position], -1)
    scene.camera.matrix_world = mathutils.Matrix(matrix.tolist())
    scene.collection.objects.link(scene.camera)
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = *size, 100


def build(bpy, source):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene, materials = bpy.context.scene, Materials(bpy, source["materials"])
    for i, item in enumerate(source["objects"]):
        name = f"object{i}"
        if "quad" in item:
            add_mesh(bpy, scene, name, neutral.quad_corners(item), [[0, 1, 2, 3]], materials.of(item))
        elif "mesh" in item:
            mesh = source["meshes"][item["mesh"]]
            add_mesh(bpy, scene, name, mesh["positions"], mesh["triangles"], materials.of(item), mesh.get("normals"))
        else:
            add_curves(bpy, scene, name, source["curves"][item["curves"]], materials.of(item))
    for light in source["lights"]:
        add_light(bpy, scene, light)
    add_sky(bpy, scene, source["sky"])
    add_camera(bpy, scene, source["camera"], source["size"])
    return scene
