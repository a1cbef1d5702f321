// The settings below the program: sliders of params, the objects and their looks, and what is drawn over the pictures.
//
// In: the scene and the settings. Out: patches of the settings. A control that is in use is never built anew.

import type { Core } from "./core.ts";
import { button, make, refill } from "./dom.ts";
import type { Marks, ObjectInfo, Preferences, Rgb, Scene, TextureChoice } from "./protocol.ts";
import { Sliders } from "./sliders.ts";

export interface SettingsEvents {
    /** The declaration of an object is to be shown. */
    declaration(name: string): void;
    /** A param's value is to be written into the text. */
    write(param: string): void;
    /** The colour that the text states for an object is to be another one. */
    writeColour(object: string, rgb: Rgb): void;
    /** An image is to be chosen for an object. */
    chooseImage(object: string): void;
    /** Settings have changed that decide which views there are, or how they look. */
    changed(): void;
    /** A camera of the text is to stand where the 3D view's stands. */
    writeCamera(): void;
    /** Everything that was chosen is forgotten. */
    reset(): void;
}

const TABS = ["Params", "Objects", "Views"] as const;
type Tab = (typeof TABS)[number];

/** The overlays: the name of the setting, what it is called, and what it shows. */
const MARKS: [keyof Marks & string, string, string][] = [
    ["labels", "Labels", "the names of points, curves and surfaces"],
    ["axes", "Axes", "a box with ticks around the scene"],
    ["legend", "Legend", "the meaning of colours and lines"],
    ["cameras", "Cameras", "the geodesic cameras and the declared ones"],
    ["wavefronts", "Wavefronts", "circles at equal distances from the camera"],
    ["conjugate", "Conjugate points", "where neighbouring geodesics meet again"],
    ["cutLocus", "Cut locus", "beyond it there is a shorter geodesic"],
    ["trail", "Trail of the walk", "the path of the camera"],
    ["error", "Estimated error", "of the picture"],
];

/** The titles of a swatch. */
const COLOURS = {
    chosen: "Choose a colour",
    constant: "Writes the colour into the program",
    expression: "The program states its colour as an expression",
};

export class SettingsPane {
    readonly element: HTMLElement;
    private readonly sheets: Record<Tab, HTMLElement>;
    private readonly buttons: Record<Tab, HTMLButtonElement>;
    private readonly sliders: Sliders;
    private scene: Scene | undefined;
    private looks = "";
    private marks = "";

    constructor(
        private readonly core: Core,
        private readonly events: SettingsEvents,
    ) {
        const sheet = (tab: Tab) =>
            make("div", { class: "sheet", role: "tabpanel", id: `sheet-${tab}`, "aria-labelledby": `tab-${tab}` });
        this.sheets = { Params: sheet("Params"), Objects: sheet("Objects"), Views: sheet("Views") };
        const tabs = make("div", { class: "tabs", role: "tablist", "aria-label": "Settings" });
        const tab = (name: Tab) =>
            make(
                "button",
                {
                    type: "button",
                    role: "tab",
                    id: `tab-${name}`,
                    "aria-controls": `sheet-${name}`,
                    onclick: () => this.choose(name),
                    onkeydown: (event: KeyboardEvent) => this.step(event, name),
                },
                name,
            );
        this.buttons = { Params: tab("Params"), Objects: tab("Objects"), Views: tab("Views") };
        tabs.append(...Object.values(this.buttons));
        this.element = make("section", { class: "settings", "aria-label": "Settings" }, tabs, ...Object.values(this.sheets));
        this.sliders = new Sliders(core, (param) => events.write(param));
        this.sheets.Params.append(this.sliders.element);
        this.choose("Params");
    }

    /** Takes what the program has, and the settings as they are. */
    update(scene: Scene): void {
        this.scene = scene;
        this.element.classList.toggle("bare", this.sliders.update(scene.params) === 0);
        this.setObjects(scene.objects);
        this.setViews(scene);
    }

    private choose(tab: Tab): void {
        for (const name of TABS) {
            this.sheets[name].hidden = name !== tab;
            this.buttons[name].setAttribute("aria-selected", String(name === tab));
            this.buttons[name].tabIndex = name === tab ? 0 : -1;
        }
    }

    private step(event: KeyboardEvent, from: Tab): void {
        const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
        const next = TABS[(TABS.indexOf(from) + by + TABS.length) % TABS.length];
        if (by !== 0 && next !== undefined) {
            this.choose(next);
            this.buttons[next].focus();
        }
    }

    private setObjects(objects: ObjectInfo[]): void {
        const { looks, textures, defaultTexture } = this.core.settings;
        const state = JSON.stringify([objects.map((it) => ({ ...it, range: null })), looks, textures, defaultTexture]);
        const isInUse = this.sheets.Objects.contains(document.activeElement) && document.activeElement instanceof HTMLInputElement;
        if (state === this.looks || isInUse) {
            return;
        }
        this.looks = state;
        const rows = objects.map((object) => this.object(object));
        const none = make("p", { class: "empty" }, "Curves, surfaces, points, vectors and solids of the program are listed here.");
        refill(this.sheets.Objects, ...(rows.length > 0 ? rows : [none]));
    }

    private object(object: ObjectInfo): HTMLElement {
        const { name, kind, hidden } = object;
        const look = (part: Record<string, unknown>, step: string) => {
            this.core.change({ looks: { [name]: part } }, `${step} ${name}`);
            this.refresh();
        };
        const eye = button(hidden ? `Show ${name}` : `Hide ${name}`, () => look({ hidden: !hidden }, "hide"), {
            icon: hidden ? "eyeOff" : "eye",
            text: false,
            id: `eye-${name}`,
        });
        const swatch = make("input", {
            type: "color",
            class: "swatch",
            value: hex(object.colour),
            disabled: object.statedColour === "expression",
            title: COLOURS[object.statedColour ?? "chosen"],
            "aria-label": `Colour of ${name}`,
        });
        swatch.addEventListener("input", () => {
            if (object.statedColour !== null) {
                return;
            }
            this.core.change({ looks: { [name]: { colour: rgb(swatch.value) } } }, `colour ${name}`);
        });
        swatch.addEventListener("change", () => {
            swatch.blur();
            if (object.statedColour !== null) {
                this.events.writeColour(name, rgb(swatch.value));
            }
            this.refresh();
        });
        const label = make(
            "button",
            { type: "button", class: "name", title: "Show its declaration", onclick: () => this.events.declaration(name) },
            make("code", {}, name),
            make("span", {}, object.stale ? `${kind}, as it was before the error` : kind),
        );
        return make(
            "div",
            { class: hidden ? "object off" : "object" },
            eye,
            swatch,
            label,
            object.hasTexture && this.texture(object, look),
        );
    }

    private texture({ name }: ObjectInfo, look: (part: Record<string, unknown>, step: string) => void): HTMLElement {
        const { looks, textures = [] } = this.core.settings;
        const chosen = looks?.[name]?.texture ?? "default";
        const select = make("select", { class: "field", id: `texture-${name}`, "aria-label": `Texture of ${name}` });
        const option = (value: string, label: string) => make("option", { value }, label);
        select.append(
            option("default", "Letters"),
            option("plain", "Plain colour"),
            option("curvature", "Curvature"),
            ...textures.map((image) => option(`image ${image}`, image)),
            option("choose", "Image…"),
        );
        select.value = typeof chosen === "string" ? chosen : `image ${chosen.image}`;
        select.addEventListener("change", () => {
            if (select.value === "choose") {
                select.value = typeof chosen === "string" ? chosen : `image ${chosen.image}`;
                this.events.chooseImage(name);
                return;
            }
            const image = select.value.startsWith("image ") ? select.value.slice(6) : undefined;
            look({ texture: image === undefined ? (select.value as TextureChoice) : { image } }, "texture");
        });
        return select;
    }

    private setViews(scene: Scene): void {
        const { preferences = {} } = this.core.settings;
        const own = scene.views.flatMap((view) => view.settings);
        const state = JSON.stringify([preferences, own, scene.cameras, scene.views.map((view) => [view.kind, view.instead])]);
        if (state === this.marks) {
            return;
        }
        this.marks = state;
        const sheet = this.sheets.Views;
        const { scrollTop } = sheet;
        const isInside = scene.views.some((view) => view.camera === "inside");
        const inside = ["wavefronts", "conjugate", "cutLocus", "trail", "error"];
        const boxes = MARKS.filter(([name]) => isInside || !inside.includes(name)).map(([name, label, about]) =>
            this.mark(name, label, about, preferences.marks?.[name] ?? false),
        );
        const others = new Map(own.filter((it) => !MARKS.some(([name]) => name === it.name)).map((it) => [it.name, it]));
        for (const { name, title, default: initial } of others.values()) {
            boxes.push(this.mark(name, title, "", preferences.marks?.[name] ?? initial));
        }
        refill(
            sheet,
            make("h3", {}, "Drawn over the pictures"),
            ...boxes,
            make("h3", {}, "3D view"),
            this.preference("orthographic", "Orthographic", "parallel lines stay parallel (5)"),
            this.preference("fly", "Fly", "a drag looks around; with Alt it turns about the target"),
            ...(scene.views.some((view) => view.instead !== null) ? [this.samples(preferences)] : []),
            ...(scene.cameras.length > 0 ? [this.camera(scene.cameras, preferences)] : []),
            make(
                "div",
                { class: "actions" },
                button("Write the camera into the program", () => this.events.writeCamera(), { kind: "outline", id: "write-camera" }),
                button("Reset all settings", () => this.events.reset(), { kind: "outline", id: "reset-settings" }),
            ),
        );
        sheet.scrollTop = scrollTop;
    }

    private mark(name: string, label: string, about: string, isOn: boolean): HTMLElement {
        return this.box(`mark-${name}`, label, about, isOn, (next) => ({ marks: { [name]: next } }));
    }

    private preference(name: "orthographic" | "fly", label: string, about: string): HTMLElement {
        const isOn = this.core.settings.preferences?.[name] ?? false;
        return this.box(`set-${name}`, label, about, isOn, (next) => ({ [name]: next }));
    }

    private box(
        id: string,
        label: string,
        about: string,
        isOn: boolean,
        patch: (next: boolean) => Record<string, unknown>,
    ): HTMLElement {
        const input = make("input", { type: "checkbox", id, checked: isOn });
        input.addEventListener("change", () => {
            this.core.change({ preferences: patch(input.checked) }, id);
            this.refresh();
        });
        return make("label", { class: "check" }, input, make("span", {}, label, about !== "" && make("small", {}, about)));
    }

    private samples({ samples }: Preferences): HTMLElement {
        const select = make("select", { class: "field", id: "set-samples" });
        for (const count of [1, 4, 16, 64, 256, 1024]) {
            select.append(make("option", { value: String(count) }, `${count} a pixel`));
        }
        const known = [...select.options].some((it) => it.value === String(samples));
        if (samples !== undefined && !known) {
            select.append(make("option", { value: String(samples) }, `${samples} a pixel`));
        }
        select.value = String(samples ?? 64);
        select.addEventListener("change", () => {
            this.core.change({ preferences: { samples: Number(select.value) } }, "samples");
        });
        return make("div", { class: "form" }, make("label", { htmlFor: "set-samples" }, "Samples when traced"), select);
    }

    private camera(cameras: string[], { camera }: Preferences): HTMLElement {
        const select = make("select", { class: "field", id: "set-camera" });
        select.append(...cameras.map((name) => make("option", { value: name }, name)));
        select.value = camera ?? cameras[0] ?? "";
        select.addEventListener("change", () => {
            this.core.change({ preferences: { camera: select.value }, space: null }, "camera");
        });
        return make("div", { class: "form" }, make("label", { htmlFor: "set-camera" }, "Look through"), select);
    }

    private refresh(): void {
        if (this.scene !== undefined) {
            this.update(this.scene);
        }
        this.events.changed();
    }
}

function hex(colour: Rgb): string {
    return `#${colour.map((part) => part.toString(16).padStart(2, "0")).join("")}`;
}

function rgb(text: string): Rgb {
    const part = (at: number) => Number.parseInt(text.slice(at, at + 2), 16);
    return [part(1), part(3), part(5)];
}
