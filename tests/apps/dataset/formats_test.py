#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Layouts of data sets, read by the tools of those who use them: pycocotools, bop_toolkit, trimesh.

usage: formats_test.py PROGRAM
"""
import unittest

from support import DatasetTest, need, without

need("numpy", "PIL", "trimesh")
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402

WIDTH, HEIGHT = 96, 64
Z_UP = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])


class Formats(DatasetTest):
    """Each layout is compared with the NPZ files of the same views, which ground_truth_test.py compares with Embree."""

    def write(self, *formats, views=3):
        path, self.meshes = self.model()
        for layout in (*formats, "npz"):
            self.render(path, "--views", views, "--on", "sphere", "--size", f"{WIDTH}x{HEIGHT}", "--spp", 4, "--dataset",
                        layout, "-o", layout)
        self.views = [np.load(self.folder / f"npz/{i:06}.npz") for i in range(views)]
        self.names = [o["name"] for o in self.read_json("npz/dataset.json")["objects"]]

    def image(self, path):
        return np.array(Image.open(self.folder / path))

    def test_nerf(self):
        self.write("nerf", views=12)
        counts = {}
        for split in ("train", "val", "test"):
            transforms = self.read_json(f"nerf/transforms_{split}.json")
            counts[split] = len(transforms["frames"])
            focal = 0.5 * WIDTH / np.tan(0.5 * transforms["camera_angle_x"])
            for frame in transforms["frames"]:
                i = int(frame["file_path"].rsplit("_", 1)[1])
                self.assertEqual(frame["file_path"], f"./{split}/r_{i}")
                pose = self.views[i]["world_from_camera"]
                np.testing.assert_allclose(np.array(frame["transform_matrix"])[:3], Z_UP @ pose[:3], atol=1e-12)
                np.testing.assert_allclose(focal, self.views[i]["intrinsics"][0, 0], rtol=1e-6)
                pixels = self.image(f"nerf/{frame['file_path']}.png")
                np.testing.assert_array_equal(pixels, self.views[i]["rgba"])
        self.assertEqual(counts, {"train": 10, "val": 1, "test": 1})
        corner = self.views[0]["rgba"][0, 0]
        self.assertEqual(corner[3], 0, "the background is not transparent")

    def test_nerfstudio(self):
        self.write("nerfstudio")
        transforms = self.read_json("nerfstudio/transforms.json")
        k = self.views[0]["intrinsics"]
        self.assertEqual([transforms[key] for key in ("fl_x", "fl_y", "cx", "cy", "w", "h")],
                         [k[0, 0], k[1, 1], k[0, 2], k[1, 2], WIDTH, HEIGHT])
        self.assertEqual((transforms["cx"], transforms["cy"]), (WIDTH / 2, HEIGHT / 2))
        for frame, view in zip(transforms["frames"], self.views, strict=True):
            np.testing.assert_allclose(np.array(frame["transform_matrix"])[:3], Z_UP @ view["world_from_camera"][:3], atol=1e-12)
            np.testing.assert_array_equal(self.image("nerfstudio/" + frame["file_path"]), view["rgba"])
            depth = np.where(np.isfinite(view["depth"]), view["depth"] * 1000, 0)
            self.assertLessEqual(np.abs(self.image("nerfstudio/" + frame["depth_file_path"]) - depth).max(), 0.51)

    @without("pycocotools")
    def test_coco(self):
        """pycocotools decodes the run lengths to the instances of each image."""
        from pycocotools.coco import COCO
        from pycocotools import mask as masks
        self.write("coco")
        coco = COCO(str(self.folder / "coco/annotations.json"))
        self.assertEqual(len(coco.getImgIds()), 3)
        self.assertEqual(sorted(c["name"] for c in coco.loadCats(coco.getCatIds())), sorted(["left", "ball", "plate"]),
                         "objects of one mesh are one category, unless one is stretched")
        for image in coco.loadImgs(coco.getImgIds()):
            view = self.views[image["id"] - 1]
            self.assertEqual(self.image("coco/" + image["file_name"]).shape, (HEIGHT, WIDTH, 3))
            annotations = coco.loadAnns(coco.getAnnIds(imgIds=image["id"]))
            self.assertEqual({a["instance"] for a in annotations}, set(np.unique(view["instance"])) - {0})
            for a in annotations:
                mask = coco.annToMask(a)
                np.testing.assert_array_equal(mask, view["instance"] == a["instance"])
                self.assertEqual(masks.area(a["segmentation"]), a["area"])
                np.testing.assert_array_equal(masks.toBbox(a["segmentation"]), a["bbox"])
                whole = view["mask_whole"][list(view["mask_instance"]).index(a["instance"])]
                np.testing.assert_array_equal(masks.decode(a["whole_segmentation"]), whole)

    def scene(self, name):
        return self.read_json(f"bop/train_pbr/000000/{name}.json")

    def test_bop_masks_and_poses(self):
        """A model that is placed by its pose and projected by the intrinsics has the depth and the mask of its object."""
        import trimesh
        self.write("bop")
        infos = self.read_json("bop/models/models_info.json")
        for i, view in enumerate(self.views):
            camera, objects = self.scene("scene_camera")[str(i)], self.scene("scene_gt")[str(i)]
            k = np.array(camera["cam_K"]).reshape(3, 3)
            for j, (gt, info) in enumerate(zip(objects, self.scene("scene_gt_info")[str(i)], strict=True)):
                visible = self.image(f"bop/train_pbr/000000/mask_visib/{i:06}_{j:06}.png") == 255
                whole = self.image(f"bop/train_pbr/000000/mask/{i:06}_{j:06}.png") == 255
                instance = view["mask_instance"][j]
                np.testing.assert_array_equal(visible, view["instance"] == instance)
                np.testing.assert_array_equal(whole, view["mask_whole"][j])
                self.assertEqual((info["px_count_all"], info["px_count_visib"]), (whole.sum(), visible.sum()))
                self.assertAlmostEqual(info["visib_fract"], visible.sum() / whole.sum())
                y, x = np.nonzero(whole)
                self.assertEqual(info["bbox_obj"], [x.min(), y.min(), np.ptp(x) + 1, np.ptp(y) + 1])
                model = trimesh.load(self.folder / f"bop/models/obj_{gt['obj_id']:06}.ply", process=False)
                r = np.array(gt["cam_R_m2c"]).reshape(3, 3)
                np.testing.assert_allclose(r @ r.T, np.eye(3), atol=1e-9)
                points = model.vertices @ r.T + gt["cam_t_m2c"]
                world = self.meshes[self.names[instance - 1]].vertices
                pose = view["world_from_camera"]
                expected = ((world - pose[:3, 3]) @ pose[:3, :3] * [1, -1, -1]) * 1000
                np.testing.assert_allclose(points, expected, atol=1e-2)
                pixel = points @ k.T
                pixel = pixel[:, :2] / pixel[:, 2:]
                if whole[0].any() or whole[-1].any() or whole[:, 0].any() or whole[:, -1].any():
                    continue
                self.assertLess(np.abs(pixel.min(0) - [x.min(), y.min()]).max(), 1.2)
                self.assertLess(np.abs(pixel.max(0) - [x.max(), y.max()]).max(), 1.2)
                size = [infos[str(gt["obj_id"])][f"size_{axis}"] for axis in "xyz"]
                np.testing.assert_allclose(size, np.ptp(model.vertices, axis=0), rtol=1e-5)

    @without("bop_toolkit_lib")
    def test_bop_toolkit_reads_it(self):
        """bop_toolkit's distance images are those of the rays, so its pixel centers are ours."""
        from bop_toolkit_lib import inout, misc
        self.write("bop")
        root = self.folder / "bop/train_pbr/000000"
        cameras = inout.load_scene_camera(str(root / "scene_camera.json"))
        poses = inout.load_scene_gt(str(root / "scene_gt.json"))
        models = {}
        for i, view in enumerate(self.views):
            depth = inout.load_depth(str(root / f"depth/{i:06}.png")) * cameras[i]["depth_scale"]
            hit = np.isfinite(view["depth"])
            self.assertLessEqual(np.abs(depth[hit] - 1000 * view["depth"][hit]).max(), 0.51 * cameras[i]["depth_scale"] + 1e-3)
            self.assertEqual(np.count_nonzero(depth[~hit]), 0)
            distance = misc.depth_im_to_dist_im(depth, cameras[i]["cam_K"])
            np.testing.assert_allclose(distance[hit], 1000 * view["distance"][hit], rtol=1e-5, atol=0.6 * cameras[i]["depth_scale"])
            for gt in poses[i]:
                model = models.setdefault(gt["obj_id"], inout.load_ply(str(self.folder / f"bop/models/obj_{gt['obj_id']:06}.ply")))
                projected = misc.project_pts(model["pts"], cameras[i]["cam_K"], gt["cam_R_m2c"], gt["cam_t_m2c"])
                self.assertTrue(np.isfinite(projected).all())

    def test_cameras_of_a_file(self):
        """Cameras that were written are read again as the same cameras."""
        path, _ = self.model()
        words = ("--spp", 1, "--dataset")
        self.render(path, "--views", 3, "--size", f"{WIDTH}x{HEIGHT}", *words, "npz", "-o", "first")
        self.render(path, "--views", 3, "--size", f"{WIDTH}x{HEIGHT}", *words, "nerfstudio", "-o", "studio")
        self.render(path, "--views", 12, "--size", f"{WIDTH}x{HEIGHT}", *words, "nerf", "-o", "nerf")
        self.render(path, "--views", 12, "--size", f"{WIDTH}x{HEIGHT}", *words, "npz", "-o", "twelve")
        self.render(path, "--cameras", "studio/transforms.json", *words, "npz", "-o", "second")
        self.render(path, "--cameras", "nerf/transforms_test.json", "--size", f"{WIDTH}x{HEIGHT}", *words, "npz", "-o", "third")
        for i, j, folder, other in ((0, 0, "first", "second"), (2, 2, "first", "second"), (9, 0, "twelve", "third")):
            a, b = np.load(self.folder / f"{folder}/{i:06}.npz"), np.load(self.folder / f"{other}/{j:06}.npz")
            np.testing.assert_allclose(a["world_from_camera"], b["world_from_camera"], atol=1e-7)
            np.testing.assert_allclose(a["intrinsics"], b["intrinsics"], rtol=1e-6)
            self.assertGreater(np.isclose(a["distance"], b["distance"], rtol=1e-5).mean(), 0.99)

    def test_principal_point_of_a_file(self):
        """A principal point beside the middle moves the image by as many pixels."""
        import json
        path, _ = self.model()
        self.render(path, "--views", 1, "--size", f"{WIDTH}x{HEIGHT}", "--spp", 1, "--dataset", "nerfstudio", "-o", "studio")
        cameras = self.read_json("studio/transforms.json")
        images = []
        for name, dx, dy in (("middle", 0, 0), ("moved", 8, -5)):
            for key, shift in (("cx", dx), ("cy", dy)):
                cameras["frames"][0][key] += shift
            (self.folder / f"{name}.json").write_text(json.dumps(cameras))
            self.render(path, "--cameras", f"{name}.json", "--spp", 1, "--dataset", "npz", "-o", name)
            images.append(np.load(self.folder / name / "000000.npz")["depth"])
        middle, moved = images
        same = np.isclose(np.roll(middle, (-5, 8), (0, 1))[:-8, 10:], moved[:-8, 10:], rtol=1e-4) | np.isinf(moved[:-8, 10:])
        self.assertGreater(same.mean(), 0.99)
        self.assertGreater(np.isfinite(moved).sum(), 100)


if __name__ == "__main__":
    unittest.main(argv=["formats_test.py"])
