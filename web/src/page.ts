// The page: the program on the left, the pictures on the right, and what leads from one program to another.
//
//   editor ── edits ──▶ core ──▶ findings, scene, pictures ──▶ editor, settings, views
//
// A program comes from the link, from what the browser kept, from a file, the gallery or a template; the one before it is
// remembered, so that nothing that was typed is lost.

import { Core, startWorker, UNREADABLE } from "./core.ts";
import { ask, attempt, menu, say } from "./dialogs.ts";
import { button, download, icon, make } from "./dom.ts";
import { Editor } from "./editor.ts";
import { recolour } from "./editor/colours.ts";
import { FIRST, TEMPLATES } from "./examples.ts";
import { FORMATS, saveMesh, savePicture } from "./export.ts";
import { chooseFile, IMAGES, isProgram, named, PROGRAMS, readImage, readProgram } from "./files.ts";
import { openGallery, openHelp, welcome } from "./gallery.ts";
import iconAddress from "./icon.svg?url";
import { LinkError, unpacked } from "./link.ts";
import { letter } from "./pane.ts";
import { Problems } from "./problems.ts";
import type { Pick, Scene, Settings, TextEdit } from "./protocol.ts";
import { SettingsPane } from "./settings.ts";
import { copyLink } from "./sharing.ts";
import { columns } from "./splitters.ts";
import * as store from "./store.ts";
import { Views } from "./views.ts";

/** The pause until a change is kept, in milliseconds. */
const KEEP = 400;

type TabName = "program" | "views" | "settings";

export class Page {
    private readonly core: Core;
    private readonly editor: Editor;
    private readonly views: Views;
    private readonly settings: SettingsPane;
    private readonly name = make("input", { class: "name", "aria-label": "Name of the program", spellcheck: false });
    private readonly problems: Problems;
    private readonly pointed = make("span", { class: "pointed" });
    private readonly panes = make("main", { class: "panes", "data-tab": "views" });
    private readonly tabs = new Map<TabName, HTMLButtonElement>();
    private readonly steps: HTMLElement;
    private scene: Scene | undefined;
    private fileName = "first.gtr";
    /** The program that is open, as it was opened. */
    private opened: store.Kept | undefined;
    /** The reader has written the text, or changed it. */
    private isOwn = false;
    private saving: ReturnType<typeof setTimeout> | undefined;
    private light: boolean | undefined;

    constructor(private readonly root: HTMLElement) {
        this.core = new Core(startWorker, {
            ready: ({ threads }) => Object.assign(document.documentElement.dataset, { core: "ready", threads }),
            findings: ({ version, findings }) => this.editor.found(version, findings),
            scene: (scene) => this.see(scene),
            settings: () => this.settingsChanged(),
            picture: (picture) => this.views.picture(picture),
            noPicture: (reason) => this.views.noPicture(reason),
            busy: ({ view, isBusy }) => this.views.busy(view, isBusy),
            lost: (why, isBack) => this.lost(why, isBack),
            unreadable: () => say(UNREADABLE, { bad: true }),
        });
        this.problems = new Problems({
            show: (range) => this.show(range),
            fix: (fix, version) => this.editor.apply(fix.edits, version, "the fix"),
        });
        const editorBox = make("div", { class: "editor" });
        this.editor = new Editor(editorBox, this.core, {
            changed: (isByHand) => this.edited(isByHand),
            shown: (findings, all) => this.problems.set(findings, all),
            say: (message) => say(message),
            askName: (old) => ask("Rename", `A new name for ${old}`, old),
        });
        this.views = new Views(this.core, {
            pointed: (pick) => this.point(pick),
            declaration: (pick) => this.declaration(pick),
            say: (message) => say(message),
            save: (view) => savePicture(this.core, this.views.list(), view, this.stem()),
            undo: () => void this.undo("undo"),
            redo: () => void this.undo("redo"),
        });
        this.settings = new SettingsPane(this.core, {
            declaration: (name) => void this.goTo(name),
            write: (param) => void this.write(() => this.core.call("writeParam", { param })),
            writeColour: (object, rgb) => void this.write(() => this.core.call("writeColour", { object, rgb })),
            chooseImage: (object) => chooseFile(IMAGES, (file) => void this.layImage(file, object)),
            changed: () => this.settingsChanged(),
            writeCamera: () => void this.writeCamera(),
            reset: () => this.reset(),
        });
        this.steps = welcome({
            gallery: () => this.gallery(),
            help: () => openHelp(this.scene),
            close: () => this.closeWelcome(),
        });
        this.lay(editorBox);
        this.listen();
        this.setTheme();
    }

    /** Opens what the link says, else what was open before, else the first program. */
    async begin(): Promise<void> {
        const kept = store.current();
        // Loaded again in the same tab, the program has the settings that were chosen since.
        const isAgain = kept?.link !== undefined && kept.link === location.hash;
        if (!isAgain && (await this.followLink())) {
            if (kept !== undefined && kept.text !== this.editor.text) {
                this.remember(kept);
            }
            return;
        }
        if (kept !== undefined) {
            this.open(kept, true);
            return;
        }
        this.open({ name: "first.gtr", text: FIRST }, false);
        this.steps.hidden = store.hasSeenWelcome();
    }

    /** Opens a program in the place of the one that is open, which is remembered if the reader has changed it. */
    private open(program: store.Kept, isOwn: boolean): void {
        if (this.isOwn) {
            this.remember(this.kept());
        }
        this.isOwn = isOwn;
        this.opened = program;
        this.fileName = program.name;
        this.name.value = program.name;
        this.editor.open(program.text);
        this.closeWelcome(false);
        this.read(program);
    }

    /** Remembers a program; where there is no room for it, the reader can save it. */
    private remember(program: store.Kept): void {
        if (!store.remember(program)) {
            const { name, text } = program;
            const action = { label: "Save it", press: () => download(name, text, "text/plain") };
            say(`There is no room to keep ${name} under Open.`, { bad: true, action });
        }
    }

    /** Hands the core a program whose text is in the editor. */
    private read({ name, text, settings }: store.Kept): void {
        document.title = `${name} – Geotrace`;
        const { version } = this.editor;
        this.core.open({ name, text, version }, settings ?? {}).then(
            ({ lineComment }) => {
                this.editor.setLineComment(lineComment);
                this.editor.view.dispatch({ effects: recolour.of(null) });
            },
            (error: Error) => say(error.message, { bad: true }),
        );
        this.keep();
    }

    private async followLink(): Promise<boolean> {
        try {
            const shared = await unpacked(location.hash);
            if (shared === undefined) {
                return false;
            }
            this.open({ ...shared, name: named(shared.name) }, false);
            return true;
        } catch (error) {
            if (!(error instanceof LinkError)) {
                throw error;
            }
            this.dropLink();
            say(`${error.message} The previous program is shown instead.`, { bad: true });
            return false;
        }
    }

    /** The address no longer says what is on the page. */
    private dropLink(): void {
        if (location.hash !== "") {
            history.replaceState(null, "", location.pathname + location.search);
        }
    }

    private kept(): store.Kept {
        return { name: this.fileName, text: this.editor.text, settings: this.core.settings };
    }

    private keep(): void {
        clearTimeout(this.saving);
        this.saving = setTimeout(() => this.keepNow(), KEEP);
    }

    private keepNow(): void {
        clearTimeout(this.saving);
        if (!store.keep({ ...this.kept(), link: location.hash }) && this.isOwn) {
            say("This browser has no space to store the program. Save it as a file before you close the page.", { bad: true });
        }
    }

    private edited(isByHand: boolean): void {
        if (isByHand) {
            this.isOwn = true;
            this.dropLink();
        }
        this.keep();
    }

    private settingsChanged(): void {
        if (this.scene !== undefined) {
            this.settings.update(this.scene);
            this.views.update(this.scene);
        }
        this.setLight();
        this.keep();
    }

    private see(scene: Scene): void {
        this.scene = scene;
        this.settings.update(scene);
        this.views.update(scene);
        this.panes.classList.toggle("stale", scene.stale);
    }

    private lost(why: string, isBack: boolean): void {
        if (isBack) {
            say(`The computing part of the page failed (${why}) and was restarted. Your text and settings are kept.`, {
                bad: true,
            });
        } else {
            say(`The computing part of the page keeps failing on this program (${why}). Change the program to try again.`, {
                bad: true,
            });
        }
    }

    private show(range: { from: number; to: number }): void {
        this.choose("program");
        this.editor.select(range);
    }

    private point(pick: Pick | null): void {
        this.pointed.textContent = pick?.text ?? "";
    }

    private declaration(pick: Pick | null): void {
        if (pick === null) {
            say("Nothing is visible there.");
        } else if (pick.range !== null) {
            this.show(pick.range);
        }
    }

    private async goTo(name: string): Promise<void> {
        await attempt(async () => {
            const range = await this.core.call("declaration", { name });
            if (range !== null) {
                this.show(range);
            }
        });
    }

    private async write(call: () => Promise<TextEdit>): Promise<void> {
        const { version } = this.editor;
        await attempt(async () => this.editor.apply([await call()], version, "the change"));
    }

    private async writeCamera(): Promise<void> {
        const { version } = this.editor;
        const name = this.core.settings.preferences?.camera ?? this.scene?.cameras[0] ?? "eye";
        await attempt(async () => {
            const edit = await this.core.call("writeCamera", { name });
            this.editor.apply([edit], version, "the change");
            this.show({ from: edit.from, to: edit.from + edit.insert.length });
        });
    }

    private reset(): void {
        const before = this.core.settings;
        const replace = (settings: Settings) => {
            this.core.settings = settings;
            this.core.tell("replaceSettings", { settings });
            this.settingsChanged();
        };
        replace({});
        const { opened } = this;
        const undo = () => {
            // They are not those of another program.
            if (this.opened === opened) {
                replace(before);
            }
        };
        say("All settings were reset.", { action: { label: "Undo", press: undo } });
    }

    private async undo(call: "undo" | "redo"): Promise<void> {
        await attempt(async () => {
            const step = await this.core.call(call, {});
            if (step === null) {
                say(call === "undo" ? "There is nothing to undo." : "There is nothing to redo.");
            }
        });
    }

    // ------------------------------------------------------------------------------------------------- programs and files

    private gallery(): void {
        openGallery((example) => {
            this.dropLink();
            this.open({ name: example.file, text: example.text }, false);
        });
    }

    private newMenu(): { label: string; press(): void }[] {
        const fresh = TEMPLATES.map(({ title, file, text }) => ({
            label: title,
            press: () => {
                this.dropLink();
                this.open({ name: file, text }, false);
                this.editor.view.focus();
            },
        }));
        return fresh;
    }

    private openMenu(): { label: string; keys?: string; press(): void }[] {
        const before = this.recentMenu(({ name, text }) => `${name}: ${text.trim().split("\n")[0]?.slice(0, 40) ?? ""}`);
        return [{ label: "Open a file…", keys: "Ctrl+O", press: () => chooseFile(PROGRAMS, (file) => void this.openFile(file)) }, ...before];
    }

    /** The programs that were open before, the last one first, with their labels. */
    private recentMenu(label: (program: store.Kept) => string): { label: string; press(): void }[] {
        return store.recent().map((program) => ({
            label: label(program),
            press: () => {
                this.dropLink();
                this.open(program, true);
            },
        }));
    }

    private async openFile(file: File): Promise<void> {
        await attempt(async () => {
            const program = await readProgram(file);
            this.dropLink();
            this.open(program, true);
        });
    }

    /** Lays an image on an object. */
    private async layImage(file: File, object: string): Promise<void> {
        await attempt(async () => {
            const { name } = file;
            await this.core.texture(name, await readImage(file));
            const known = this.core.settings.textures ?? [];
            const textures = known.includes(name) ? known : [...known, name];
            this.core.change({ textures, looks: { [object]: { texture: { image: name } } } }, "image");
            this.settingsChanged();
        });
    }

    /** Opens a program, or lays an image on the surface that it is dropped on, else on the first one. */
    private async drop(event: DragEvent): Promise<void> {
        const file = event.dataTransfer?.files[0];
        if (file === undefined || isProgram(file)) {
            return file && this.openFile(file);
        }
        const hit = this.views.at(event.clientX, event.clientY);
        const textured = this.scene?.objects.filter((it) => it.hasTexture) ?? [];
        let object = textured[0]?.name;
        if (hit !== undefined) {
            const pick = await this.core.call("pick", { view: hit.pane.info.id, at: hit.place }).catch(() => null);
            object = textured.find((it) => it.name === pick?.object)?.name ?? object;
        }
        if (object === undefined) {
            say("There is no surface for the image.");
            return;
        }
        await this.layImage(file, object);
    }

    private saveFile(): void {
        download(this.fileName, this.editor.text, "text/plain");
    }

    private stem(): string {
        return this.fileName.replace(/\.(gtr|crt)$/, "") || "geotrace";
    }

    // ---------------------------------------------------------------------------------------------------------- the frame

    private lay(editorBox: HTMLElement): void {
        const open = button("Open", () => {}, { icon: "open", kind: "wide desk" });
        menu(open, () => this.openMenu());
        const fresh = button("New", () => {}, { icon: "add", kind: "wide desk" });
        menu(fresh, () => this.newMenu());
        const save = button("Export", () => {}, { icon: "download", kind: "wide desk" });
        menu(save, () => this.exportMenu());
        const more = button("Menu", () => {}, { icon: "menu", text: false, kind: "phone" });
        menu(more, () => [
            { label: "Open a file…", press: () => chooseFile(PROGRAMS, (file) => void this.openFile(file)) },
            ...this.recentMenu(({ name }) => `Open ${name} again`).slice(0, 3),
            ...this.newMenu().map((it) => ({ ...it, label: it.label === "First program" ? it.label : `New: ${it.label}` })),
            ...this.exportMenu(),
            { label: "Light or dark", press: () => this.flipTheme() },
            { label: "Help", press: () => openHelp(this.scene) },
        ]);
        const edit = button("Edit", () => {}, { icon: "dots", text: false, hint: "Edit the program" });
        menu(edit, () => this.editMenu());
        const bar = make(
            "header",
            { class: "bar" },
            make("div", { class: "brand" }, make("img", { src: iconAddress, alt: "" }), make("span", {}, "Geotrace")),
            fresh,
            button("Examples", () => this.gallery(), { icon: "gallery", kind: "wide" }),
            open,
            make("span", { class: "space" }),
            save,
            button("Copy link", () => void copyLink(this.core, this.kept()), { icon: "link", kind: "primary wide", hint: "Copy a link to this program and its settings" }),
            button("Light or dark", () => this.flipTheme(), { icon: "moon", text: false, kind: "desk" }),
            button("Help", () => openHelp(this.scene), { icon: "help", text: false, kind: "desk" }),
            more,
        );
        const head = make("div", { class: "head" }, this.name, make("span", { class: "space" }), edit);
        const program = make("section", { class: "program", "aria-label": "Program" }, head, this.steps, editorBox, this.problems.element);
        this.steps.hidden = true;
        const column = make("div", { class: "column" }, program, this.settings.element);
        this.panes.append(column, this.views.element);
        columns(this.panes, column, program);
        const status = make("footer", { class: "status" }, this.problems.count, make("span", { class: "space" }), this.pointed);
        const tab = (name: TabName, label: string, kind: "code" | "cube" | "sliders") => {
            const press = make("button", { type: "button", role: "tab", onclick: () => this.choose(name) }, icon(kind), label);
            this.tabs.set(name, press);
            return press;
        };
        const bottom = make(
            "nav",
            { class: "bottom", role: "tablist", "aria-label": "Panes" },
            tab("program", "Program", "code"),
            tab("views", "Pictures", "cube"),
            tab("settings", "Settings", "sliders"),
        );
        this.tabs.get("program")?.append(this.problems.badge);
        this.root.append(bar, this.panes, status, bottom);
        this.choose("views");
    }

    private exportMenu(): { label: string; keys?: string; press(): void }[] {
        return [
            { label: "Save the program", keys: "Ctrl+S", press: () => this.saveFile() },
            { label: "Save a picture…", press: () => savePicture(this.core, this.views.list(), this.views.current()?.info.id, this.stem()) },
            ...FORMATS.map(({ format, label }) => ({ label: `Mesh: ${label}`, press: () => void saveMesh(this.core, format, this.stem()) })),
        ];
    }

    private editMenu(): { label: string; keys?: string; press(): void }[] {
        return [
            { label: "Find and replace", keys: "Ctrl+F", press: () => this.editor.find() },
            { label: "Rename…", keys: "F2", press: () => void this.editor.rename() },
            { label: "Format", keys: "Shift+Alt+F", press: () => void this.editor.format() },
            { label: "Comment", keys: "Ctrl+/", press: () => this.editor.toggleComment() },
            { label: "Apply all fixes", keys: "Ctrl+.", press: () => void this.editor.fixAll() },
        ];
    }

    private choose(tab: TabName): void {
        this.panes.dataset["tab"] = tab;
        for (const [name, press] of this.tabs) {
            press.setAttribute("aria-selected", String(name === tab));
        }
    }

    private closeWelcome(isSeen = true): void {
        this.steps.hidden = true;
        if (isSeen) {
            store.seenWelcome();
        }
    }

    private setTheme(): void {
        const system = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
        document.documentElement.dataset["theme"] = store.theme() ?? system;
        this.setLight();
    }

    private flipTheme(): void {
        store.keepTheme(document.documentElement.dataset["theme"] === "dark" ? "light" : "dark");
        this.setTheme();
    }

    private setLight(): void {
        const isLight = document.documentElement.dataset["theme"] !== "dark";
        if (this.light !== isLight) {
            this.light = isLight;
            this.core.tell("light", { isLight });
        }
    }

    private listen(): void {
        this.name.addEventListener("change", () => {
            const before = this.fileName;
            this.fileName = named(this.name.value);
            this.name.value = this.fileName;
            // The extension says the language.
            if (before.slice(-4) !== this.fileName.slice(-4)) {
                this.read(this.kept());
            } else {
                document.title = `${this.fileName} – Geotrace`;
                this.keep();
            }
        });
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.setTheme());
        addEventListener("hashchange", () => void this.followLink());
        addEventListener("pagehide", () => this.keepNow());
        document.addEventListener("visibilitychange", () => {
            if (document.hidden) {
                this.keepNow();
            }
        });
        document.addEventListener("keydown", (event) => this.key(event));
        document.addEventListener("keyup", (event) => this.views.releaseKey(event));
        addEventListener("blur", () => this.views.releaseAll());
        const over = (event: DragEvent) => {
            if (event.dataTransfer?.types.includes("Files")) {
                event.preventDefault();
                this.root.classList.add("drop");
            }
        };
        document.addEventListener("dragenter", over);
        document.addEventListener("dragover", over);
        document.addEventListener("dragleave", (event) => {
            if (event.relatedTarget === null) {
                this.root.classList.remove("drop");
            }
        });
        // Before the editor, which would take a file's text.
        document.addEventListener(
            "drop",
            (event) => {
                this.root.classList.remove("drop");
                if (event.dataTransfer?.types.includes("Files")) {
                    event.preventDefault();
                    event.stopPropagation();
                    void this.drop(event);
                }
            },
            { capture: true },
        );
    }

    private key(event: KeyboardEvent): void {
        const isControl = (event.ctrlKey || event.metaKey) && !event.altKey && !event.shiftKey;
        const isOver = document.querySelector("dialog[open]") !== null;
        const commands: Record<string, () => void> = {
            "Control s": () => this.saveFile(),
            "Control o": () => chooseFile(PROGRAMS, (file) => void this.openFile(file)),
            F1: () => isOver || openHelp(this.scene),
        };
        const command = commands[isControl ? `Control ${letter(event)}` : event.key];
        if (command !== undefined) {
            event.preventDefault();
            if (!event.repeat) {
                command();
            }
        } else if (event.target === document.body && !isOver) {
            // Where nothing has the focus, keys move the camera of the last picture.
            this.views.current()?.press(event);
        }
    }
}
