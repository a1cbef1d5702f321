"""The screenshots of README.md: see `screens`, which runs this."""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from desktop import BINARY, ROOT, Lines, Screen, Window, until

IMAGES = ROOT / "docs/images"
PROGRAM = """# A torus; the slider r is the thickness of its tube.
param r : [0.4, 0.9];

surface s(u, v) = ((1 + r cos v) cos u,
    (1 + r cos v) sin u,
    r sin v),
    u : [0, 2pi, 160], v : [0, 2pi, 80];

# A straightest line that starts near the outer equator.
geodesic g(t) : s = (1, 0.4) @ (5, 0.2), t : [0, 9];
"""
CACHE = Path(os.environ["GEOTRACE_CACHE"])


def take(screen, name):
    """A picture of the whole screen."""
    path = IMAGES / f"{name}.png"
    screen.run("import", "-silent", "-window", "root", "-strip", str(path))
    print(path.relative_to(ROOT))


def window():
    """The window alone."""
    screen = Screen(1280, 800)
    try:
        shown = Window(screen, PROGRAM, name="torus.gtr")
        try:
            shown.move_to(640, 5)
            shown.settle()
            take(screen, "window")
        finally:
            shown.close()
    finally:
        screen.close()


class Beside:
    """A screen with a folder for an editor, whose server opens the window on the right half."""

    def __init__(self):
        self.screen = Screen(1600, 900)
        self.folder = Path(tempfile.mkdtemp(prefix="geotrace-screens-"))
        (self.folder / "work").mkdir()
        self.file = self.folder / "work/torus.gtr"
        self.file.write_text(PROGRAM)
        self.report = Lines(self.folder / "report.jsonl")
        # The server is told where its window leaves its counters by a program of the same name.
        program = self.folder / "geotrace"
        program.write_text(
            "#!/usr/bin/env bash\n"
            f'[ "$1" != lsp ] || exec {BINARY} lsp --window {BINARY} preview --attached --report {self.report.path}\n'
            f'exec {BINARY} "$@"\n'
        )
        program.chmod(0o755)
        self.program = program
        self.environment = self.screen.environment()
        self.environment["PATH"] = f"{self.folder}:{self.environment['PATH']}"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.screen.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def find(self, *what):
        """The window that is called so, as soon as it is there."""

        def found():
            try:
                return self.screen.run("xdotool", "search", "--onlyvisible", *what).split()[-1].decode()
            except (subprocess.CalledProcessError, IndexError):
                return None

        return until(f"a window {what}", found)

    def place(self, found, left, top, width, height):
        for command in (["windowsize", found, width, height], ["windowmove", found, left, top]):
            self.screen.run("xdotool", *map(str, command))

    def shown(self):
        """Waits for the window, puts it on the right and waits until it rests."""
        self.place(self.find("--name", "torus.gtr.*Geotrace$"), 720, 0, 880, 900)
        last = {}

        def rests():
            last.update(self.report.last() or {})
            if not last.get("settled"):
                return False
            time.sleep(2.0)
            return self.report.last() is None

        until("the window rests", rests)


def neovim():
    """The window beside Neovim in a terminal."""
    with Beside() as beside:
        environment = beside.environment | {"GEOTRACE_ROOT": str(ROOT)}
        for kind in ("CONFIG", "DATA", "STATE"):
            environment[f"XDG_{kind}_HOME"] = str(beside.folder / kind.lower())
        terminal = subprocess.Popen(
            ["xterm", "-fa", "DejaVu Sans Mono", "-fs", "11", "-geometry", "79x47+0+0", "-bg", "#14161b", "-fg", "#e0e2ea"]
            + ["-b", "0", "-bw", "0", "-e", str(CACHE / "python/bin/nvim"), "-i", "NONE", "-u"]
            + [str(ROOT / "tests/editors/neovim/init.lua"), "-c", "set number termguicolors", beside.file.name],
            env=environment,
            cwd=beside.file.parent,
        )
        try:
            # Wherever the pointer is, keys go.
            found = beside.find("--class", "xterm")
            beside.screen.run("xdotool", "mousemove", "300", "300", "windowfocus", found)
            time.sleep(5.0)
            beside.screen.run("xdotool", "type", "--delay", "60", ":GeotracePreview\n")
            beside.shown()
            beside.screen.run("xdotool", "windowfocus", found, "type", "--delay", "60", "jj")
            time.sleep(3.0)
            take(beside.screen, "window-neovim")
        finally:
            terminal.terminate()
            terminal.wait()


def vscode():
    """The window beside VS Code in a browser."""
    with Beside() as beside:
        extension = beside.folder / "unpacked"
        shutil.unpack_archive(ROOT / "editors/vscode/geotrace.vsix", extension, "zip")
        driver = subprocess.Popen(
            ["node", str(ROOT / "docs/screens.mjs"), str(CACHE / "vscode"), str(extension / "extension")]
            + [str(beside.file.parent), str(beside.program)],
            env=beside.environment,
            stdin=subprocess.PIPE,
        )
        try:
            beside.shown()
            time.sleep(3.0)
            take(beside.screen, "window-vscode")
        finally:
            driver.stdin.close()
            try:
                driver.wait(20)
            except subprocess.TimeoutExpired:
                driver.kill()
                driver.wait()


for name in sys.argv[1:]:
    {"window": window, "neovim": neovim, "vscode": vscode}[name]()
