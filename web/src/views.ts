// The panes beside the program: which views are open, how they share the room, and the chips that open and close them.

import type { Core } from "./core.ts";
import { button, type IconName, make, refill } from "./dom.ts";
import { Measuring } from "./measure.ts";
import { Pane, type PaneEvents } from "./pane.ts";
import type { NoPicture, Picture, Scene, ViewInfo } from "./protocol.ts";

/** The time between the pictures of a pane while the camera of another one is moved, in milliseconds. */
const BEHIND = 150;

export interface ViewsEvents extends Pick<PaneEvents, "pointed" | "declaration" | "say"> {
    /** The picture of a view is to be saved. */
    save(view: string): void;
    undo(): void;
    redo(): void;
}

export class Views {
    readonly element: HTMLElement;
    private readonly chips = make("div", { class: "chips", role: "toolbar", "aria-label": "Views" });
    private readonly grid = make("div", { class: "grid" });
    private readonly nothing = make("p", { class: "empty" });
    private readonly panes = new Map<string, Pane>();
    private readonly measuring: Measuring;
    private scene: Scene | undefined;
    private focused: string | undefined;
    private isTold = false;
    /** The pane whose camera was moved last, and when. */
    private moved: { pane: Pane; at: number } | undefined;

    constructor(
        private readonly core: Core,
        private readonly events: ViewsEvents,
    ) {
        this.measuring = new Measuring(core);
        const parts = [this.chips, this.measuring.element, this.grid];
        this.element = make("div", { class: "views", role: "group", "aria-label": "Pictures" }, ...parts);
        new ResizeObserver(() => this.arrange()).observe(this.grid);
    }

    /** Takes what there is to be seen, or other settings. */
    update(scene: Scene): void {
        this.scene = scene;
        const open = scene.views.filter((view) => this.isOpen(view));
        for (const [id, pane] of this.panes) {
            if (!open.some((view) => view.id === id)) {
                pane.end();
                this.panes.delete(id);
            }
        }
        for (const [at, info] of open.entries()) {
            let pane = this.panes.get(info.id);
            if (pane === undefined) {
                pane = this.pane(info);
                this.panes.set(info.id, pane);
            }
            pane.update(info);
            this.setTools(pane);
            if (this.grid.children[at] !== pane.element) {
                this.grid.insertBefore(pane.element, this.grid.children[at] ?? null);
            }
        }
        this.nothing.remove();
        if (open.length === 0) {
            this.nothing.textContent = scene.empty ?? "No view is open. The buttons above open them.";
            this.grid.append(this.nothing);
        }
        this.setChips(scene.views);
        this.arrange();
        this.measuring.update(scene);
    }

    picture(picture: Picture): void {
        const pane = this.panes.get(picture.view);
        if (pane === undefined) {
            this.core.tell("shown", { view: picture.view });
        } else {
            pane.show(picture);
        }
    }

    noPicture({ view, message }: NoPicture): void {
        this.panes.get(view)?.refuse(message);
    }

    busy(view: string | null, isBusy: boolean): void {
        for (const [id, pane] of this.panes) {
            if (view === null || view === id) {
                pane.setBusy(isBusy);
            }
        }
    }

    /** The pane that keys belong to where nothing else has the focus: the last one that had it, or the first. */
    current(): Pane | undefined {
        const last = this.focused === undefined ? undefined : this.panes.get(this.focused);
        return last ?? [...this.panes.values()].find((pane) => pane.declared() !== undefined);
    }

    /** Takes the release of a key: the focus may have gone elsewhere since it was pressed. */
    releaseKey(event: KeyboardEvent): void {
        for (const pane of this.panes.values()) {
            // The pane that has the focus hears of it by itself.
            if (event.target !== pane.canvas) {
                pane.releaseKey(event);
            }
        }
    }

    /** Releases all keys: the window does not hear of them. */
    releaseAll(): void {
        for (const pane of this.panes.values()) {
            pane.releaseAll();
        }
    }

    /** The open panes, in their order. */
    list(): Pane[] {
        const open = [...this.panes.values()];
        const order = (pane: Pane) => [...this.grid.children].indexOf(pane.element);
        return open.sort((a, b) => order(a) - order(b));
    }

    /** The pane at a place of the screen. */
    at(x: number, y: number): { pane: Pane; place: [number, number] } | undefined {
        for (const pane of this.panes.values()) {
            const { left, top, right, bottom } = pane.canvas.getBoundingClientRect();
            const declared = pane.declared();
            if (declared !== undefined && left <= x && x < right && top <= y && y < bottom) {
                const ratio = declared.width / (right - left);
                return { pane, place: [(x - left) * ratio, (y - top) * ratio] };
            }
        }
        return undefined;
    }

    private isOpen(view: ViewInfo): boolean {
        const { closed, opened } = this.core.settings;
        return view.opensByItself ? !closed?.includes(view.id) : (opened?.includes(view.id) ?? false);
    }

    /** Opens or closes a view. */
    toggle(view: ViewInfo): void {
        const key = view.opensByItself ? "closed" : "opened";
        const list = this.core.settings[key] ?? [];
        const next = list.includes(view.id) ? list.filter((id) => id !== view.id) : [...list, view.id];
        this.core.change({ [key]: next }, `view ${view.id}`);
        if (this.scene !== undefined) {
            this.update(this.scene);
        }
    }

    private pane(info: ViewInfo): Pane {
        const { pointed, declaration, say, undo, redo } = this.events;
        const pane: Pane = new Pane(info, this.core, {
            pointed,
            declaration,
            say,
            focused: () => {
                this.focused = pane.info.id;
                this.core.tell("focus", { view: pane.info.id });
            },
            resized: () => this.tellSizes(),
            moved: () => (this.moved = { pane, at: performance.now() }),
            delay: () => (this.isBehind(pane) ? BEHIND : 0),
            isMeasuring: () => this.measuring.takesPlaces,
            measured: (pick) => this.measuring.take(pick),
            isFlying: () => this.core.settings.preferences?.fly ?? false,
            key: (key) => {
                switch (key) {
                    case "measure":
                        return this.measuring.toggle();
                    case "traced":
                        return pane.info.instead === null ? undefined : this.flip("traced");
                    case "orthographic":
                        return this.flip("orthographic");
                    case "undo":
                        return undo();
                    case "redo":
                        return redo();
                    default:
                        return this.go(pane, key === "next" ? 1 : -1);
                }
            },
        });
        return pane;
    }

    /** The reader moves the camera of another pane: this one shows that in its own pictures, but need not for each step. */
    private isBehind(pane: Pane): boolean {
        const { moved } = this;
        if (moved === undefined || moved.pane === pane) {
            return false;
        }
        return moved.pane.isHeld || performance.now() - moved.at < BEHIND;
    }

    private flip(setting: "traced" | "orthographic"): void {
        const isOn = this.core.settings.preferences?.[setting] ?? false;
        this.core.change({ preferences: { [setting]: !isOn } }, setting);
        if (this.scene !== undefined) {
            this.update(this.scene);
        }
    }

    private go(from: Pane, by: number): void {
        const list = this.list();
        list[(list.indexOf(from) + by + list.length) % list.length]?.canvas.focus();
    }

    private setTools(pane: Pane): void {
        const { info, tools } = pane;
        const isTraced = this.core.settings.preferences?.traced ?? false;
        const state = `${info.instead}${isTraced}${info.camera}`;
        if (tools.dataset["state"] === state) {
            return;
        }
        tools.dataset["state"] = state;
        const square = (label: string, name: IconName, press: () => void) =>
            button(label, press, { icon: name, text: false });
        // Where there is little room, the menus and the chips have these too.
        const minor = (label: string, name: IconName, press: () => void) =>
            button(label, press, { icon: name, text: false, kind: "minor" });
        const move = (name: "reset" | "frame") => () => {
            this.core.tell("camera", { view: info.id, move: name });
            this.core.tell("release", {});
        };
        const traced = button("Traced", () => this.flip("traced"), {
            icon: "traced",
            hint: "Lights, shadows, mirrors and glass (T)",
            id: `traced-${info.id}`,
        });
        traced.setAttribute("aria-pressed", String(isTraced));
        refill(
            tools,
            ...(info.instead === null ? [] : [traced]),
            ...(info.camera === "space" ? [square("Frame everything (F)", "fit", move("frame"))] : []),
            ...(info.camera === null ? [] : [square("Reset the camera (R)", "reset", move("reset"))]),
            minor(`Save a picture of ${info.title}`, "image", () => this.events.save(info.id)),
            minor(`Close ${info.title}`, "close", () => {
                this.toggle(info);
                document.getElementById(`chip-${info.id}`)?.focus();
            }),
        );
    }

    private setChips(views: ViewInfo[]): void {
        const state = JSON.stringify(views.map((view) => [view.id, view.title, this.isOpen(view)]));
        if (this.chips.dataset["state"] === state) {
            return;
        }
        this.chips.dataset["state"] = state;
        const chips = views.map((view) => {
            const kind = view.camera === "inside" ? "inside" : "cube";
            const chip = button(view.title, () => this.toggle(view), { icon: kind, hint: view.purpose, id: `chip-${view.id}` });
            chip.setAttribute("aria-pressed", String(this.isOpen(view)));
            return chip;
        });
        refill(this.chips, ...chips, this.measuring.opener);
    }

    /** Shares the room so that the shortest side of a pane is as long as it can be. */
    private arrange(): void {
        const { width, height } = this.grid.getBoundingClientRect();
        const count = Math.max(1, this.panes.size);
        let best = { columns: 1, side: 0 };
        for (let columns = 1; columns <= count; columns += 1) {
            const rows = Math.ceil(count / columns);
            // A row that is not full counts a little less.
            const side = Math.min(width / columns, height / rows) * (columns * rows === count ? 1 : 0.95);
            if (side > best.side * 1.001) {
                best = { columns, side };
            }
        }
        const rows = Math.ceil(count / best.columns);
        this.grid.style.gridTemplate = `repeat(${rows}, minmax(0, 1fr)) / repeat(${best.columns}, minmax(0, 1fr))`;
        this.tellSizes();
    }

    private tellSizes(): void {
        // Several panes change at once; they are told once.
        if (this.isTold) {
            return;
        }
        this.isTold = true;
        queueMicrotask(() => {
            this.isTold = false;
            const panes = this.list().flatMap((pane) => pane.declared() ?? []);
            this.core.tell("panes", { panes });
        });
    }
}
