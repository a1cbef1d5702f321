"""The window as a user has it: what a key, a drag or a file does is seen on the screen and in the counters."""

import json
import math
import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
import unittest.mock
from pathlib import Path

from desktop import BINARY, ROOT, Screen, Window, until

TORUS = (ROOT / "examples/torus.gtr").read_text()
SPHERE = """param r : [1, 3];
surface s(u,v) = r(cos v cos u, cos v sin u, sin v), u : [0, 2pi], v : [-pi/2, pi/2];
point p = (0, 0, r + 1);
"""
WAVES = "".join(
    f"surface s{k}(u,v) = (u, v, {k} + 0.2 sin(3u) cos(2v)), u : [-1, 1, 40], v : [-1, 1, 40];\n" for k in range(20)
)


def between_edges(left, top, width, height):
    """The pixels of the screen that a rectangle covers, across and down."""
    # Halves are rounded up, as Rust does.
    edge = lambda place: math.floor(place + 0.5)
    return [edge(left + width) - edge(left), edge(top + height) - edge(top)]


class OnScreen(unittest.TestCase):
    """Tests that share a screen."""

    @classmethod
    def setUpClass(cls):
        cls.screen = Screen()
        cls.addClassCleanup(cls.screen.close)

    def open(self, text, *arguments, **options):
        window = Window(self.screen, text, *arguments, **options)

        def close():
            said = window.close()
            self.assertNotIn("panicked", said)

        self.addCleanup(close)
        return window


class Programs(OnScreen):
    """The welcome, the editor and its help, by real keys."""

    def test_a_program_is_begun_from_the_welcome_typed_completed_and_saved(self):
        window = self.open(None)
        self.screen.keep("welcome")
        window.click("Button: Curve")
        window.until("the template is shown", lambda now: now["status"] == "no errors" and "3d" in now["panes"])
        window.settle()
        window.click("Program text")
        window.xdotool("key", "ctrl+a", "BackSpace")
        window.xdotool("type", "--delay", "30", "poin")
        window.place("Button: point")
        self.screen.keep("completion")
        window.xdotool("key", "Tab")
        window.xdotool("type", "--delay", "30", "p = (1, 2, 3);")
        window.settle()
        window.xdotool("key", "ctrl+s")
        target = window.folder / "mine.gtr"
        window.enter("TextInput: File", str(target))
        window.click("Button: Save")
        window.until("the file is written", lambda _now: target.exists())
        self.assertEqual(target.read_text(), "point p = (1, 2, 3);")


class Controls(OnScreen):
    """Keys, pointer, sliders, files."""

    def test_each_key_moves_its_camera_and_the_picture(self):
        window = self.open(SPHERE)
        # The 3D view has the keys from the start.
        for key in "wsadqe":
            before, picture = window.take()["eye"], window.pixels("3d")
            window.hold(key)
            window.until(f"{key} moves the 3D camera", lambda now: now["eye"] != before)
            window.settle()
            self.assertNotEqual(window.pixels("3d"), picture, f"{key} changes the 3D view")
        window.key("r")
        window.settle()
        # A drag gives the keys to the geodesic view.
        middle = window.middle("Image: Geodesic view of s")
        before, picture = window.take()["inside"]["s"], window.pixels("geodesic:s")
        window.drag(middle, (60, 0))
        window.until("a drag moves the geodesic camera", lambda now: now["inside"]["s"] != before)
        window.settle()
        self.assertNotEqual(window.pixels("geodesic:s"), picture)
        eye = window.take()["eye"]
        for key in "wsadqezx":
            picture = window.pixels("geodesic:s")
            space = window.pixels("3d")
            window.hold(key)
            window.settle()
            self.assertNotEqual(window.pixels("geodesic:s"), picture, f"{key} changes the geodesic view")
            self.assertNotEqual(window.pixels("3d"), space, f"{key} moves the camera that the 3D view shows")
        self.assertEqual(window.take()["eye"], eye)
        self.screen.keep("keys")

    def test_a_plus_whose_shift_is_let_go_first_leaves_the_camera_at_rest(self):
        window = self.open(SPHERE)
        window.click_at(*window.middle("Image: 3D view"))
        window.settle()

        def strike():
            for does, key in ("keydown", "shift"), ("keydown", "equal"), ("keyup", "shift"), ("keyup", "equal"):
                window.does(does, key)

        before = window.take()["eye"]
        strike()
        window.until("+ moves the 3D camera", lambda now: now["eye"] != before)
        rest = window.settle()["eye"]
        self.assertEqual(window.settle()["eye"], rest)
        # Typed in the text, it moves no camera, not even when the view has the keys again.
        window.click("Program text")
        strike()
        window.xdotool("key", "BackSpace")
        x, y = window.middle("Image: 3D view")
        window.click_at(x, y)
        window.settle()
        self.assertEqual(window.take()["eye"], rest)

    def test_a_key_that_is_tapped_within_a_slow_frame_moves_the_camera(self):
        window = self.open(SPHERE)
        window.click_at(*window.middle("Image: 3D view"))
        eye = window.settle()["eye"]
        # What a window that stands still is sent arrives in one frame.
        window.process.send_signal(signal.SIGSTOP)
        try:
            window.xdotool("key", "w")
        finally:
            window.process.send_signal(signal.SIGCONT)
        window.until("W goes nearer", lambda now: now["eye"] != eye)
        rest = window.settle()["eye"]
        self.assertEqual(window.settle()["eye"], rest)

    def test_a_triangle_is_measured_by_clicks_and_its_excess_is_its_area(self):
        window = self.open(SPHERE)
        x, y = window.middle("Image: Geodesic view of s")
        half = min(window.place("Image: Geodesic view of s")[2:]) / 2
        window.click_at(x, y)
        window.settle()
        camera, picture = window.take()["inside"]["s"], window.pixels("geodesic:s")
        # The tool's window lies over the lower half.
        left, top, width, height = window.pane("geodesic:s")
        upper_half = [left + 4, top + 4, width - 8, height / 2]
        upper = self.screen.pixels(upper_half)
        window.key("m")
        # It stands at the window's foot, where nothing has to be scrolled to.
        window.click_at(*window.middle("Triangle"))
        window.settle()
        for across, up in (-0.4, -0.3), (0.5, -0.2), (0.1, 0.5):
            window.click_at(x + across * half, y - up * half)
            window.settle()

        window.until("the area is shown", lambda _: "Label: area" in window.controls)
        _, top, _, height = window.place("Label: angle excess")
        beside = [name for name, at in window.controls.items() if abs(at[1] - top) < height / 2 and "°" in name]
        excess = beside[0].removeprefix("Label: ").split()[0]
        self.assertGreater(float(excess), 0.05)
        # On the unit sphere, ∫K and the area are the same number.
        self.assertIn(f"Label: {excess}", window.controls)
        self.assertEqual(window.settle()["inside"]["s"], camera, "a click measures, and moves no camera")
        self.assertNotEqual(self.screen.pixels(upper_half), upper, "the triangle is drawn")
        self.screen.keep("measure")
        window.key("m")
        window.settle()
        self.assertEqual(window.pixels("geodesic:s"), picture, "the triangle goes with the tool")

    def test_drags_and_the_wheel_move_the_3d_view(self):
        window = self.open(SPHERE)
        middle = window.middle("Image: 3D view")
        for what, move in {
            "a drag": lambda: window.drag(middle, (80, 20)),
            "a right drag": lambda: window.drag(middle, (80, 20), button=3),
            "a middle drag": lambda: window.drag(middle, (80, 20), button=2),
            "the wheel": lambda: window.click_at(*middle, button=4),
        }.items():
            before, picture = window.take()["panes"] and window.counters["pictures"], window.pixels("3d")
            move()
            window.until(f"{what} gives a new picture", lambda now: now["pictures"] > before)
            window.settle()
            self.assertNotEqual(window.pixels("3d"), picture, what)

    def test_a_left_drag_turns_the_3d_view_about_its_target(self):
        window = self.open(SPHERE)
        start, picture = window.settle()["eye"], window.pixels("3d")
        middle = window.middle("Image: 3D view")
        window.drag(middle, (120, 0))
        right = window.settle()["eye"]
        self.assertNotEqual(window.pixels("3d"), picture)
        # About the upright axis through the target, which is within a hundredth of the sphere's, and level. What is in
        # front goes to the right, so the eye goes to the left.
        self.assertAlmostEqual(math.hypot(*right[:2]), math.hypot(*start[:2]), delta=0.03)
        self.assertAlmostEqual(right[2], start[2])
        self.assertLess(start[0] * right[1] - start[1] * right[0], 0.0)
        window.drag(middle, (0, 60))
        self.assertGreater(window.settle()["eye"][2], start[2])
        # A camera that only turns stays where it is.
        eye = window.settle()["eye"]
        window.screen.run("xdotool", "keydown", "alt")
        window.drag(middle, (80, 0))
        window.screen.run("xdotool", "keyup", "alt")
        self.assertEqual(window.settle()["eye"], eye)

    def test_the_gizmo_looks_along_its_axes_and_keys_lead_back(self):
        window = self.open(SPHERE)
        window.move_to(5, 5)
        first, picture = window.settle()["eye"], window.pixels("3d")
        for end, axis in (("Look from +z", 2), ("Look from +x", 0)):
            window.click(f"Button: {end}")
            window.until(f"{end} moves the camera", lambda now: now["eye"] != first)
            eye = window.settle()["eye"]
            # The target is near the middle of the sphere and the point above it.
            for k, middle in enumerate((0.0, 0.0, 0.5)):
                if k == axis:
                    self.assertGreater(eye[k], 2.0, end)
                else:
                    self.assertAlmostEqual(eye[k], middle, delta=0.15, msg=end)
        window.screen.keep("gizmo")
        window.move_to(5, 5)
        window.settle()
        along, eye = window.pixels("3d"), window.counters["eye"]
        window.key("5")
        self.assertEqual(window.settle()["eye"], eye)
        self.assertNotEqual(window.pixels("3d"), along, "orthographic")
        window.key("5")
        window.settle()
        self.assertEqual(window.pixels("3d"), along, "in perspective again")
        before = window.take()["frames"]
        window.key("w")
        window.until("W goes nearer", lambda now: now["eye"] != eye)
        window.settle()
        window.key("f")
        is_far = lambda now: now["eye"] and now["eye"][0] > eye[0] - 0.05
        window.until("F frames everything", lambda now: is_far(now) and now["frames"] > before)
        window.settle()
        window.key("r")
        window.until("R resets the camera", lambda now: now["eye"] and math.dist(now["eye"], first) < 1e-9)
        window.settle()
        self.assertEqual(window.pixels("3d"), picture, "as at first")

    def test_a_slider_moves_the_picture_and_builds_and_compiles_nothing(self):
        window = self.open(TORUS)
        before, picture, inside = window.take(), window.pixels("3d"), window.pixels("geodesic:s")
        left, top, width, height = window.place("Slider: r")
        window.drag((left + 8, top + height / 2), (50, 0))
        window.until("the slider moves r", lambda now: now["params"]["r"] != before["params"]["r"])
        after = window.settle()
        self.assertNotEqual(window.pixels("3d"), picture)
        self.assertNotEqual(window.pixels("geodesic:s"), inside)
        self.assertEqual(after["pipelines"], before["pipelines"], "a param is a uniform")
        self.assertEqual(after["compiled"], before["compiled"], "a param is no part of the text")
        value = after["params"]["r"]
        window.key("ctrl+z")
        window.until("undo brings r back", lambda now: now["params"]["r"] == before["params"]["r"])
        window.key("ctrl+y")
        window.until("redo moves r again", lambda now: now["params"]["r"] == value)
        self.screen.keep("slider")

    def test_animate_moves_until_it_is_told_to_rest(self):
        window = self.open(TORUS)
        window.click("Button: Animate r")
        values = set()

        def moves(now):
            values.add(tuple(now["params"]["r"]))
            return len(values) > 10

        window.until("r moves by itself", moves)
        self.assertTrue(all(0.4 <= r <= 0.9 for (r,) in values), values)
        window.click("Button: Animate r")
        rest = window.settle()
        self.assertEqual(window.settle()["frames"], rest["frames"])

    def test_an_idle_window_draws_nothing_and_costs_nothing(self):
        window = self.open(TORUS)
        before, seconds = window.settle(), window.processor_seconds()
        # The one wait by the clock: rest is what is looked at.
        subprocess.run(["sleep", "5"], check=True)
        after = window.take()
        self.assertEqual(after["frames"], before["frames"], "frames while idle")
        spent = window.processor_seconds() - seconds
        self.assertLess(spent, 0.1, "seconds of the processor in five")
        print(f"\n      idle for 5 s: {after['frames'] - before['frames']} frames, {spent:.2f} s of the processor")

    def test_a_texture_is_chosen_from_the_list(self):
        window = self.open(SPHERE)
        window.screen.run("convert", "-size", "64x32", "gradient:red-blue", str(window.folder / "map.png"))
        picture = window.pixels("3d")
        window.click("Button: Objects")
        window.click("TextInput: Image file")
        window.xdotool("type", "--delay", "20", "map.png")
        window.click("Button: Add")
        window.place("map.png")
        window.settle()
        added = window.pixels("3d")
        self.assertNotEqual(added, picture, "the only surface shows what is added")
        for name, seen in [("Plain colour", False), ("map.png", True)]:
            window.click("ComboBox: Texture of s")
            before = window.settle()["pictures"]
            window.click(f"Button: {name}")
            window.until("a new picture", lambda now: now["pictures"] > before)
            window.settle()
            self.assertEqual(window.pixels("3d") == added, seen, name)
        self.screen.keep("texture")

    def test_a_broken_file_is_marked_and_a_mended_one_is_not(self):
        window = self.open(SPHERE)
        picture = window.pixels("3d")
        window.file.write_text(SPHERE.replace("r + 1)", "r + "))
        now = window.until("the mark", lambda now: now["stale"])
        self.assertEqual(now["status"], "1 error")
        window.place("Line 3: ")
        window.settle()
        self.assertNotEqual(window.pixels("3d"), picture, "the badge is over the picture")
        self.screen.keep("stale")
        window.file.write_text(SPHERE)
        now = window.until("no mark", lambda now: not now["stale"])
        self.assertEqual(now["status"], "no errors")
        window.settle()
        self.assertEqual(window.pixels("3d"), picture, "the picture is as it was")

    def test_an_edit_on_disk_shows_another_picture(self):
        window = self.open(SPHERE)
        picture, version = window.pixels("3d"), window.take()["version"]
        # As editors do it: another file takes its place.
        other = window.folder / "other"
        other.write_text(SPHERE.replace("sin v)", "2 sin v)"))
        os.replace(other, window.file)
        window.until("the new text is shown", lambda now: now["version"] > version)
        window.settle()
        self.assertNotEqual(window.pixels("3d"), picture)

    def test_an_edit_of_one_of_twenty_surfaces_redoes_that_one(self):
        window = self.open(WAVES)
        before = window.settle()
        window.file.write_text(WAVES.replace(", 7 + 0.2 sin(3u)", ", 7 + 0.2 sin(4u)"))
        window.until("the new text is shown", lambda now: now["version"] > before["version"])
        after = window.settle()
        sampled, built = (after[k] - before[k] for k in ("sampled", "pipelines"))
        # Blocks of samples serve for surfaces of this size, whatever draws; those with kernels are in live.rs.
        self.assertEqual((sampled, built), (1, 0))
        print(f"\n      one of twenty surfaces: sampled {sampled}, pipelines {built}")

    def test_no_geodesic_is_followed_while_no_geodesic_view_is_open(self):
        window = self.open(TORUS)
        window.click("Button: View")
        window.click("CheckBox: Geodesic view of s")
        window.key("Escape")
        before = window.settle()
        self.assertNotIn("Image: Geodesic view of s", "".join(window.controls))
        window.hold("w")
        left, top, width, height = window.place("Slider: r")
        window.drag((left + 8, top + height / 2), (50, 0))
        after = window.settle()
        self.assertGreater(after["pictures"], before["pictures"])
        self.assertEqual(after["followed"], before["followed"])

    def test_a_click_places_the_geodesic_camera_and_the_text_can_be_typed(self):
        window = self.open(SPHERE)
        before = window.take()["inside"]["s"]
        x, y = window.middle("Image: 3D view")
        window.click_at(x + 20, y - 10)
        window.until("the camera is placed", lambda now: now["inside"]["s"] != before)
        window.click("Program text")
        window.key("ctrl+End")
        compiled = window.settle()["compiled"]
        window.xdotool("type", "--delay", "30", "point q = (1, 1, 1);")
        window.until("it is compiled as it is typed", lambda now: now["compiled"] > compiled)
        window.until("it has no errors", lambda now: not now["stale"])
        window.key("ctrl+s")
        window.until_written(SPHERE + "point q = (1, 1, 1);")

    def test_what_was_chosen_is_there_when_the_window_is_opened_again(self):
        window = self.open(TORUS)
        left, top, width, height = window.place("Slider: r")
        window.drag((left + 8, top + height / 2), (50, 0))
        window.hold("w")
        chosen = window.settle()
        memory = window.folder / ".program.gtr.geotrace.json"
        until("it is remembered", memory.exists)
        until("all of it", lambda: json.loads(memory.read_text())["view"]["params"].get("r") == chosen["params"]["r"])
        window.process.terminate()
        window.process.wait()
        again = self.open(None, folder=window.folder)
        now = again.settle()
        self.assertEqual(now["params"], chosen["params"])
        self.assertEqual(now["eye"], chosen["eye"])


class Files(OnScreen):
    """What the menus write and read: without a desktop's dialogs, which are not there."""

    def menu(self, window, entry, menu="Button: File"):
        window.click(menu)
        window.click(entry)
        window.settle()

    def test_a_picture_is_saved_and_the_field_takes_the_dialogs_place(self):
        window = self.open(SPHERE)
        self.menu(window, "Save picture…")
        window.click("Button: Choose…")
        window.place("No file dialog can be opened here")
        self.screen.keep("no-dialog")
        target = window.folder / "out.png"
        window.enter("TextInput: File", str(target))
        window.click("CheckBox: Transparent background")
        window.click("Button: Save")
        until("the picture is there", target.exists)
        window.place(f"were saved in `{target}`")
        left, top, width, height = window.pane("3d")
        told = window.screen.run("identify", "-format", "%w %h %[opaque]", str(target)).decode().split()
        self.assertEqual([int(side) for side in told[:2]], between_edges(left, top, width, height))
        self.assertEqual(told[2].lower(), "false", "the background is transparent")
        # A place where nothing can be written is a sentence, and nothing is there.
        self.menu(window, "Save picture…")
        window.enter("TextInput: File", str(window.folder / "no/such/out.png"))
        window.click("Button: Save")
        window.place("cannot write")

    def test_a_picture_that_is_copied_can_be_pasted_elsewhere(self):
        window = self.open(SPHERE)
        self.menu(window, "Copy picture")
        window.place("was copied")
        clipboard = ["xclip", "-selection", "clipboard", "-o", "-t"]
        until("it is a picture", lambda: b"image/png" in self.asked(*clipboard, "TARGETS"))
        pasted = window.folder / "pasted.png"
        pasted.write_bytes(self.screen.run(*clipboard, "image/png"))
        left, top, width, height = window.pane("3d")
        told = window.screen.run("identify", "-format", "%w %h %k", str(pasted)).decode().split()
        self.assertEqual([int(side) for side in told[:2]], between_edges(left, top, width, height))
        self.assertGreater(int(told[2]), 100, "colours")

    def asked(self, *command):
        """What a program says, or nothing where it fails."""
        try:
            return self.screen.run(*command)
        except subprocess.CalledProcessError:
            return b""

    def test_a_mesh_is_exported_in_the_format_of_its_name(self):
        window = self.open(SPHERE)
        for extension, begins in {"obj": b"", "ply": b"ply", "glb": b"glTF"}.items():
            target = window.folder / f"mesh.{extension}"
            self.menu(window, "Export mesh…")
            window.enter("TextInput: File", str(target))
            window.click("Button: Save")
            until("the mesh is there", target.exists)
            self.assertTrue(target.read_bytes().startswith(begins))
        vertices = [line for line in (window.folder / "mesh.obj").read_text().splitlines() if line.startswith("v ")]
        self.assertGreater(len(vertices), 100)
        self.menu(window, "Export mesh…")
        window.enter("TextInput: File", str(window.folder / "mesh.doc"))
        window.click("Button: Save")
        window.place("does not end in one of")

    def test_textures_are_opened_from_the_field_where_there_is_no_dialog(self):
        window = self.open(SPHERE)
        window.screen.run("convert", "-size", "64x32", "gradient:red-blue", str(window.folder / "map.png"))
        self.menu(window, "Open textures…")
        window.place("No file dialog can be opened here")
        # The field has the keys.
        window.settle()
        window.xdotool("type", "--delay", "20", "map.png")
        window.key("Return")
        window.place("Remove map.png")

    def test_an_animation_is_recorded_and_called_off(self):
        window = self.open(SPHERE)
        target = window.folder / "program-3d.gif"
        self.menu(window, "Record…")
        self.screen.keep("record")
        for field, number in {"Frames": 6, "Width": 80, "Height": 60}.items():
            window.enter(f"SpinButton: {field}", f"{number}\n")
        window.click("Button: Record")
        until("the animation is there", target.exists)
        window.place(f"were saved in `{target}`")
        sizes = window.screen.run("identify", "-format", "%Wx%H ", str(target)).decode().split()
        self.assertEqual(sizes, ["80x60"] * 6)
        target.unlink()
        self.menu(window, "Record…")
        window.enter("SpinButton: Frames", "100000\n")
        window.click("Button: Record")
        self.screen.keep("recording")
        window.click("Button: Cancel the recording")
        window.place("was cancelled")
        left = sorted(path.name for path in window.folder.iterdir() if ".gif" in path.name)
        self.assertEqual(left, [])

    def test_a_trail_is_drawn_in_both_views_until_it_is_cleared(self):
        window = self.open(SPHERE)
        window.click_at(*window.middle("Image: Geodesic view of s"))
        window.click("Button: Overlays")
        window.click("CheckBox: Trail of the walk")
        window.key("Escape")
        window.settle()
        window.hold("w")
        window.hold("d")
        length = window.settle()["trails"]["s"]
        self.assertGreater(length, 0)
        window.place(f"trail of length {length:.4f}")
        self.screen.keep("trail")
        space, inside, at = window.pixels("3d"), window.pixels("geodesic:s"), window.take()["inside"]["s"]
        window.click("Button: Overlays")
        window.click("Button: Clear the trail")
        window.key("Escape")
        window.until("it is cleared", lambda now: now["trails"]["s"] == 0)
        window.settle()
        self.assertEqual(window.take()["inside"]["s"], at)
        self.assertNotEqual(window.pixels("3d"), space)
        self.assertNotEqual(window.pixels("geodesic:s"), inside)


class Gpu(OnScreen):
    """A GPU that fails: a software driver stands for it."""

    def test_a_window_whose_gpu_is_lost_is_opened_again_as_it_was(self):
        self.a_lost_gpu_is_replaced("lose")

    def test_a_gpu_that_is_lost_while_a_frame_is_painted_is_replaced_too(self):
        # The code that paints the controls panics then, in the midst of the event loop.
        self.a_lost_gpu_is_replaced("lose-in-frame")

    def a_lost_gpu_is_replaced(self, loss):
        window, sign = self.open_with(loss, 1)
        window.xdotool("windowsize", window.id, 1111, 777)
        window.settle()
        size = self.size_of(window)
        window.hold("w")
        window.click("Program text")
        window.key("ctrl+End")
        window.xdotool("type", "--delay", "30", "point q = (1, 1, 1);")
        window.until("it is read", lambda now: now["version"] > 1 and not now["stale"])
        before = window.settle()
        self.assertIn("Image: 3D view of 3 objects", "".join(window.controls))
        first = window.id
        sign.touch()
        # Another window of the same process takes its place.
        window.place("the GPU was lost; the window was opened again")
        until("the old one is gone", lambda: not self.is_there(first))
        window.find(fill=False)
        after = window.settle()
        self.screen.keep("gpu-lost")
        self.assertEqual(self.size_of(window), size)
        for kept in ("eye", "params", "status", "version"):
            self.assertEqual(after[kept], before[kept], kept)
        self.assertEqual(window.file.read_text(), SPHERE, "what was not saved is not written")
        # Text, pictures and keys are those of the window as it was.
        self.assertIn("Image: 3D view of 3 objects", "".join(window.controls))
        self.assertGreater(self.colours(window, "3d"), 100)
        self.assertGreater(self.colours(window, "geodesic:s"), 100)
        window.key("ctrl+s")
        window.until_written(SPHERE + "point q = (1, 1, 1);")
        self.assertIsNone(window.process.poll())

    def test_a_gpu_that_is_lost_again_and_again_ends_the_window_but_not_its_text(self):
        for loss in ("lose", "lose-in-frame"):
            with self.subTest(loss):
                self.a_gpu_that_goes_on_being_lost_ends_the_window(loss)

    def a_gpu_that_goes_on_being_lost_ends_the_window(self, loss):
        window, sign = self.open_with(loss, 4)
        window.click("Program text")
        window.key("ctrl+End")
        window.xdotool("type", "--delay", "30", "point q = (1, 1, 1);")
        window.until("it is read", lambda now: now["version"] > 1 and not now["stale"])
        window.settle()
        sign.touch()
        until("it has ended", lambda: window.process.poll() is not None)
        self.assertEqual(window.process.returncode, 1)
        rescued = window.folder / "program.unsaved.gtr"
        self.assertIn("the GPU was lost 4 times", window.said())
        self.assertIn(f"the unsaved text is in `{rescued}`", window.said())
        self.assertEqual(rescued.read_text(), SPHERE + "point q = (1, 1, 1);")
        self.assertEqual(window.file.read_text(), SPHERE)

    def open_with(self, loss, times):
        """A window whose GPU is lost, so often, when there is a file of the name that comes with it."""
        signs = []

        def faults(folder):
            signs.append(folder / "lose-it-now")
            return [f"{loss}={signs[0]}"] * times

        return self.open(SPHERE, faults=faults), signs[0]

    def test_where_vulkan_finds_no_driver_opengl_draws_the_window(self):
        nothing = {"VK_DRIVER_FILES": "/nothing.json", "VK_ICD_FILENAMES": "/nothing.json"}
        with unittest.mock.patch.dict(os.environ, nothing):
            window = self.open(SPHERE)
        window.settle()
        self.screen.keep("opengl")
        for pane in ("3d", "geodesic:s"):
            self.assertGreater(self.colours(window, pane), 1000, pane)

    def size_of(self, window):
        told = self.screen.run("xdotool", "getwindowgeometry", "--shell", window.id).decode().split()
        return [part for part in told if part.startswith(("WIDTH", "HEIGHT"))]

    def is_there(self, window):
        try:
            return bool(self.screen.run("xdotool", "getwindowname", window))
        except subprocess.CalledProcessError:
            return False

    def colours(self, window, pane):
        pixels = window.pixels(pane)
        return len({pixels[k : k + 3] for k in range(0, len(pixels), 3)})

    def test_an_object_whose_shader_is_refused_is_computed_by_the_processor_with_a_note(self):
        text = "surface s(u,v) = (u, v, 0.2 sin(3u) cos(2v)), u : [-1, 1, 300], v : [-1, 1, 300];\n"
        window = self.open(text, faults=lambda _folder: ["refuse"])
        # The note comes with the first picture behind the refusal.
        begun = window.settle()["pictures"]
        window.hold("w")
        window.until("a new picture", lambda now: now["pictures"] > begun)
        window.place("the GPU rejected the shader of `s`, which is computed on the processor")
        self.screen.keep("refused")
        self.assertGreater(self.colours(window, "3d"), 100)


class Faults(OnScreen):
    """What can go wrong: a sentence, no panic, nothing lost."""

    def ended(self, *arguments, environment=None):
        return subprocess.run(
            [BINARY, "preview", *arguments],
            env=environment or self.screen.environment(),
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    def test_without_a_display_it_says_so_and_ends_with_1(self):
        environment = self.screen.environment()
        del environment["DISPLAY"]
        for display in (None, ":987"):
            if display:
                environment["DISPLAY"] = display
            ended = self.ended(str(ROOT / "examples/torus.gtr"), environment=environment)
            self.assertEqual(ended.returncode, 1, ended.stderr)
            self.assertIn("display", ended.stderr)
            self.assertNotIn("panicked", ended.stderr)

    def test_a_file_that_is_not_there_or_no_text_is_a_sentence(self):
        ended = self.ended("no-such-file.gtr")
        # What cannot be read is wrong use, as for every command.
        self.assertEqual(ended.returncode, 2, ended.stderr)
        self.assertIn("no-such-file.gtr", ended.stderr)
        self.assertNotIn("panicked", ended.stderr)

    def test_a_file_that_goes_or_breaks_keeps_text_and_picture(self):
        window = self.open(SPHERE)
        picture = window.pixels("3d")
        window.file.unlink()
        window.place("the file cannot be read")
        window.settle()
        self.assertEqual(window.pixels("3d"), picture)
        window.file.write_bytes(b"\xff\xfe\x00point")
        window.place("it is not UTF-8")
        window.settle()
        self.assertEqual(window.pixels("3d"), picture)
        window.file.write_text(TORUS)
        window.until("it is back", lambda now: now["params"].get("r") == [0.4])

    def test_a_file_that_may_not_be_read_keeps_text_and_picture(self):
        if os.geteuid() == 0:
            # The superuser reads everything: a folder in its place cannot be read by anyone.
            window = self.open(SPHERE)
            window.file.unlink()
            window.file.mkdir()
        else:
            window = self.open(SPHERE)
            window.file.chmod(0)
        window.place("the file cannot be read")

    def test_a_scene_beyond_the_limits_is_a_sentence(self):
        window = self.open(SPHERE)
        window.file.write_text("surface s(u,v) = (u, v, u v), u : [0, 1, 100000], v : [0, 1, 100000];\n")
        window.until("a sentence", lambda now: now["stale"] or any("too" in name for name in window.controls))
        print("\n      too large:", window.take()["status"])
        window.file.write_text(SPHERE)
        window.until("it goes on", lambda now: not now["stale"] and now["params"].get("r") == [1.0])

    def test_a_hundred_thousand_lines_are_shown(self):
        window = self.open(SPHERE + "# a line\n" * 100_000)
        version = window.take()["version"]
        window.file.write_text(SPHERE.replace("[1, 3]", "[2, 3]") + "# a line\n" * 100_000)
        window.until("the edit is shown", lambda now: now["version"] > version and now["params"]["r"] == [2.0])
        window.settle()

    def test_a_memory_that_is_broken_is_told_and_kept(self):
        folder = Path(tempfile.mkdtemp(prefix="geotrace-window-"))
        self.addCleanup(shutil.rmtree, folder)
        memory = folder / ".program.gtr.geotrace.json"
        memory.write_text("{ not json")
        (folder / "program.gtr").write_text(SPHERE)
        window = self.open(None, folder=folder)
        window.place("it is kept as")
        self.assertEqual(memory.with_name(memory.name + ".unreadable").read_text(), "{ not json")

    def test_a_file_that_changes_a_hundred_times_a_second_is_followed(self):
        window = self.open(SPHERE)
        begun = time.monotonic()
        shown, number = set(), 0
        while time.monotonic() - begun < 5.0:
            number += 1
            text = SPHERE.replace("[1, 3]", f"[{1 + number / 1e4}, 3]")
            if number % 2:
                window.file.write_text(text)
            else:
                # As many editors save: another file takes its name.
                other = window.folder / "other"
                other.write_text(text)
                other.rename(window.file)
            shown |= {tuple(window.take()["params"].get("r", ()))}
            time.sleep(0.01)
        self.assertGreater(len(shown), 2, "it is followed while it changes")
        window.until("the last text is shown", lambda now: now["params"].get("r") == [1 + number / 1e4])
        window.settle()
        self.assertEqual(window.file.read_text(), text)

    def test_a_folder_that_goes_keeps_the_text_and_is_followed_again(self):
        above = Path(tempfile.mkdtemp(prefix="geotrace-window-"))
        self.addCleanup(shutil.rmtree, above)
        folder = above / "folder"
        folder.mkdir()
        window = self.open(SPHERE, folder=folder, notes=above)
        picture = window.pixels("3d")
        window.type_at_end("point q = (1, 1, 1);")
        shutil.rmtree(folder)
        # The watcher reports this by itself, and its sentence would replace that of the save.
        window.place("the file cannot be read")
        window.key("ctrl+s")
        window.place("cannot write")
        window.settle()
        # The folder comes back, as with another branch.
        folder.mkdir()
        window.click("Program text")
        window.key("ctrl+s")
        window.until_written(SPHERE + "point q = (1, 1, 1);")
        window.file.write_text(TORUS)
        window.until("it is followed", lambda now: now["params"].get("r") == [0.4])
        self.assertNotEqual(window.pixels("3d"), picture)

    def test_two_windows_on_one_file_follow_each_other_and_lose_nothing(self):
        folder = Path(tempfile.mkdtemp(prefix="geotrace-window-"))
        self.addCleanup(shutil.rmtree, folder)
        one = self.open(SPHERE, folder=folder)
        two_notes = Path(tempfile.mkdtemp(prefix="geotrace-window-"))
        self.addCleanup(shutil.rmtree, two_notes)
        two = self.open(None, folder=folder, notes=two_notes)
        two.settle()
        for window in (one, two):
            window.raise_it()
            window.click_at(*window.middle("Image: 3D view"))
            window.hold("w")
        # What one of them saves, the other one shows.
        one.raise_it()
        one.type_at_end("point q = (1, 1, 1);")
        one.key("ctrl+s")
        one.until_written(SPHERE + "point q = (1, 1, 1);")
        two.raise_it()
        two.place("3D view of 3 objects")
        # What both of them change, neither writes over the other.
        two.type_at_end("# two")
        one.raise_it()
        one.type_at_end("# one")
        one.key("ctrl+s")
        saved = SPHERE + "point q = (1, 1, 1);# one"
        one.until_written(saved)
        two.raise_it()
        two.settle()
        two.key("ctrl+s")
        two.settle()
        self.assertEqual(two.file.read_text(), saved)
        # Both remember what was chosen in one file, which is whole.
        for window in (one, two):
            window.end()
        remembered = json.loads((folder / ".program.gtr.geotrace.json").read_text())
        self.assertIn("view", remembered)
        rescued = folder / "program.unsaved.gtr"
        self.assertEqual(rescued.read_text(), SPHERE + "point q = (1, 1, 1);# two")

    def test_a_signal_ends_the_window_but_not_its_text(self):
        for name in ("SIGTERM", "SIGINT"):
            with self.subTest(signal=name):
                window = self.open(SPHERE)
                window.type_at_end("point q = (1, 1, 1);")
                window.process.send_signal(getattr(signal, name))
                self.assertEqual(window.process.wait(60), 0)
                rescued = window.folder / "program.unsaved.gtr"
                self.assertIn(f"the unsaved text is in `{rescued}`", window.said())
                self.assertEqual(rescued.read_text(), SPHERE + "point q = (1, 1, 1);")
                self.assertEqual(window.file.read_text(), SPHERE)

    def test_a_kill_while_it_saves_leaves_whole_files(self):
        folder = Path(tempfile.mkdtemp(prefix="geotrace-window-"))
        self.addCleanup(shutil.rmtree, folder)
        (folder / "program.gtr").write_text(SPHERE)
        texts = {SPHERE}
        for attempt in range(4):
            window = self.open(None, folder=folder)
            window.settle()
            text = window.file.read_text()
            window.type_at_end("#")
            window.key("w")
            window.xdotool("keydown", "ctrl", "key", "s", "keyup", "ctrl")
            time.sleep(0.02 * attempt)
            window.process.kill()
            window.process.wait()
            texts |= {text + "#", text + "#w"}
            self.assertIn(window.file.read_text(), texts)
            memory = folder / ".program.gtr.geotrace.json"
            if memory.exists():
                self.assertIn("view", json.loads(memory.read_text()))

    def test_a_full_disk_is_told_and_nothing_is_lost(self):
        root = [] if os.geteuid() == 0 else ["sudo", "-n"]
        if root and not (shutil.which("sudo") and subprocess.run([*root, "true"], capture_output=True).returncode == 0):
            self.skipTest("only the superuser can mount a small disk")
        disk = Path(tempfile.mkdtemp(prefix="geotrace-disk-"))
        self.addCleanup(disk.rmdir)
        options = f"size=256k,uid={os.geteuid()}"
        subprocess.run([*root, "mount", "-t", "tmpfs", "-o", options, "tmpfs", str(disk)], check=True)
        self.addCleanup(subprocess.run, [*root, "umount", "-l", str(disk)], check=True)
        notes = Path(tempfile.mkdtemp(prefix="geotrace-window-"))
        self.addCleanup(shutil.rmtree, notes)
        window = self.open(SPHERE, folder=disk, notes=notes)
        filler = disk / "filler"
        with self.assertRaises(OSError):
            with open(filler, "wb", buffering=0) as file:
                while True:
                    file.write(b"x" * 512)
        window.type_at_end("point q = (1, 1, 1);")
        window.key("ctrl+s")
        window.place("cannot write")
        self.assertEqual(window.file.read_text(), SPHERE)
        for entry, name in {"Save picture…": "out.png", "Export mesh…": "mesh.obj"}.items():
            window.click("Button: File")
            window.click(entry)
            window.settle()
            window.enter("TextInput: File", str(disk / name))
            window.click("Button: Save")
            window.settle()
            window.key("Escape")
            self.assertFalse((disk / name).exists(), name)
        self.assertEqual([path.name for path in disk.iterdir() if path.name.startswith(".geotrace-")], [])
        filler.unlink()
        window.settle()
        window.click("Program text")
        window.key("ctrl+s")
        window.until_written(SPHERE + "point q = (1, 1, 1);")

    def test_a_server_that_goes_is_told_and_the_picture_stays(self):
        environment = self.screen.environment()
        command = [BINARY, "preview", "--attached"]
        window = subprocess.Popen(
            command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
        try:
            hello = json.loads(window.stdout.readline())
            self.assertEqual(hello["type"], "hello")
            text = {"type": "text", "uri": "file:///a.gtr", "path": None, "version": 3, "text": SPHERE}
            for message in (hello, text):
                window.stdin.write(json.dumps(message).encode() + b"\n")
            window.stdin.flush()
            while True:
                event = json.loads(window.stdout.readline())
                if event["type"] == "shown":
                    break
            self.assertEqual((event["version"], event["ok"]), (3, True))
            before = self.screen.pixels()
            window.stdin.close()
            window.stdin = None
            until("the banner", lambda: self.screen.pixels() != before)
            self.assertIsNone(window.poll())
            self.screen.keep("gone")
        finally:
            window.kill()
            _, said = window.communicate()
            self.assertNotIn(b"panicked", said)


class Examples(OnScreen):
    """Every example, once."""

    def test_every_example_opens_without_an_error(self):
        for example in sorted((ROOT / "examples").glob("*.gtr")):
            with self.subTest(example=example.stem):
                window = Window(self.screen, example.read_text(), name=example.name)
                try:
                    now = window.settle()
                    self.assertEqual(now["status"], "no errors")
                    self.screen.keep(f"example-{example.stem}")
                finally:
                    self.assertNotIn("panicked", window.close())


if __name__ == "__main__":
    unittest.main()
