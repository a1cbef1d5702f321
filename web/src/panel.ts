// The pictures and settings of a program whose text another editor has: the preview inside VS Code.
//
//   extension ── Told ──▶ panel ── Said ──▶ extension
//
// The extension has the text and applies what the panel says. Offsets are UTF-16 units of the text with `\n` as its line
// ends; each text and each edit has a number, which grows by one.

import { Core, UNREADABLE } from "./core.ts";
import { attempt, say } from "./dialogs.ts";
import { make, saveBy } from "./dom.ts";
import { savePicture } from "./export.ts";
import { chooseFile, IMAGES, readImage } from "./files.ts";
import type { Scene, Settings, TextEdit, TextRange } from "./protocol.ts";
import { SettingsPane } from "./settings.ts";
import pageStyle from "./style.css?inline";
import { Views } from "./views.ts";
import address from "./worker.ts?worker&url";
import wasm from "./core/core_bg.wasm?url";

/** What the extension tells. */
export type Told =
    | { told: "open"; name: string; text: string; version: number }
    | { told: "edit"; version: number; changes: TextEdit[] }
    | { told: "cursor"; at: number | null }
    | { told: "view"; view: "3d" | "geodesic" | "traced"; surface?: string };

/** What the panel says. */
export type Said =
    | { said: "ready" }
    | { said: "select"; range: TextRange; version: number }
    | { said: "apply"; edits: TextEdit[]; version: number }
    | { said: "save"; name: string; base64: string }
    | { said: "shown"; version: number };

declare function acquireVsCodeApi(): {
    postMessage(message: Said): void;
    getState(): { settings?: Settings } | undefined;
    setState(state: { settings: Settings }): void;
};

const host = acquireVsCodeApi();
const OWN_STYLE = `
body { padding: 0; }
#panel { display: grid; height: 100vh; grid-template: minmax(0, 1fr) auto / minmax(0, 1fr); }
#panel > .views { display: flex; }
#panel .view .tools .minor { display: inline-flex; }
#panel > .settings { display: flex; flex-direction: column; max-height: 38vh; border-top: 1px solid var(--line); background: var(--pane); }
`;

/**
 * Starts the Worker. A webview may start one from a blob only, which has no address of its own and may fetch nothing but
 * blobs: so the script gets its address as a text, and the core as a blob.
 */
async function workerOf(): Promise<() => Worker> {
    const script = new URL(address, import.meta.url);
    const [text, core] = await Promise.all([
        fetch(script).then((response) => response.text()),
        fetch(new URL(wasm, import.meta.url)).then((response) => response.arrayBuffer()),
    ]);
    const blobOf = (content: BlobPart, type: string) => URL.createObjectURL(new Blob([content], { type }));
    const fetched = JSON.stringify(blobOf(core, "application/wasm"));
    const first = `const fetchOf = self.fetch; self.fetch = () => fetchOf(${fetched});\n`;
    const own = blobOf(first + text.replaceAll("import.meta.url", JSON.stringify(script.href)), "text/javascript");
    return () => new Worker(own, { type: "module", name: "geotrace" });
}

class Panel {
    private readonly core: Core;
    private readonly views: Views;
    private readonly settings: SettingsPane;
    private scene: Scene | undefined;
    private text = "";
    private version = 0;
    /** The name of the program that is open. */
    private name: string | undefined;
    private stem = "geotrace";

    constructor(root: HTMLElement, start: () => Worker) {
        this.core = new Core(start, {
            scene: (scene) => {
                this.scene = scene;
                this.update();
            },
            settings: () => this.update(),
            picture: (picture) => {
                this.views.picture(picture);
                host.postMessage({ said: "shown", version: picture.version });
            },
            noPicture: (reason) => this.views.noPicture(reason),
            busy: ({ view, isBusy }) => this.views.busy(view, isBusy),
            lost: (why, isBack) => say(isBack ? `The preview failed (${why}) and was restarted.` : `The preview keeps failing on this program: ${why}.`, { bad: true }),
            unreadable: () => say(UNREADABLE, { bad: true }),
        });
        const undo = (call: "undo" | "redo") => void attempt(async () => void (await this.core.call(call, {})));
        this.views = new Views(this.core, {
            pointed: () => {},
            declaration: (pick) => pick?.range && this.select(pick.range),
            say: (message) => say(message),
            save: (view) => savePicture(this.core, this.views.list(), view, this.stem),
            undo: () => undo("undo"),
            redo: () => undo("redo"),
        });
        this.settings = new SettingsPane(this.core, {
            declaration: (name) =>
                void attempt(async () => {
                    const range = await this.core.call("declaration", { name });
                    if (range !== null) {
                        this.select(range);
                    }
                }),
            write: (param) => void this.apply(() => this.core.call("writeParam", { param })),
            writeColour: (object, rgb) => void this.apply(() => this.core.call("writeColour", { object, rgb })),
            writeCamera: () => {
                const name = this.core.settings.preferences?.camera ?? this.scene?.cameras[0] ?? "eye";
                void this.apply(() => this.core.call("writeCamera", { name }));
            },
            chooseImage: (object) => chooseFile(IMAGES, (file) => void this.layImage(file, object)),
            changed: () => this.update(),
            reset: () => {
                this.core.settings = {};
                this.core.tell("replaceSettings", { settings: {} });
                this.update();
            },
        });
        root.append(this.views.element, this.settings.element);
        this.setTheme();
        new MutationObserver(() => this.setTheme()).observe(document.body, { attributes: true, attributeFilter: ["class"] });
        addEventListener("message", ({ data }: MessageEvent<Told>) => this.hear(data));
        host.postMessage({ said: "ready" });
    }

    private hear(told: Told): void {
        switch (told.told) {
            case "open": {
                if (this.name === told.name) {
                    // The extension tells all of a text whose places are not the editor's: pictures and settings stay.
                    const changes = difference(this.text, told.text);
                    this.hear({ told: "edit", version: told.version, changes });
                    return;
                }
                this.name = told.name;
                this.text = told.text;
                this.version = told.version;
                this.stem = told.name.replace(/\.(gtr|crt)$/, "");
                void attempt(async () => {
                    const { name, text, version } = told;
                    await this.core.open({ name, text, version }, host.getState()?.settings ?? {});
                });
                return;
            }
            case "edit":
                this.version = told.version;
                this.text = changed(this.text, told.changes);
                this.core.edit(told.version, told.changes, () => this.text);
                return;
            case "cursor":
                this.core.tell("cursor", { at: told.at });
                return;
            case "view":
                this.open(told.view, told.surface);
        }
    }

    /** Opens a view: of a surface, or traced through a camera, if one is named. */
    private open(view: "3d" | "geodesic" | "traced", name: string | undefined): void {
        const { closed = [], opened = [] } = this.core.settings;
        const id = view === "geodesic" ? `geodesic:${name}` : "3d";
        this.core.change({
            closed: closed.filter((it) => it !== id),
            opened: [...opened.filter((it) => it !== id), id],
            ...(view !== "geodesic" && { preferences: { traced: view === "traced", ...(name && { camera: name }) } }),
            ...(view === "traced" && name && { space: null }),
        });
        this.update();
    }

    private update(): void {
        if (this.scene !== undefined) {
            this.settings.update(this.scene);
            this.views.update(this.scene);
        }
        host.setState({ settings: this.core.settings });
    }

    private select(range: TextRange): void {
        host.postMessage({ said: "select", range, version: this.version });
    }

    private async apply(call: () => Promise<TextEdit>): Promise<void> {
        const { version } = this;
        await attempt(async () => host.postMessage({ said: "apply", edits: [await call()], version }));
    }

    private async layImage(file: File, object: string): Promise<void> {
        await attempt(async () => {
            await this.core.texture(file.name, await readImage(file));
            const known = this.core.settings.textures ?? [];
            const textures = known.includes(file.name) ? known : [...known, file.name];
            this.core.change({ textures, looks: { [object]: { texture: { image: file.name } } } }, "image");
            this.update();
        });
    }

    private setTheme(): void {
        const isLight = document.body.classList.contains("vscode-light") || document.body.classList.contains("vscode-high-contrast-light");
        document.documentElement.dataset["theme"] = isLight ? "light" : "dark";
        this.core.tell("light", { isLight });
    }
}

/** A text after edits of it, which are in its order. */
function changed(text: string, changes: TextEdit[]): string {
    let [result, at] = ["", 0];
    for (const { from, to, insert } of changes) {
        result += text.slice(at, from) + insert;
        at = to;
    }
    return result + text.slice(at);
}

/** The edit that makes one text of another: all between what they have in common at both ends. */
function difference(before: string, after: string): TextEdit[] {
    let from = 0;
    const shorter = Math.min(before.length, after.length);
    while (from < shorter && before[from] === after[from]) {
        from += 1;
    }
    let end = 0;
    while (end < shorter - from && before[before.length - 1 - end] === after[after.length - 1 - end]) {
        end += 1;
    }
    return [{ from, to: before.length - end, insert: after.slice(from, after.length - end) }];
}

async function begin(): Promise<void> {
    document.head.append(make("style", {}, pageStyle + OWN_STYLE));
    const root = make("div", { id: "panel" });
    document.body.append(root);
    // A webview gives no files to the reader by itself.
    saveBy((name, content) => {
        const reader = new FileReader();
        reader.addEventListener("load", () => {
            const base64 = String(reader.result).replace(/^[^,]*,/, "");
            host.postMessage({ said: "save", name, base64 });
        });
        reader.readAsDataURL(content);
    });
    new Panel(root, await workerOf());
}

void begin();
