#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the completion scripts of `fathom completion` in bash, zsh and fish, and checks what they propose against --help.

usage: completion_test.py FATHOM
"""
import os
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.path.abspath(sys.argv.pop(1))
COMMANDS = ["render", "merge", "submit", "status", "info", "convert", "view", "version", "completion", "man"]

# Prepares an interactive zsh: the tab completes, and Control-X prints the line.
ZSH_SETUP = """PS1=; autoload -U compinit; compinit -u -d dump; source script; setopt noautolist
bindkey '^I' complete-word; show() { print -r -- "<<$BUFFER>>" }; zle -N show; bindkey '^X' show
"""


def run(*command, **more):
    return subprocess.run(command, capture_output=True, text=True, timeout=60, **more).stdout


def options_of(command):
    """Names of the options in the command's --help."""
    return set(re.findall(r"(?m)^ {2}(?:-\w,)?(--[a-z][a-z-]*)", run(PROGRAM, command, "--help")))


def script(shell):
    return run(PROGRAM, "completion", shell)


class Completion(unittest.TestCase):
    def bash(self, *words):
        line = " ".join(f"'{word}'" for word in words)
        code = script("bash") + f'COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _fathom; printf "%s\\n" "${{COMPREPLY[@]}}"'
        return set(run("bash", "-c", code).split())

    def fish(self, line):
        code = script("fish") + f"complete -C '{line}'"
        return {proposal.split("\t")[0] for proposal in run("fish", "--no-config", "-c", code).splitlines()}

    def zsh(self, line):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "script"), "w") as file:
                file.write(script("zsh"))
            child, terminal = pty.fork()
            if child == 0:
                os.chdir(folder)
                os.execvpe("zsh", ["zsh", "-f", "-i"], {**os.environ, "TERM": "dumb"})
            os.write(terminal, (ZSH_SETUP + line + "\t\x18").encode())
            shown = b""
            while not re.search(rb"<<[^$]*>>", shown):
                self.assertTrue(select.select([terminal], [], [], 60)[0], shown)
                shown += os.read(terminal, 4096)
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            os.close(terminal)
            return re.search(rb"<<([^$]*)>>", shown)[1].decode().strip()

    def test_bash_proposes_commands_options_and_choices(self):
        self.assertLessEqual(set(COMMANDS), self.bash("fathom", ""))
        for command in COMMANDS:
            self.assertLessEqual(options_of(command), self.bash("fathom", command, "--"))
        self.assertEqual(self.bash("fathom", "render", "--build", ""), {"fast", "standard", "high", "compact"})
        self.assertEqual(self.bash("fathom", "render", "--spp", ""), set())

    def test_fish_proposes_commands_options_and_choices(self):
        if not shutil.which("fish"):
            self.skipTest("fish is not installed")
        self.assertLessEqual(set(COMMANDS), self.fish("fathom "))
        for command in COMMANDS:
            self.assertLessEqual(options_of(command), self.fish(f"fathom {command} --"))
        self.assertEqual(self.fish("fathom render --build "), {"fast", "standard", "high", "compact"})

    def test_zsh_completes_commands_options_and_choices(self):
        if not shutil.which("zsh"):
            self.skipTest("zsh is not installed")
        self.assertEqual(self.zsh("fathom mer"), "fathom merge")
        self.assertTrue(self.zsh("fathom render --shut").startswith("fathom render --shutter"))
        self.assertEqual(self.zsh("fathom render --build comp"), "fathom render --build compact")

    def test_files_are_completed(self):
        with tempfile.TemporaryDirectory() as folder:
            open(os.path.join(folder, "model one.glb"), "w").close()
            code = script("bash") + f'cd {folder}; COMP_WORDS=(fathom render mod); COMP_CWORD=2; _fathom; printf "%s\\n" "${{COMPREPLY[@]}}"'
            self.assertEqual(run("bash", "-c", code), "model one.glb\n")

    def test_another_shell_is_wrong_usage(self):
        result = subprocess.run([PROGRAM, "completion", "tcsh"], capture_output=True, text=True)
        self.assertEqual((result.returncode, result.stderr), (2, "fathom: expected bash, zsh or fish, found 'tcsh'\n"))


class Manual(unittest.TestCase):
    def test_lists_every_option_and_has_no_troff_errors(self):
        page = run(PROGRAM, "man")
        plain = page.replace("\\-", "-")
        for command in COMMANDS:
            for option in options_of(command):
                self.assertRegex(plain, rf"(?m)^\.B .*{option}( |$)")
        if shutil.which("groff"):
            result = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z"], input=page, capture_output=True, text=True)
            self.assertEqual(result.stderr, "")


unittest.main()
