"""A screen that nobody sees, a window on it, and hands for keys and pointer.

    Screen ──Xvfb──▶ display        Window ──geotrace preview --report──▶ counters, places of controls
       └── picture(): pixels           └── key(), drag(), click(): xdotool

Nothing is waited for by the clock but rest itself: conditions have a minute, since the machine may be busy.
"""

import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

PATIENCE = 60.0
ROOT = Path(__file__).resolve().parents[2]
BINARY = os.environ.get("GEOTRACE_BIN", "geotrace")
FAULTY = Path(BINARY).resolve().parent / "examples/window"


def until(what, holds, patience=PATIENCE):
    """The first true answer of `holds`, asked again and again."""
    begun = time.monotonic()
    while True:
        answer = holds()
        if answer:
            return answer
        if time.monotonic() - begun > patience:
            raise AssertionError(f"not within {patience:.0f} s: {what}")
        time.sleep(0.05)


class Screen:
    """An X server of its own."""

    def __init__(self, width=1600, height=1000):
        self.size = (width, height)
        self.folder = tempfile.mkdtemp(prefix="geotrace-screen-")
        read, write = os.pipe()
        command = ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24", "-nolisten", "tcp"]
        # It does not begin anew when its last window goes, and refuses the next one meanwhile.
        command.append("-noreset")
        # A key that a busy machine lets go late is typed once: no key repeats itself.
        command.append("-r")
        self.server = subprocess.Popen(
            command, pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        os.close(write)
        with os.fdopen(read) as numbers:
            self.display = f":{numbers.readline().strip()}"

    def environment(self):
        """For programs that show something here, and know nothing of the user's own desktop."""
        environment = {k: v for k, v in os.environ.items() if k not in ("WAYLAND_DISPLAY", "XDG_STATE_HOME")}
        environment |= {"DISPLAY": self.display, "XDG_RUNTIME_DIR": self.folder, "HOME": self.folder}
        # No bridge to a screen reader is to be looked for.
        environment |= {"DBUS_SESSION_BUS_ADDRESS": "disabled:", "NO_AT_BRIDGE": "1"}
        return environment

    def run(self, *command):
        """What a program says."""
        done = subprocess.run(command, env=self.environment(), capture_output=True, check=True, timeout=PATIENCE)
        return done.stdout

    def pixels(self, place=None):
        """The screen's bytes, or those of [left, top, width, height]."""
        crop = []
        if place:
            left, top, width, height = (round(x) for x in place)
            crop = ["-crop", f"{width}x{height}+{left}+{top}"]
        return self.run("import", "-silent", "-window", "root", *crop, "-depth", "8", "rgb:-")

    def keep(self, name):
        """A screenshot, where one is wanted."""
        folder = os.environ.get("GEOTRACE_SHOTS")
        if folder:
            Path(folder).mkdir(parents=True, exist_ok=True)
            self.run("import", "-silent", "-window", "root", str(Path(folder).resolve() / f"{name}.png"))

    def close(self):
        self.server.terminate()
        self.server.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


class Lines:
    """The lines of a file that grows."""

    def __init__(self, path):
        self.path = path
        self.read = 0
        self.rest = b""

    def last(self):
        """The newest line since the last time, if there is one."""
        if not self.path.exists():
            return None
        with open(self.path, "rb") as file:
            file.seek(self.read)
            new = file.read()
        self.read += len(new)
        *lines, self.rest = (self.rest + new).split(b"\n")
        return json.loads(lines[-1]) if lines else None


class Window:
    """A window on a program of its own."""

    def __init__(self, screen, text, *arguments, name="program.gtr", folder=None, notes=None, faults=None):
        self.screen = screen
        self.own = folder is None
        self.folder = Path(folder or tempfile.mkdtemp(prefix="geotrace-window-"))
        self.file = self.folder / name
        if isinstance(text, bytes):
            self.file.write_bytes(text)
        elif text is not None:
            self.file.write_text(text)
        # What it tells the tests lies elsewhere where its own folder is to go or to be full.
        notes = Path(notes or self.folder)
        self.report = notes / "report.jsonl"
        self.errors = notes / "stderr"
        self.lines = Lines(self.report)
        self.places = Lines(notes / "report.jsonl.controls")
        self.counters = {}
        self.controls = {}
        for old in notes.glob("report.jsonl*"):
            old.unlink()
        # Without a text it opens with the welcome.
        program = [] if text is None and not self.file.exists() else [str(self.file)]
        command = [BINARY, "preview", *program, "--report", str(self.report), *arguments]
        if faults:
            # The window as a program of its own, whose GPU goes wrong.
            command = [str(FAULTY), str(self.file), str(self.report), "gpu", *faults(self.folder)]
        with open(self.errors, "wb") as errors:
            self.process = subprocess.Popen(command, env=screen.environment(), stderr=errors)
        self.until("the window has drawn itself", lambda now: now.get("frames", 0) > 0)
        self.find()
        if text is not None:
            self.settle()

    def find(self, fill=True):
        """Finds the window on the screen, and gives it the keys, and with `fill` all of the screen."""
        pid = str(self.process.pid)
        found = lambda: self.screen.run("xdotool", "search", "--onlyvisible", "--pid", pid).split()
        self.id = until("the window is on the screen", lambda: self.ids(found))
        if fill:
            self.xdotool("windowsize", self.id, *self.screen.size)
        self.xdotool("windowfocus", self.id)

    @staticmethod
    def ids(found):
        try:
            return found()[-1].decode()
        except (subprocess.CalledProcessError, IndexError):
            return None

    def take(self):
        """Reads what the window has written since."""
        self.counters = self.lines.last() or self.counters
        self.controls = self.places.last() or self.controls
        return self.counters

    def until(self, what, holds):
        """The counters, as soon as something holds of them."""

        def asked():
            if self.process.poll() is not None:
                raise AssertionError(f"the window has ended with {self.process.returncode}: {self.said()}")
            now = self.take()
            return now if holds(now) else None

        try:
            return until(what, asked)
        except AssertionError as error:
            self.screen.keep("failed")
            raise AssertionError(f"{error}; {self.counters}; {self.said()}") from None

    def until_written(self, text):
        """Waits until the program's file has a text."""
        try:
            until("the file has the text", lambda: self.file.is_file() and self.file.read_text() == text)
        except AssertionError as error:
            self.screen.keep("failed")
            there = self.file.read_text() if self.file.is_file() else None
            raise AssertionError(f"{error}; {there!r}; {self.counters}") from None

    def said(self):
        return self.errors.read_text(errors="replace")

    def settle(self):
        """Waits until nothing has been drawn for a second; the counters then."""
        last = [self.until("a picture", lambda now: now["pictures"] > 0)["frames"], time.monotonic()]

        def rests(now):
            if now["frames"] != last[0] or not now["settled"]:
                last[:] = [now["frames"], time.monotonic()]
            return time.monotonic() - last[1] > 1.0

        return self.until("the window comes to rest", rests)

    def xdotool(self, *command):
        self.screen.run("xdotool", *map(str, command))

    def move_to(self, x, y):
        self.does("mousemove", "--window", self.id, round(x), round(y))

    def place(self, control):
        """Where a control is; its name may be a part of what it is called."""

        def found(_now):
            exact = self.controls.get(control)
            return exact or next((at for name, at in self.controls.items() if control in name), None)

        self.until(f"there is a control {control}", found)
        return found(None)

    def middle(self, control):
        left, top, width, height = self.place(control)
        return left + width / 2, top + height / 2

    def click(self, control, button=1):
        self.reveal(control)
        self.click_at(*self.middle(control), button=button)

    def reveal(self, control):
        """Scrolls down until a control is on the screen."""
        for _ in range(20):
            left, top, width, height = self.place(control)
            if top + height < self.screen.size[1] - 40:
                return
            self.move_to(left + width / 2, self.screen.size[1] - 80)
            self.xdotool("click", 5)
            self.settle()

    def does(self, *command):
        """Does something that the window answers with a frame, and waits for that: a driver without a GPU is slow."""
        before = self.take()["frames"]
        self.xdotool(*command)
        begun = time.monotonic()
        while self.take()["frames"] == before and time.monotonic() - begun < 2.0:
            time.sleep(0.01)

    def click_at(self, x, y, button=1):
        self.move_to(x, y)
        self.does("mousedown", button)
        self.does("mouseup", button)

    def drag(self, start, way, button=1):
        (x, y), (dx, dy) = start, way
        self.move_to(x, y)
        self.does("mousedown", button)
        for step in range(1, 6):
            self.move_to(x + dx * step / 5, y + dy * step / 5)
        self.does("mouseup", button)

    def hold(self, key):
        """Holds a key for some frames."""
        self.does("keydown", key)
        before = self.take()["frames"]
        self.until("frames while a key is held", lambda now: now["frames"] >= before + 3)
        self.does("keyup", key)

    def key(self, *keys):
        self.does("key", *keys)

    def enter(self, field, text):
        """Puts a text in the place of a field's."""
        # What a dialog or its absence still does to the field comes first.
        self.settle()
        self.click(field)
        self.settle()
        self.key("ctrl+a")
        self.xdotool("type", "--delay", "10", text)
        self.settle()

    def type_at_end(self, text):
        """Types behind the program's text, and waits until it is read."""
        version = self.take()["version"]
        self.click("Program text")
        self.key("ctrl+End")
        self.xdotool("type", "--delay", "30", text)
        self.until("it is read", lambda now: now["version"] > version and not now["stale"])
        self.settle()

    def raise_it(self):
        """Brings it before other windows and gives it the keys."""
        self.xdotool("windowraise", self.id)
        self.xdotool("windowfocus", self.id)
        self.settle()

    def end(self):
        """Asks it to end by a signal, and waits."""
        self.process.terminate()
        self.process.wait(PATIENCE)

    def pane(self, name):
        return self.take()["panes"][name]

    def pixels(self, pane):
        """The picture of a pane, without its border, which shows who has the keys."""
        left, top, width, height = self.pane(pane)
        return self.screen.pixels([left + 4, top + 4, width - 8, height - 8])

    def memory(self):
        """Resident bytes."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return 1024 * int(status.split("VmRSS:")[1].split()[0])

    def processor_seconds(self):
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def close(self):
        """Ends the window, and says what it has said; its folder goes with it."""
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(10)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        said = self.said()
        if self.own:
            shutil.rmtree(self.folder, ignore_errors=True)
        return said
