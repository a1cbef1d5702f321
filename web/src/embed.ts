// An element for lecture pages, in a script of its own:
//
//   <script type="module" src="geotrace-view.js"></script>
//   <geotrace-view src="torus.gtr" view="geodesic:s" controls></geotrace-view>
//   <geotrace-view>surface s(u, v) = (u, v, u v), u : [-1, 1], v : [-1, 1];</geotrace-view>
//
// `src` names a program; without it, the text inside the element is one. `view` is `3d` (the usual one), `traced`, or
// `geodesic:NAME`. `controls` shows the sliders. `language="crt"` is for a script that stands inside. All elements of a page
// share the code; each has a Worker, which starts when the element comes near the screen.

import controlsStyle from "./controls.css?inline";
import { Core, startWorker } from "./core.ts";
import { make } from "./dom.ts";
import { Pane } from "./pane.ts";
import paneStyle from "./pane.css?inline";
import type { Scene, Settings, ViewInfo } from "./protocol.ts";
import { Sliders } from "./sliders.ts";
import themeStyle from "./theme.css?inline";

const OWN_STYLE = `
:host { display: flex; flex-direction: column; width: 100%; height: 360px; font: 14px/1.45 var(--font); color: var(--text); }
:host([hidden]) { display: none; }
* { box-sizing: border-box; }
[hidden] { display: none !important; }
p { margin: 0; }
.view { flex: 1; }
.sliders { flex: none; max-height: 45%; padding: 4px 8px 0; overflow: auto; }
.message { order: 9; padding: 8px 12px; color: var(--error); white-space: pre-wrap; }
`;

/** The part of the path that says the language. */
const LANGUAGE = /\.(gtr|crt)(?=$|[?#])/i;

class GeotraceView extends HTMLElement {
    static readonly observedAttributes = ["src", "view", "controls", "language", "theme"];
    private core: Core | undefined;
    private pane: Pane | undefined;
    private sliders: Sliders | undefined;
    private scene: Scene | undefined;
    private version = 0;
    /** What is wrong with the program, and with the view that is asked of it. */
    private readonly problems: { program?: string | undefined; view?: string | undefined } = {};
    private readonly message = make("p", { class: "message", role: "alert", hidden: true });
    private readonly near = new IntersectionObserver(
        (entries) => {
            if (entries.some((entry) => entry.isIntersecting)) {
                this.near.disconnect();
                this.begin();
            }
        },
        { rootMargin: "300px" },
    );
    private readonly scheme = matchMedia("(prefers-color-scheme: dark)");
    private readonly follow = () => this.setTheme();

    connectedCallback(): void {
        if (this.shadowRoot === null) {
            const style = make("style", {}, themeStyle + controlsStyle + paneStyle + OWN_STYLE);
            this.attachShadow({ mode: "open" }).append(style, this.message);
        }
        this.scheme.addEventListener("change", this.follow);
        this.setTheme();
        this.near.observe(this);
    }

    disconnectedCallback(): void {
        this.near.disconnect();
        this.scheme.removeEventListener("change", this.follow);
        this.core?.end();
        this.pane?.end();
        this.sliders?.element.remove();
        this.core = undefined;
        this.pane = undefined;
    }

    attributeChangedCallback(name: string): void {
        if (this.core === undefined) {
            return;
        }
        if (name === "src" || name === "language") {
            void this.open();
        } else if (name === "theme") {
            this.setTheme();
        } else if (name === "view") {
            this.core.change({ preferences: { traced: this.isTraced } });
            this.see(this.scene);
        } else {
            this.see(this.scene);
        }
    }

    private get isTraced(): boolean {
        return this.getAttribute("view") === "traced";
    }

    /** The name of the view, as the core has it. */
    private get view(): string {
        const view = this.getAttribute("view") ?? "3d";
        return view === "traced" ? "3d" : view;
    }

    private begin(): void {
        this.core = new Core(startWorker, {
            findings: ({ findings }) => {
                const error = findings.find((it) => it.severity === "error");
                this.problems.program = error && `${error.message}${error.hint === null ? "" : `\n${error.hint}`}`;
                this.say();
            },
            scene: (scene) => this.see(scene),
            settings: () => this.see(this.scene),
            picture: (picture) => this.pane?.show(picture),
            noPicture: ({ message }) => this.pane?.refuse(message),
            busy: ({ isBusy }) => this.pane?.setBusy(isBusy),
            lost: (why, isBack) => {
                this.problems.program = isBack ? undefined : `This program cannot be shown: ${why}.`;
                this.say();
            },
        });
        this.sliders = new Sliders(this.core);
        this.setTheme();
        void this.open();
    }

    private async open(): Promise<void> {
        const { core } = this;
        if (core === undefined) {
            return;
        }
        this.version += 1;
        const { version } = this;
        // The element may be removed, or get another program, while this one is fetched.
        const isWanted = () => core === this.core && version === this.version;
        try {
            const src = this.getAttribute("src");
            const extension = this.getAttribute("language") === "crt" ? "crt" : "gtr";
            let name = `program.${extension}`;
            let text = trimmed(this.textContent ?? "");
            if (src !== null) {
                const url = new URL(src, document.baseURI);
                name = `program.${LANGUAGE.exec(url.pathname)?.[1]?.toLowerCase() ?? extension}`;
                const response = await fetch(url);
                if (!response.ok) {
                    throw new Error(`${src} was not found (${response.status}).`);
                }
                text = await response.text();
            }
            if (!isWanted()) {
                return;
            }
            const settings: Settings = { preferences: { traced: this.isTraced } };
            await core.open({ name, text: text.replaceAll(/\r\n?/g, "\n"), version }, settings);
        } catch (error) {
            if (isWanted()) {
                this.problems.program = (error as Error).message;
                this.say();
            }
        }
    }

    private see(scene: Scene | undefined): void {
        const { core, sliders, shadowRoot: root } = this;
        if (scene === undefined || core === undefined || sliders === undefined || root === null) {
            return;
        }
        this.scene = scene;
        const info = scene.views.find((view) => view.id === this.view);
        if (info === undefined) {
            const names = scene.views.map((view) => view.id).join(", ");
            this.problems.view = `There is no view ${this.view}. The views are ${names}.`;
            this.say();
            return;
        }
        this.problems.view = undefined;
        this.say();
        if (this.pane?.info.id !== info.id) {
            this.pane?.end();
            this.pane = this.makePane(core, info);
            root.append(this.pane.element);
        }
        this.pane.update(info);
        const count = sliders.update(scene.params);
        if (this.hasAttribute("controls") && count > 0) {
            root.append(sliders.element);
        } else {
            sliders.element.remove();
        }
    }

    private makePane(core: Core, info: ViewInfo): Pane {
        const pane: Pane = new Pane(info, core, {
            pointed: () => {},
            declaration: () => {},
            focused: () => core.tell("focus", { view: info.id }),
            resized: () => {
                const declared = pane.declared();
                core.tell("panes", { panes: declared === undefined ? [] : [declared] });
            },
            key: (key) => {
                if (key === "undo" || key === "redo") {
                    core.call(key, {}).catch(() => {});
                } else if (key === "orthographic" || (key === "traced" && info.instead !== null)) {
                    core.change({ preferences: { [key]: !(core.settings.preferences?.[key] ?? false) } });
                }
            },
            say: () => {},
            isFlying: () => false,
        });
        return pane;
    }

    private setTheme(): void {
        const isDark = this.scheme.matches;
        if (!this.hasAttribute("theme")) {
            this.dataset["theme"] = isDark ? "dark" : "light";
        } else {
            this.dataset["theme"] = this.getAttribute("theme") === "dark" ? "dark" : "light";
        }
        this.core?.tell("light", { isLight: this.dataset["theme"] !== "dark" });
    }

    private say(): void {
        const message = this.problems.program ?? this.problems.view;
        this.message.hidden = message === undefined;
        // What stands there already is not read out once more.
        if (this.message.textContent !== (message ?? "")) {
            this.message.textContent = message ?? "";
        }
    }
}

/** A text without the indentation and the empty lines that it has in a page. */
function trimmed(text: string): string {
    const lines = text.replaceAll("\t", "    ").split("\n");
    const indents = lines.filter((line) => line.trim() !== "").map((line) => line.length - line.trimStart().length);
    const least = Math.min(...indents, Number.MAX_SAFE_INTEGER);
    return `${lines.map((line) => line.slice(least)).join("\n").trim()}\n`;
}

if (customElements.get("geotrace-view") === undefined) {
    customElements.define("geotrace-view", GeotraceView);
}
