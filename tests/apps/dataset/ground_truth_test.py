#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Ground truth of data sets, compared with Embree (embreex) and with projections in double precision.

usage: ground_truth_test.py PROGRAM
"""
import base64
import json
import struct
import unittest

from support import DatasetTest, center_rays, need, without

need("numpy")
import numpy as np  # noqa: E402

WIDTH, HEIGHT = 160, 120


def project(view, points):
    """Pixel coordinates of world-space points in a view."""
    pose, k = view["world_from_camera"], view["intrinsics"]
    p = (points - pose[:3, 3]) @ pose[:3, :3]
    return np.stack([k[0, 2] - k[0, 0] * p[..., 0] / p[..., 2], k[1, 2] + k[1, 1] * p[..., 1] / p[..., 2]], -1)


class GroundTruth(DatasetTest):
    def views(self, *words, count=3):
        self.render(*words, "--size", f"{WIDTH}x{HEIGHT}", "--spp", 1, "--dataset", "npz", "-o", "views")
        return [np.load(self.folder / f"views/{i:06}.npz") for i in range(count)]

    @without("embreex")
    @without("trimesh")
    def test_equals_embree(self):
        """Distance, depth, normals and instances are those of Embree's hits of the same rays."""
        import trimesh
        path, meshes = self.model()
        names = [o["name"] for o in self.described(path)]
        whole = trimesh.util.concatenate([meshes[name] for name in names])
        face_instance = np.concatenate([np.full(len(meshes[name].faces), i + 1) for i, name in enumerate(names)])
        for view in self.load(3):
            o, d = center_rays(view, WIDTH, HEIGHT)
            points, rays, faces = whole.ray.intersects_location(o.reshape(-1, 3), d.reshape(-1, 3), multiple_hits=False)
            hit = np.zeros(WIDTH * HEIGHT, bool)
            hit[rays] = True
            ours = np.isfinite(view["depth"]).ravel()
            self.assertLess(np.count_nonzero(hit != ours), 4)
            both = np.flatnonzero(hit[rays] & ours[rays])
            rays, points, faces = rays[both], points[both], faces[both]
            distance = np.linalg.norm(points - o.reshape(-1, 3)[rays], axis=-1)
            # A ray through an edge may meet either triangle.
            same = np.abs(view["distance"].ravel()[rays] - distance) < 1e-4 * distance
            self.assertGreater(same.mean(), 0.999)
            rays, points, faces = rays[same], points[same], faces[same]
            pose = view["world_from_camera"]
            depth = -(points - pose[:3, 3]) @ pose[:3, 2]
            np.testing.assert_allclose(view["depth"].ravel()[rays], depth, rtol=1e-5, atol=1e-5)
            np.testing.assert_allclose(view["position"].reshape(-1, 3)[rays], points, atol=1e-4)
            normals = whole.face_normals[faces]
            normals = normals * -np.sign(np.sum(normals * d.reshape(-1, 3)[rays], -1, keepdims=True))
            agree = np.abs(view["normal"].reshape(-1, 3)[rays] - normals).max(-1) < 1e-4
            self.assertGreater(agree.mean(), 0.998)
            in_camera = view["normal"].reshape(-1, 3) @ pose[:3, :3]
            np.testing.assert_allclose(view["camera_normal"].reshape(-1, 3), in_camera, atol=1e-6)
            self.assertGreater((view["instance"].ravel()[rays] == face_instance[faces]).mean(), 0.999)

    @without("embreex")
    @without("trimesh")
    def test_whole_masks_equal_embree(self):
        """The whole mask of an object is that of a scene with this object alone; visible masks divide the instances."""
        path, meshes = self.model()
        names = [o["name"] for o in self.described(path)]
        hidden = 0
        for view in self.load(3):
            o, d = center_rays(view, WIDTH, HEIGHT)
            self.assertEqual(view["mask_whole"].shape[0], len(view["mask_instance"]))
            for instance, mask in zip(view["mask_instance"], view["mask_whole"]):
                alone = meshes[names[instance - 1]].ray.intersects_any(o.reshape(-1, 3), d.reshape(-1, 3))
                self.assertLess(np.count_nonzero(alone != mask.ravel()), 4, names[instance - 1])
                visible = view["instance"] == instance
                self.assertTrue(np.all(mask[visible]))
                hidden += np.count_nonzero(mask & ~visible)
        self.assertGreater(hidden, 500)

    def described(self, path):
        self.views(path, "--views", 3, "--on", "sphere")
        return self.read_json("views/dataset.json")["objects"]

    def load(self, count):
        return [np.load(self.folder / f"views/{i:06}.npz") for i in range(count)]

    @without("trimesh")
    def test_flow_between_views(self):
        """Flow leads to where the other camera projects the position of the pixel."""
        path, _ = self.model()
        views = self.views(path, "--views", 3, "--on", "ring")
        x, y = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
        for i, j, name in ((0, 1, "flow_forward"), (1, 0, "flow_backward"), (1, 2, "flow_forward")):
            flow = views[i][name]
            hit = np.isfinite(views[i]["depth"])
            np.testing.assert_array_equal(np.isnan(flow[..., 0]), ~hit)
            expected = project(views[j], views[i]["position"].astype(float)) - np.stack([x, y], -1)
            np.testing.assert_allclose(flow[hit], expected[hit], atol=2e-2)
        self.assertNotIn("flow_backward", views[0])
        self.assertNotIn("flow_forward", views[2])

    def test_flow_of_moving_objects(self):
        """A triangle that moves by a known way, and one that its morph target deforms, between two frames."""
        self.write_walk()
        views = self.views("walk.gltf", "--frames", "0:1", "--fps", 1, count=2)
        names = [o["name"] for o in self.read_json("views/dataset.json")["objects"]]
        moved = names.index("moving") + 1, names.index("bending") + 1
        x, y = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
        for first, sign, name in ((0, 1, "flow_forward"), (1, -1, "flow_backward")):
            view, other = views[first], views[1 - first]
            for instance, way in zip(moved, (lambda p: (0.3, 0.2, 0), lambda p: (0.5, 0, 0))):
                pixels = view["instance"] == instance
                self.assertGreater(np.count_nonzero(pixels), 100)
                there = view["position"][pixels].astype(float) + sign * np.array(way(None))
                expected = project(other, there) - np.stack([x, y], -1)[pixels]
                np.testing.assert_allclose(view[name][pixels], expected, atol=2e-2)

    def write_walk(self):
        """Two triangles in front of a camera: one node moves by (0.3, 0.2, 0) within a second, one mesh is shifted by
        (0.5, 0, 0) as a morph target."""
        def floats(*values):
            return struct.pack(f"<{len(values)}f", *values)
        pieces = [(floats(-2, -1, 0, 0, -1, 0, -1, 1, 0), "VEC3"), (floats(0, -1, -1, 2, -1, -1, 1, 1, -1), "VEC3"),
                  (floats(*[0.5, 0, 0] * 3), "VEC3"), (floats(0, 1), "SCALAR"), (floats(0, 0, 0, .3, .2, 0), "VEC3"),
                  (floats(0, 1), "SCALAR")]
        views, accessors, data = [], [], b""
        for bytes_, kind in pieces:
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(bytes_)})
            accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "type": kind,
                              "count": len(bytes_) // (12 if kind == "VEC3" else 4)})
            data += bytes_
        gltf = {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1, 2]}], "scene": 0,
                "nodes": [{"mesh": 0, "name": "moving"}, {"mesh": 1, "name": "bending"},
                          {"camera": 0, "translation": [0, 0, 5]}],
                "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]},
                           {"primitives": [{"attributes": {"POSITION": 1}, "targets": [{"POSITION": 2}]}], "weights": [0]}],
                "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}},
                                             {"sampler": 1, "target": {"node": 1, "path": "weights"}}],
                                "samplers": [{"input": 3, "output": 4}, {"input": 3, "output": 5}]}],
                "accessors": accessors, "bufferViews": views,
                "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," +
                             base64.b64encode(data).decode()}]}
        (self.folder / "walk.gltf").write_text(json.dumps(gltf))

    def test_alpha_counts_from_one_half(self):
        """A pane in front of a wall is hit where its opacity is 0.5 or more, in every pixel alike."""
        camera = {"camera_angle_x": 0.5, "frames": [{"transform_matrix": [[1, 0, 0, 0], [0, 0, -1, -2], [0, 1, 0, 0], [0, 0, 0, 1]]}]}
        (self.folder / "camera.json").write_text(json.dumps(camera))
        square = {"edge_u": [4, 0, 0], "edge_v": [0, 4, 0]}
        for opacity, depth in ((0.45, 3), (0.5, 2)):
            scene = {"fathom": 1, "environment": {"kind": "constant", "color": [1, 1, 1]},
                     "materials": {"pane": {"kind": "diffuse", "color": [0.5, 0.5, 0.5], "alpha": opacity},
                                   "wall": {"kind": "diffuse", "color": [0.5, 0.5, 0.5]}},
                     "scene": [{"rectangle": {"corner": [-2, -2, 0], **square}, "material": "pane"},
                               {"rectangle": {"corner": [-2, -2, -1], **square}, "material": "wall"}]}
            (self.folder / "pane.json").write_text(json.dumps(scene))
            self.render("pane.json", "--cameras", "camera.json", "--size", "64x64", "--spp", 1, "--dataset", "npz", "-o", f"pane{opacity}")
            view = np.load(self.folder / f"pane{opacity}/000000.npz")
            np.testing.assert_allclose(view["depth"], depth, rtol=1e-5)

    @without("trimesh")
    def test_bits_do_not_depend_on_threads_and_kernels(self):
        import os
        path, _ = self.model()
        contents = []
        for threads, kernel in ((1, "base"), (3, "base"), (2, "")):
            os.environ["FATHOM_KERNEL"] = kernel
            folder = f"bits{threads}{kernel}"
            self.render(path, "--views", 2, "--size", "67x45", "--spp", 1, "--threads", threads, "--dataset", "npz", "-o", folder)
            contents.append((self.folder / folder / "000001.npz").read_bytes())
        os.environ.pop("FATHOM_KERNEL")
        self.assertEqual(contents[0], contents[1])
        self.assertEqual(contents[0], contents[2])


if __name__ == "__main__":
    unittest.main(argv=["ground_truth_test.py"])
