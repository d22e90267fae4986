#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of fathom submit and status without a scheduler; tests/apps/distributed runs a real one."""
import json
import os
import re
import subprocess

from harness import PROGRAM, CommandLine, run_tests

# A value for each option of `fathom submit` that affects the image, by the command that gets it: the tasks that render
# parts, or the job that merges them. None: an option without a value.
OF_TASKS = {
    "--format": "json", "--scene": "s", "--variant": "v", "--up-axis": "y", "--define": "a=b", "--confine": None, "--memory": "2G", "--nice": "3",
    "--animation": "all", "--at": "1", "--size": "40x30", "--camera": "side", "--look-from": "1,2,3", "--look-at": "4,5,6",
    "--up": "1,0,0", "--fov": "30", "--orbit": "10,20", "--view": "front", "--env": "sky.hdr", "--env-rotate": "15",
    "--env-strength": "2", "--light": "file", "--sun-elevation": "30", "--sun-azimuth": "40", "--sun-direction": "1,2,3",
    "--sun-place": "50,8", "--sun-date": "2026-06-21T12:00Z", "--ground": "none", "--build": "high", "--crop": "1,2,3,4",
    "--aov": "depth", "--seed": "7", "--threads": "2", "--filter": "box", "--filter-radius": "2", "--max-depth": "9",
    "--roulette-depth": "8", "--light-sampling": "off", "--light-selection": "power", "--clamp-indirect": "3",
    "--guiding": "on", "--caustics": "on", "--background": "white", "--every": "10s",
}
OF_MERGE = {
    "--exposure": "2", "--white-balance": "3000", "--tonemap": "agx", "--ocio": "ocio://default", "--ocio-display": "d",
    "--ocio-view": "v", "--ocio-look": "l", "--ocio-input": "i", "--png-bits": "16", "--quality": "80", "--exr": "half",
    "--exr-primaries": "acescg",
}
# Flags with an optional word: each form, and the words that the merge gets.
WORDS_OF_FLAGS = {"--denoise": ("--denoise", "--denoise=auto")}
OWN = {"--help", "--output", "--spp", "--slurm", "--parts", "--partition", "--time", "--account", "--cpus-per-task", "--sbatch",
       "--config", "--fix", "--dry-run", "--unchecked", "--quiet"}
# Options that must be given with other options.
TOGETHER = {"--ocio-display": ["--ocio", "ocio://default"], "--ocio-view": ["--ocio", "ocio://default"],
            "--ocio-look": ["--ocio", "ocio://default"], "--ocio-input": ["--ocio", "ocio://default"],
            "--sun-elevation": ["--light", "sun"], "--sun-azimuth": ["--light", "sun"], "--sun-direction": ["--light", "sun"],
            "--sun-place": ["--light", "sun", "--sun-date", "2026-06-21T12:00Z"],
            "--sun-date": ["--light", "sun", "--sun-place", "50,8"], "--animation": ["--at", "1"],
            "--env-rotate": ["--env", "sky.hdr"], "--env-strength": ["--env", "sky.hdr"]}


class Submit(CommandLine):
    def scripts(self, *words, scene="box.json"):
        before = sorted(os.listdir(self.folder))
        text = self.ok("submit", scene, "--slurm", "--parts", "3", "--spp", "12", "-o", "out.exr", "--dry-run", *words).stdout
        self.assertEqual(sorted(os.listdir(self.folder)), before)
        task, merge = re.split(r"(?=^#!)", text, flags=re.M)[1:]
        for script in (task, merge):
            subprocess.run(["bash", "-n"], input=script, text=True, check=True)
        return task, merge

    def words_of(self, script, command):
        """Returns the words that a shell makes of the script's line with this command."""
        line = next(line for line in script.splitlines() if command in line).removeprefix("exec ").rstrip(" &")
        show = "render() { printf '%s\\n' \"$@\"; }; film=FILM SLURM_ARRAY_TASK_ID=2\n" + line.replace(line.split()[0], "render", 1)
        return subprocess.run(["bash", "-c", show], check=True, capture_output=True, text=True).stdout.splitlines()

    def test_words_reach_their_commands(self):
        task, merge = self.scripts("--size", "40x30", "--aov", "depth", "--seed", "7", "--exposure", "2", "--exr", "half",
                                   "--light-sampling", "off", "--every", "10s", "-o", "out.png")
        words = self.words_of(task, " render ")
        for option, value in {"--size": "40x30", "--aov": "depth", "--seed": "7", "--light-sampling": "off", "--every": "10s", "--spp": "12",
                              "--part": "2/3", "--checkpoint": "FILM"}.items():
            self.assertEqual(words[words.index(option) + 1], value)
        self.assertEqual(words[:2], ["render", os.path.realpath(self.path("box.json"))])
        self.assertFalse({"--exposure", "--exr", "-o", "--parts", "--slurm"} & set(words))
        words = self.words_of(merge, " merge ")
        self.assertEqual(words[words.index("--exposure") + 1], "2")
        self.assertEqual(words[words.index("--exr") + 1], "half")
        outputs = [words[i + 1] for i, word in enumerate(words) if word == "-o"]
        self.assertEqual([os.path.basename(name) for name in outputs], ["out.exr", "out.png"])
        self.assertTrue(all(os.path.isabs(name) for name in outputs))
        self.assertFalse({"--seed", "--size", "--spp"} & set(words))

    def test_every_option_reaches_its_command(self):
        help_text = self.ok("submit", "--help").stdout
        offered = set(re.findall(r"^  (?:-\w,)?(--[a-z-]+)", help_text, flags=re.M))
        self.assertEqual(offered, OF_TASKS.keys() | OF_MERGE.keys() | WORDS_OF_FLAGS.keys() | OWN)
        self.scene("box.json", "camera main camera side moves stride")
        with open(self.path("sky.hdr"), "wb") as file:
            file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x81")
        for options, command, other in ((OF_TASKS, " render ", " merge "), (OF_MERGE, " merge ", " render ")):
            for option, value in options.items():
                given = [option] if value is None else [option, value]
                scripts = dict(zip((" render ", " merge "), self.scripts(*given, *TOGETHER.get(option, []))))
                words = self.words_of(scripts[command], command)
                self.assertIn(option, words)
                if option == "--env":
                    value = self.path(value)
                if value is not None:
                    self.assertEqual(os.path.realpath(words[words.index(option) + 1]) if option == "--env" else words[words.index(option) + 1],
                                     os.path.realpath(value) if option == "--env" else value)
                self.assertNotIn(option, self.words_of(scripts[other], other))
        for forms in WORDS_OF_FLAGS.values():
            for form in forms:
                task, merge = self.scripts(form)
                self.assertIn(form, self.words_of(merge, " merge "))
                self.assertNotIn(form, self.words_of(task, " render "))

    def test_denoised_parts_have_what_helps(self):
        task, merge = self.scripts("--denoise", "--aov", "depth")
        words = self.words_of(task, " render ")
        self.assertEqual(words[words.index("--aov") + 1], "depth,albedo,normal")
        self.assertNotIn("--denoise", words)
        self.assertIn("--denoise", self.words_of(merge, " merge "))

    def test_what_the_job_may_take_is_said_to_the_program(self):
        task, _ = self.scripts()
        chosen = re.search(r"^memory=.*?(?=^before)", task, flags=re.M | re.S)[0] + 'echo "${memory[@]}"'
        for of_slurm, words in ("4096", "--memory 4096Mi"), ("0", ""), (None, ""):
            environment = {**os.environ, "SLURM_MEM_PER_NODE": of_slurm} if of_slurm else {**os.environ}
            said = subprocess.run(["bash", "-c", chosen], env=environment, capture_output=True, text=True, check=True).stdout
            self.assertEqual(said.strip(), words)
        line = next(line for line in task.splitlines() if " render " in line)
        self.assertIn('"${memory[@]}"', line)
        task, _ = self.scripts("--memory", "2G", "--nice", "5")
        words = self.words_of(task, " render ")
        self.assertEqual((words[words.index("--memory") + 1], words[words.index("--nice") + 1]), ("2G", "5"))
        self.assertNotIn("SLURM_MEM", task)

    def test_any_name_stays_one_word(self):
        for name in ("two words.json", "it's.json", "$HOME.json", "a;b.json", "50%a.json"):
            os.makedirs(self.path("in " + name), exist_ok=True)
            self.scene(os.path.join("in " + name, name), "camera main")
            task, _ = self.scripts(scene=os.path.join("in " + name, name))
            self.assertEqual(os.path.basename(self.words_of(task, " render ")[1]), name)

    def test_slurm_is_told(self):
        task, merge = self.scripts("--partition", "fast", "--time", "1:00:00", "--account", "me", "--cpus-per-task", "4",
                                   "--sbatch", "--qos=low  --mem=8G")
        for word in ("--partition=fast", "--time=1:00:00", "--account=me", "--qos=low", "--mem=8G"):
            self.assertIn(f"#SBATCH {word}\n", task)
            self.assertIn(f"#SBATCH {word}\n", merge)
        self.assertIn("#SBATCH --cpus-per-task=4\n", task)
        self.assertNotIn("--cpus-per-task", merge)
        self.assertIn("#SBATCH --array=1-3\n", task)
        self.assertIn("--signal=B:USR1@120", task)
        self.assertIn("--signal=B:USR1@30", self.scripts("--time", "5")[0])
        self.assertIn("--signal=B:USR1@60", self.scripts("--time", "10:00")[0])
        self.assertIn("--signal=B:USR1@10", self.scripts("--time", "1")[0])
        self.assertIn("--signal=B:USR1@120", self.scripts("--time", "1-0")[0])

    def test_refused(self):
        self.refused(2, "submit", "box.json", "-o", "out.exr", "--parts", "2", words=["--slurm"])
        self.refused(2, "submit", "box.json", "--slurm", "--parts", "2", words=["-o"])
        self.refused(2, "submit", "box.json", "--slurm", "-o", "out.exr", words=["--parts"])
        self.refused(2, "submit", "box.json", "--slurm", "-o", "out.exr", "--parts", "9", "--spp", "8", words=["--parts", "8", "9"])
        self.refused(2, "submit", "box.json", "--slurm", "-o", "out.exr", "--parts", "0", words=["--parts"])
        self.refused(1, "submit", "box.json", "--slurm", "-o", "missing/out.exr", "--parts", "2", words=["missing"])
        self.refused(1, "submit", "box.json", "--slurm", "-o", "out.exr", "--parts", "2", words=["sbatch", "--dry-run"],
                     env={**os.environ, "PATH": "/nowhere"})

    def test_noise_of_parts_together(self):
        """Errors of independent parts add by their squares, weighted by each part's fraction of the samples."""
        if not PROGRAM:
            self.skipTest("no program given")
        real = lambda *words: self.ok(*words, program=PROGRAM)
        self.scene("lit.json", json.dumps({
            "fathom": 1, "camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]},
            "environment": {"kind": "gradient", "bottom": [0, 0, 0]}, "materials": {"m": {"kind": "diffuse"}},
            "scene": [{"sphere": {"center": [0, 0, 0], "radius": 1}, "material": "m"}]}))
        os.mkdir(self.path("out.exr.parts"))
        plan = {"version": 1, "program": PROGRAM, "scene": self.path("lit.json"), "render_options": [], "image_options": [],
                "outputs": [self.path("out.exr")], "parts": 2, "samples": 48, "scheduler_options": [], "submissions": []}
        self.scene("out.exr.parts/plan.json", json.dumps(plan))
        noise = []
        for number in (1, 2):
            name = f"out.exr.parts/part-000{number}.exr"
            real("render", "lit.json", "--size", "24x24", "--spp", "48", "--part", f"{number}/2", "--checkpoint", name, "-q")
            told = json.loads(real("info", name, "--json").stdout)["noise"]
            noise.append(told["standard_error"] / told["mean"])
        status = json.loads(real("status", "out.exr", "--json").stdout)
        self.assertEqual([part["samples"] for part in status["parts"]], [24, 24])
        expected = ((noise[0] / 2) ** 2 + (noise[1] / 2) ** 2) ** 0.5
        self.assertAlmostEqual(status["noise"] / expected, 1, places=3)

    def test_plans(self):
        self.refused(1, "status", "out.exr", words=["submit it first"])
        self.refused(1, "submit", "--fix", "out.exr", words=["submit it first"])
        os.mkdir(self.path("out.exr.parts"))
        plan = {"version": 1, "program": "fathom", "scene": "/box.json", "render_options": [], "image_options": [],
                "outputs": [self.path("out.exr")], "parts": 3, "samples": 7, "scheduler_options": [], "submissions": []}
        damaged = ["", "[]", "{", '{"version": 2}', json.dumps({**plan, "parts": 0}), json.dumps({**plan, "parts": -1}),
                   json.dumps({**plan, "samples": 2}), json.dumps({**plan, "outputs": []}), json.dumps({**plan, "parts": "x"}),
                   json.dumps({**plan, "parts": 1e30}), json.dumps({**plan, "samples": 7.5}),
                   json.dumps({**plan, "submissions": [{"array": "--me", "merge": "", "parts": []}]}), json.dumps({**plan, "samples": 1 << 40})]
        for text in damaged:
            self.scene("out.exr.parts/plan.json", text)
            self.refused(1, "status", "out.exr", words=["plan.json"])
        self.scene("out.exr.parts/plan.json", json.dumps(plan))
        self.scene("out.exr.parts/part-0002.exr", "no film")
        told = json.loads(self.ok("status", "out.exr", "--json", env={**os.environ, "PATH": "/nowhere"}).stdout)
        self.assertEqual([(part["part"], part["state"], part["of"]) for part in told["parts"]],
                         [(1, "missing", 2), (2, "damaged", 2), (3, "missing", 3)])
        self.assertFalse(told["scheduler_answers"])
        self.assertIn("doesn't answer", self.ok("status", "out.exr", env={**os.environ, "PATH": "/nowhere"}).stdout)


if __name__ == "__main__":
    run_tests()
