#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the code blocks of the README and of the guide.

usage: blocks_test.py ROOT BUILD PROGRAM FAKE_OIDN [OPTION_OF_CMAKE]...

The options are those that a program which uses the library is configured with.

Commands run in a folder with small scenes, where `fathom` is a wrapper that makes images small. A file named after -o or
> must exist afterwards. A block or command that can't run here is listed in NOT_RUN, with the test that runs it or the
reason; an entry without a command is an error, so the list stays true. What the machine lacks is printed.
"""
import json
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

ROOT, BUILD, PROGRAM, FAKE_OIDN = (pathlib.Path(word).absolute() for word in sys.argv[1:5])
CMAKE_OPTIONS = sys.argv[5:]
sys.path.insert(0, str(ROOT / "tests" / "support"))
sys.dont_write_bytecode = True
import waiting  # noqa: E402
from documents import MESSAGE, blocks  # noqa: E402
from example_files import SCENE, write_example_files  # noqa: E402

PAGES = ["README.md", "SECURITY.md",
         *(f"docs/{name}.md" for name in (
             "install", "troubleshooting", "pipes", "cli", "error", "denoising", "formats", "gallery", "coming-from",
             "limits", "long-renders", "clusters", "untrusted-files", "python", "library", "datasets", "diff", "why")),
         *sorted(str(page.relative_to(ROOT)) for page in (ROOT / "docs" / "farm").glob("*.md"))]

BARE = "scripts/bare_machine_test.sh runs it in a minimal system"
PACKAGES = "scripts/package_test.sh runs it in a minimal system"
WHEELS = "compiles for minutes, with packages from the network; python/tests test the package"
CONTAINERS = "needs a container engine; tests/farm/container_test.py tests the files"
SCHEDULERS = "needs a scheduler; tests/farm/schedulers_test.py tests the files, and runs the commands in them"
RUNNERS = "tests/farm/runners_test.py runs it, if the runner is installed"
NETWORK = "needs the network"
ACTION = "a list of the action, which tests/scripts/action_test.py runs"
LIBRARY = "test_the_library_guide"
DIFFERENCES = "tests/apps/command_line/diff_test.py compares such images"
CLUSTER = "needs Slurm; tests/apps/command_line/submit_test.py and scripts/test-cluster.sh run it"

# Page: {beginning of a command: where it is run instead, or why it can't be run}.
NOT_RUN = {
    "README.md": {"tar xzf": PACKAGES, "fathom-0.1.0/bin/fathom": PACKAGES, "./render.sh": BARE},
    "docs/install.md": {
        "tar xzf": PACKAGES, "fathom-0.1.0/bin/fathom": PACKAGES, "ln -s": PACKAGES, "fathom version": PACKAGES,
        "source <(fathom": PACKAGES, "mkdir": PACKAGES, "fathom man": PACKAGES, "apt-get": PACKAGES, "fathom render model.glb": PACKAGES,
        "podman": CONTAINERS, "scripts/wheel.sh": WHEELS, "pip install": WHEELS, "./render.sh": BARE, "./test.sh": BARE,
        "scripts/package.sh": "scripts/package_test.sh runs it"},
    "docs/pipes.md": {"fathom render scene.json --watch": "test_watching"},
    "docs/cli.md": {"fathom COMMAND": "the form of all commands", "fathom submit scene.json --spp": CLUSTER,
                    "fathom submit --fix": CLUSTER, "fathom status": CLUSTER},
    "docs/diff.md": {"fathom render scene.json --spp 64 -o new.png": DIFFERENCES,
                     "fathom render scene.json --spp 64 -o new.exr --mergeable --reference": DIFFERENCES,
                     "# reference": ACTION, "references/": ACTION},
    "docs/troubleshooting.md": {"pip install": NETWORK},
    "docs/denoising.md": {"pip install": NETWORK},
    "docs/clusters.md": {
        "fathom submit": CLUSTER, "fathom status": CLUSTER, "cmake": "compiles for minutes, with another MPI",
        "fathom merge film.exr film.rank": "needs the files of a run that was killed; tests/apps/distributed tests them",
        "mpirun.mpich": "needs a build with another MPI"},
    "docs/python.md": {"pip install": WHEELS},
    "docs/library.md": {"./render.sh": LIBRARY, "cmake --build": LIBRARY, "cmake --install": LIBRARY},
    "docs/farm/aws-batch.md": {"aws batch": SCHEDULERS},
    "docs/farm/container.md": {"docker": CONTAINERS, "FROM": CONTAINERS, "COPY": CONTAINERS},
    "docs/farm/dask.md": {"farm/dask/render.py": RUNNERS},
    "docs/farm/kubernetes.md": {"kubectl": SCHEDULERS},
    "docs/farm/opencue.md": {"farm/opencue/submit.py /films/scene.json /films --parts 16 --spp 4096 --show": SCHEDULERS},
    "docs/farm/openjd.md": {"openjd": RUNNERS},
    "docs/farm/ssh.md": {"parallel": RUNNERS, "fathom merge": RUNNERS},
}
# Parts of a page's commands that depend on the machine, or that a scheduler replaces.
REPLACED = {
    "SECURITY.md": [("job/", "")],
    "docs/troubleshooting.md": [("FILE", "model.glb"), ("/opt/oidn/lib", str(FAKE_OIDN))],
    "docs/gallery.md": [("scripts/", f"{ROOT}/scripts/")],
    "README.md": [("NAME", "{still-life,model,environment,displacement,motion-nodes,cornell-box}")],
    "docs/cli.md": [("fathom render model.glb -o images/", "mkdir images; fathom render model.glb -o images/")],
    "docs/farm/*": [("/films/", ""), ("/films", "."), ("$(JOB_COMPLETION_INDEX)", "2"), ("#IFRAME#", "3"),
                    ("part-1.exr ... part-16.exr", "part-*[0-9].exr"), ("farm/", f"{ROOT}/farm/")],
}
# Page, beginning of an output that it shows, and words of a command that prints it.
OUTPUTS = [
    ("docs/error.md", "error ", "render model.glb --size 64x48 --spp 64"),
    ("docs/limits.md", "fathom: scene.json: needs", "render scene.json --size 8192x8192 --memory 1G"),
    ("docs/troubleshooting.md", "fathom: scene.json: needs", "render scene.json --size 8192x8192 --memory 300M"),
    ("docs/troubleshooting.md", "fathom: warning: scene.xml: 37", "render scene.xml --size 16x12 --spp 1"),
    ("docs/troubleshooting.md", "fathom: The following argument", "render scene.json --fooo"),
]
ENVIRONMENT = {"AWS_BATCH_JOB_ARRAY_INDEX": "4"}
# A line that says how a command is called.
SYNOPSIS = re.compile(r"\[OPTION\]|SHELL$")
# Programs that a machine may lack.
OPTIONAL = "mpirun", "man", "zsh", "fish", "ffmpeg"

# `fathom` in PATH: images are small, few samples and a fifth of a second are enough, and there is no window to open. Errors
# can't be estimated in the smallest images.
WRAPPER = f"""#!{sys.executable}
import os, subprocess, sys
command, *words = sys.argv[1:]
given = {{word.split("=")[0] for word in words}}
size = "64x48" if "--error" in given else "16x12"
if "--only-sample" in given:
    words += ["--size", "640x480"]
elif command == "render":
    if "--size" in given:
        words[words.index("--size") + 1] = size
    else:
        words += ["--size", size]
    if "--time" in given and "--error" not in given:
        words[words.index("--time") + 1] = "0.2"
    if not {{"--spp", "--samples", "--error", "--time", "--config"}} & given:
        words += ["--spp", "4"]
if command != "view":
    os.execv({str(PROGRAM)!r}, ["fathom", command, *words])
shown = subprocess.run([{str(PROGRAM)!r}, command, *words], stderr=subprocess.PIPE, text=True)
sys.exit(not (shown.returncode == 1 and ("no display" in shown.stderr or "has no window" in shown.stderr)))
"""


def commands(language, lines):
    """The commands of a block: those below "Examples:" in help texts. Continued lines are joined, remarks are removed."""
    if language or any(line.startswith("Exit codes:") for line in lines):
        lines = [line[2:] for line in lines if line.startswith("  ")] if not language else []
    joined = re.sub(r"\\\n\s*", "", "\n".join(lines))
    return [re.split(r" {3,}", line)[0] for line in joined.splitlines()]


def page_commands(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    return [command for language, lines in blocks(text) if not is_library_code(page, lines) for command in commands(language, lines)]


def is_library_code(page, lines):
    """Whether a block is C++, CMake or a diagram; test_the_library_guide takes care of these."""
    return page == "docs/library.md" and not re.match(r"\./|cmake ", lines[0])


def replaced(page, command):
    for pattern, pairs in REPLACED.items():
        if pathlib.PurePath(page).match(pattern):
            for old, new in pairs:
                command = command.replace(old, new)
    # The README's command stands for several, with other names.
    names = re.search(r"\{([\w-]+(?:,[\w-]+)+)\}", command)
    return [command.replace(names[0], name) for name in names[1].split(",")] if names else [command]


def written_files(command):
    """Files that a command writes, if their names are not patterns."""
    return [name for name in re.findall(r"(?:-o |>)([\w./-]+\.\w+)", command) if "#" not in name]


def without_numbers(text):
    """A text whose numbers, which are examples, are 0."""
    return re.sub(r"\d([\d.,]*\d)?", "0", text)


class Folder(unittest.TestCase):
    """A test with a folder of small scenes, and with the wrapper and a fake of curl in PATH."""

    def setUp(self):
        self.make_folder()

    def make_folder(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        write_example_files(self.folder, ROOT)
        tools = self.folder / "bin"
        tools.mkdir()
        (tools / "fathom").write_text(WRAPPER)
        (tools / "curl").write_text("#!/bin/sh\ncat model.glb\n")
        for tool in tools.iterdir():
            tool.chmod(0o755)
        (self.folder / ".config/fish/completions").mkdir(parents=True)
        self.environment = {**os.environ, **ENVIRONMENT, "PATH": f"{tools}:{os.environ['PATH']}", "HOME": str(self.folder),
                            "FATHOM_OIDN": str(FAKE_OIDN), "MANPAGER": "cat", "OMPI_ALLOW_RUN_AS_ROOT": "1",
                            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1"}
        self.environment.pop("DISPLAY", None)

    def run_command(self, command):
        shell = ["zsh", "-fec", f"autoload -U compinit; compinit -u; {command}"] if "completion zsh" in command else \
            ["bash", "-o", "pipefail", "-ec", command]
        result = waiting.run(shell, cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL)
        self.assertEqual(0, result.returncode, f"{command}\n{result.stdout[-2000:]}{result.stderr[-2000:]}")
        for name in written_files(command):
            self.assertTrue((self.folder / os.path.expanduser(name)).stat().st_size, f"{command}: {name} is empty")
        return result.stdout + result.stderr


class Blocks(Folder):
    def test_commands(self):
        for page in PAGES:
            self.make_folder()
            used = set()
            text = (ROOT / page).read_text(encoding="utf-8")
            for language, lines in blocks(text):
                if language == "text" and page == "docs/pipes.md":
                    (self.folder / "preview.conf").write_text("\n".join(lines) + "\n")
            if page in ("docs/cli.md", "docs/diff.md"):
                self.make_images_to_compare()
            for command in page_commands(page):
                with self.subTest(page=page, command=command):
                    reason = next((start for start in NOT_RUN.get(page, {}) if command.startswith(start)), None)
                    missing = [program for program in OPTIONAL if program in command.split() and not shutil.which(program)]
                    if reason:
                        used.add(reason)
                    elif MESSAGE.match(command):
                        continue  # names_test.py looks for it in the sources
                    elif SYNOPSIS.search(command):
                        self.check_synopsis(command)
                    elif missing:
                        print(f"{page}: not run, {missing[0]} is not installed: {command}")
                    else:
                        for one in replaced(page, command):
                            self.run_command(one)
            with self.subTest(page=page):
                self.assertEqual(set(NOT_RUN.get(page, {})), used, "entries of NOT_RUN without a command")

    def make_images_to_compare(self):
        self.run_command("fathom render scene.json -o old.png")
        self.run_command("fathom render scene.json --mergeable --aov depth -o old.exr")
        for suffix in "png", "exr":
            shutil.copyfile(self.folder / f"old.{suffix}", self.folder / f"new.{suffix}")

    def check_synopsis(self, synopsis):
        help_text = waiting.run([PROGRAM, synopsis.split()[1], "--help"], check=True).stdout
        self.assertIn("Usage: " + synopsis.replace("[OPTION]... ", ""), help_text.replace("[OPTIONS] ", ""))

    def test_reasons_name_files_that_exist(self):
        for reasons in NOT_RUN.values():
            for reason in reasons.values():
                for name in re.findall(r"(?:scripts|tests)/[\w./-]+\w", reason):
                    self.assertTrue((ROOT / name).exists(), name)

    def test_other_languages(self):
        for page in PAGES:
            languages = {language for language, _ in blocks((ROOT / page).read_text(encoding="utf-8"))} - {""}
            expected = {"README.md": {"python"}, "docs/python.md": {"python"}, "docs/datasets.md": {"python"}, "docs/diff.md": {"python", "text", "yaml"},
                        "docs/pipes.md": {"text"},
                        "docs/troubleshooting.md": {"text"}, "docs/untrusted-files.md": {"text"}, "docs/why.md": {"text"}}
            self.assertEqual(expected.get(page, set()), languages, page)
        # workflows_test.py checks the YAML of docs/diff.md.
        for page in 'ROOT / "README.md"', *(f'ROOT / "docs" / "{name}.md"' for name in ("python", "datasets", "diff")):
            self.assertIn(page, (ROOT / "python/tests/test_guide.py").read_text())

    def test_packages_are_installed_in_the_readme_as_in_the_guide(self):
        guide = page_commands("docs/install.md")
        for start in "tar xzf", "fathom-0.1.0/bin/fathom":
            in_readme = [command for command in page_commands("README.md") if command.startswith(start)]
            self.assertEqual([command for command in guide if command.startswith(start)], in_readme)

    def test_scenes(self):
        """Renders each block of docs/scene-format.md, added to a small scene unless it is a whole one, without a warning."""
        self.run_command("fathom render scene.json -o globe.jpg && cp globe.jpg bricks.jpg && fathom convert model.obj chair.glb")
        photometry = "IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 2 1 1 2 0 0 0\n1 1 0\n0 90\n0\n100 50\n"
        (self.folder / "downlight.ies").write_text(photometry)
        found = list(blocks((ROOT / "docs" / "scene-format.md").read_text(encoding="utf-8")))
        self.assertGreater(len(found), 3)
        for number, (_, lines) in enumerate(found):
            text = "\n".join(lines)
            block = json.loads(text if text.startswith("{") else f"{{{text}}}")
            if "box" in block:
                block = {"scene": [block], "textures": {"bricks": {"image": "bricks.jpg"}}}
            scene = block if "fathom" in block else {**SCENE, **block}
            (self.folder / f"{number}.json").write_text(json.dumps(scene))
            with self.subTest(text):
                self.assertNotIn("warning", self.run_command(f"fathom render {number}.json"))

    def test_outputs(self):
        for page, start, words in OUTPUTS:
            with self.subTest(page=page, start=start):
                line = next(line for line in page_commands(page) if line.startswith(start))
                printed = waiting.run([PROGRAM, *words.split()], cwd=self.folder).stderr
                self.assertIn(without_numbers(line), without_numbers(printed))

    def test_watching(self):
        command = next(command for command in page_commands("docs/pipes.md") if command.endswith("--watch"))
        image, log = self.folder / "scene.png", self.folder / "log"
        with open(log, "w") as stderr:
            process = subprocess.Popen(command.split(), cwd=self.folder, env=self.environment, stderr=stderr)
        waiting.limit_processor_time(process)
        self.addCleanup(lambda: (process.kill(), process.wait()))

        def wait_for_pause(number):
            waiting.wait_for(f"pause {number}", lambda: log.read_text().count("watching") == number, log.read_text,
                             stop=waiting.ended(process))

        wait_for_pause(1)
        first = image.read_bytes()
        scene = self.folder / "scene.json"
        scene.write_text(scene.read_text().replace("0.8, 0.1", "0.1, 0.8"))
        wait_for_pause(2)
        self.assertNotEqual(first, image.read_bytes())
        process.send_signal(signal.SIGINT)
        waiting.finish(process, command)


class LibraryGuide(Folder):
    """Installs the build as docs/library.md says, and compiles and runs its C++ with its lines of CMake."""

    def code(self, start):
        text = (ROOT / "docs" / "library.md").read_text(encoding="utf-8")
        found = [lines for _, lines in blocks(text) if lines[0].startswith(start)]
        self.assertEqual(1, len(found), start)
        return "\n".join(found[0])

    def test_the_library_guide(self):
        install = next(command for command in page_commands("docs/library.md") if command.startswith("cmake --install"))
        prefix = self.folder / "installed"
        self.run_command(install.replace("build/release", f"'{BUILD}'").replace("/where/you/like", f"'{prefix}'"))
        (self.folder / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(guide CXX)\n"
                                                    f"add_executable(program main.cpp)\n{self.code('find_package')}\n")
        smallest = self.code("fathom::Warnings")
        edits = self.code("fathom::EditableScene").replace("    ...", "    fathom::Film frame_film(job);\n"
                                                           "    fathom::render(job, {0, 1}, frame_film);")
        headers = "".join(f"#include <fathom/{name}.h>\n" for name in ("editable_scene", "image", "load", "render"))
        (self.folder / "main.cpp").write_text(f"{headers}int main()\n{{\n{smallest}\nconst fathom::RenderSettings settings;\n"
                                              f"const int wheel = description.roots.at(0);\n{edits}\n}}\n")
        options = shlex.join(["-S", ".", "-B", "build", f"-DCMAKE_PREFIX_PATH={prefix}", *CMAKE_OPTIONS])
        self.run_command(f"cmake {options} && cmake --build build && build/program")
        self.assertGreater((self.folder / "image.png").stat().st_size, 100)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
