// Saving a picture as PNG, and the objects as a mesh: the core writes the file, and the browser gives it to the reader.

import type { Core } from "./core.ts";
import { attempt, openDialog, say } from "./dialogs.ts";
import { button, download, make } from "./dom.ts";
import type { Pane } from "./pane.ts";
import type { MeshFormat, SavedFile } from "./protocol.ts";

/** The formats of meshes. */
export const FORMATS: { format: MeshFormat; label: string }[] = [
    { format: "obj", label: "Wavefront .obj" },
    { format: "ply", label: "Polygons .ply" },
    { format: "stl", label: "For printing .stl" },
    { format: "glb", label: "Scene with colours .glb" },
];

/** Asks for the size of a picture and saves it; `view` is chosen at first. */
export function savePicture(core: Core, panes: Pane[], view: string | undefined, stem: string): void {
    const first = panes.find((pane) => pane.info.id === view) ?? panes[0];
    if (first === undefined) {
        say("No view is open, so there is no picture to save.");
        return;
    }
    const select = make("select", { class: "field", id: "save-view" });
    select.append(...panes.map(({ info }) => make("option", { value: info.id }, info.title)));
    select.value = first.info.id;
    const side = (id: string, value: number, label: string) =>
        make("input", { class: "number", type: "number", id, required: true, min: "1", max: "4096", step: "1", value: String(value), "aria-label": label });
    const { width = 800, height = 600 } = first.declared() ?? {};
    const [across, down] = [side("save-width", width, "Width in pixels"), side("save-height", height, "Height in pixels")];
    const save = make("button", { class: "button primary", type: "submit" }, "Save");
    const form = make(
        "form",
        {},
        make(
            "div",
            { class: "form" },
            make("label", { htmlFor: "save-view" }, "View"),
            select,
            make("label", { htmlFor: "save-width" }, "Size"),
            make("div", { class: "pair" }, across, "×", down, "pixels"),
        ),
        make("div", { class: "buttons" }, button("Cancel", () => dialog.close(), { kind: "outline" }), save),
    );
    let isDrawing = false;
    form.addEventListener("submit", (event) => {
        event.preventDefault();
        isDrawing = true;
        save.disabled = true;
        save.textContent = "Drawing…";
        void attempt(async () => {
            const request = {
                view: select.value,
                width: across.valueAsNumber,
                height: down.valueAsNumber,
            };
            const name = `${stem}-${select.value.replace(":", "-")}.png`;
            await give(name, core.call("savePicture", request), () => !dialog.isConnected);
        }).finally(() => {
            isDrawing = false;
            dialog.close();
        });
    });
    const dialog = openDialog("Save a picture", [form]);
    dialog.addEventListener("close", () => {
        if (isDrawing) {
            core.cancel();
        }
    });
}

/** Saves the objects as a mesh. */
export async function saveMesh(core: Core, format: MeshFormat, stem: string): Promise<void> {
    let isCancelled = false;
    const cancel = () => {
        isCancelled = true;
        core.cancel();
    };
    let taken = () => {};
    // Most are there at once.
    const later = setTimeout(() => (taken = say("The mesh is being computed.", { action: { label: "Cancel", press: cancel } })), 1000);
    await attempt(() => give(`${stem}.${format}`, core.call("saveMesh", { format }), () => isCancelled));
    clearTimeout(later);
    taken();
}

/** Gives the reader a file once it is there, unless it was cancelled meanwhile. */
async function give(name: string, saved: Promise<SavedFile>, isCancelled: () => boolean): Promise<void> {
    let file: SavedFile;
    try {
        file = await saved;
    } catch (error) {
        if (isCancelled()) {
            return;
        }
        throw error;
    }
    download(name, file.bytes, file.type);
    for (const note of file.notes) {
        say(note);
    }
}
