// A pane: the picture of one view, drawn by the Worker, and the keys, pointer and fingers that move its camera.
//
// Places and ways are in the pixels that the pane declares. A drag that stays within some pixels is a click. Keys count
// only while the pane has the focus.

import type { Core } from "./core.ts";
import { make } from "./dom.ts";
import { inline } from "./markdown.ts";
import type { CameraMove, Grip, CameraKey, Pane as Declared, Pick, Picture, ViewInfo } from "./protocol.ts";

/** A drag up to this length is a click, in CSS pixels. */
const CLICK = 5;
/** Two clicks within this time are a double click, in milliseconds. */
const DOUBLE = 350;
/** The natural logarithm of the distance for a CSS pixel of the wheel, and of a pinch on a touchpad. */
const WHEEL = 0.0015;
const PINCH = 0.01;
/** The wheel rests after this pause, in milliseconds. */
const REST = 180;
/** The most pixels that a pane has: more make a picture slower, and hardly finer. */
const MOST_PIXELS = 2_400_000;
const MOST_RATIO = 2;
const LONGEST_SIDE = 4096;
/** A little less than a frame, in milliseconds. */
const FRAME = 14;

const KEYS: Record<string, CameraKey> = {
    KeyW: "w",
    KeyA: "a",
    KeyS: "s",
    KeyD: "d",
    KeyQ: "q",
    KeyE: "e",
    KeyZ: "z",
    KeyX: "x",
    ArrowLeft: "left",
    ArrowRight: "right",
    ArrowUp: "up",
    ArrowDown: "down",
    Equal: "plus",
    NumpadAdd: "plus",
    Minus: "minus",
    NumpadSubtract: "minus",
};

/** Looks from the front, the right, the top; with Shift from the other side, also with Ctrl where the browser leaves it. */
const AXES: Record<string, [CameraMove, CameraMove]> = {
    Digit1: ["-y", "+y"],
    Digit3: ["+x", "-x"],
    Digit7: ["+z", "-z"],
    Numpad1: ["-y", "+y"],
    Numpad3: ["+x", "-x"],
    Numpad7: ["+z", "-z"],
};

export interface PaneEvents {
    /** What is under the pointer, or nothing. */
    pointed(pick: Pick | null): void;
    /** The declaration of what is seen there is wanted. */
    declaration(pick: Pick | null): void;
    /** The pane has the focus. */
    focused(): void;
    /** It has another size. */
    resized(): void;
    /** Clicks are places to be measured. */
    isMeasuring?(): boolean;
    /** A place to be measured was clicked on. */
    measured?(pick: Pick | null): void;
    /** A key that is the page's. */
    key(key: "measure" | "traced" | "orthographic" | "next" | "previous" | "undo" | "redo"): void;
    /** Something cannot be done, as a sentence. */
    say(message: string): void;
    /** A drag turns the camera where it stands (`Preferences.fly`). */
    isFlying(): boolean;
    /** The reader moves the camera. */
    moved?(): void;
    /** How long the Worker may wait until it draws this pane again, in milliseconds: another one is worth more. */
    delay?(): number;
}

export class Pane {
    readonly element: HTMLElement;
    readonly canvas = make("canvas", { tabIndex: 0, role: "application" });
    /** Buttons on the picture. */
    readonly tools = make("div", { class: "tools" });
    /** The last picture. */
    picture: Picture | undefined;
    private readonly title = make("div", { class: "title" });
    private readonly say = make("div", { class: "say", role: "status" });
    private readonly notice = make("div", { class: "notice" });
    private readonly busy = make("div", { class: "busy", hidden: true });
    private readonly context = this.canvas.getContext("2d", { alpha: false });
    private readonly resize = new ResizeObserver(() => this.events.resized());
    private readonly held = new Map<string, CameraKey>();
    private readonly fingers = new Map<number, { x: number; y: number }>();
    private grip: Grip | undefined;
    private way = 0;
    private hadTwo = false;
    private clicked = 0;
    private wheel: ReturnType<typeof setTimeout> | undefined;
    private isPicking = false;
    private pending: Picture | undefined;
    private drawn = 0;
    private hasMoved = false;

    constructor(
        public info: ViewInfo,
        private readonly core: Core,
        private readonly events: PaneEvents,
    ) {
        const ring = make("div", { class: "ring" });
        this.element = make(
            "section",
            { class: "view", "data-view": info.id },
            this.canvas,
            ring,
            this.notice,
            this.title,
            this.tools,
            this.say,
            this.busy,
        );
        this.update(info);
        this.listen();
        this.resize.observe(this.element);
    }

    /** Keys that move the camera are held. */
    get isHeld(): boolean {
        return this.held.size > 0;
    }

    get isInside(): boolean {
        return this.info.camera === "inside";
    }

    /** Takes what the scene says of the view. */
    update(info: ViewInfo): void {
        this.info = info;
        this.title.textContent = info.title;
        const keys = this.isInside
            ? "Drag to move, wheel to zoom, W A S D to walk, Q E to turn."
            : "Drag to turn, wheel to zoom, right drag to pan. Click to stand there.";
        this.canvas.setAttribute("aria-label", `${info.title}. ${keys}`);
        this.hint();
    }

    /** The pane as the Worker is told of it, if it is on the screen. */
    declared(): Declared | undefined {
        const { width, height } = this.canvas.getBoundingClientRect();
        if (width < 8 || height < 8) {
            return undefined;
        }
        const ratio = this.ratio(width, height);
        const side = (length: number) => Math.min(LONGEST_SIDE, Math.max(1, Math.round(length * ratio)));
        return { view: this.info.id, width: side(width), height: side(height) };
    }

    /** Puts a picture on the screen: at once, so that the Worker begins with the next one, or when the page is seen again. */
    show(picture: Picture): void {
        const isFirst = this.pending === undefined;
        this.pending = picture;
        // More pictures than frames would only keep the machine busy.
        if (!document.hidden && performance.now() - this.drawn > FRAME) {
            this.draw();
        } else if (isFirst) {
            requestAnimationFrame(() => this.draw());
        }
    }

    /** Says why there is no picture. */
    refuse(message: string): void {
        if (this.pending !== undefined) {
            // It waits for its frame, and would be drawn over the sentence. The Worker waits until it is taken.
            this.pending = undefined;
            this.core.tell("shown", { view: this.info.id });
        }
        this.notice.replaceChildren(make("p", {}, inline(message)));
        this.canvas.style.visibility = "hidden";
        this.picture = undefined;
    }

    setBusy(isBusy: boolean): void {
        this.busy.hidden = !isBusy;
    }

    end(): void {
        this.releaseAll();
        this.resize.disconnect();
        this.element.remove();
    }

    private ratio(width: number, height: number): number {
        const most = Math.sqrt(MOST_PIXELS / (width * height));
        return Math.min(globalThis.devicePixelRatio || 1, MOST_RATIO, most);
    }

    private draw(): void {
        const picture = this.pending;
        this.pending = undefined;
        if (picture === undefined || this.context === null) {
            return;
        }
        const { width, height } = picture;
        if (this.canvas.width !== width || this.canvas.height !== height) {
            this.canvas.width = width;
            this.canvas.height = height;
        }
        const pixels = new Uint8ClampedArray(picture.pixels);
        this.context.putImageData(new ImageData(pixels, width, height), 0, 0);
        this.canvas.style.visibility = "";
        this.picture = picture;
        this.drawn = performance.now();
        this.notice.textContent = "";
        this.element.dataset["exact"] = String(picture.exact);
        this.element.dataset["version"] = String(picture.version);
        this.hint();
        const { id } = this.info;
        const delay = this.events.delay?.() ?? 0;
        if (delay > 0) {
            setTimeout(() => this.core.tell("shown", { view: id }), delay);
        } else {
            this.core.tell("shown", { view: id });
        }
        this.element.dispatchEvent(new CustomEvent("picture", { detail: picture }));
    }

    /** Says faintly what the picture lacks, else what the pointer does, to those who have not moved the camera yet. */
    private hint(): void {
        const note = this.picture?.notes[0];
        const samples = this.picture?.samples;
        const refining = samples && samples[0] < samples[1] ? `${samples[0]} of ${samples[1]} samples` : undefined;
        const isTouch = matchMedia("(pointer: coarse)").matches;
        const start = this.isInside
            ? isTouch ? "drag to walk, pinch to zoom" : "drag to walk, wheel to zoom"
            : isTouch ? "drag to turn, pinch to zoom" : "drag to turn, wheel to zoom, F to fit";
        this.say.replaceChildren(inline(note ?? refining ?? (this.hasMoved ? "" : start)));
    }

    private moved(): void {
        this.events.moved?.();
        if (!this.hasMoved) {
            this.hasMoved = true;
            this.hint();
        }
    }

    /** A place of the screen in the pixels of the pane. */
    private place(event: { clientX: number; clientY: number }): [number, number] {
        const { left, top, width, height } = this.canvas.getBoundingClientRect();
        const ratio = this.ratio(width, height);
        return [(event.clientX - left) * ratio, (event.clientY - top) * ratio];
    }

    private by(x: number, y: number): [number, number] {
        const { width, height } = this.canvas.getBoundingClientRect();
        const ratio = this.ratio(width, height);
        return [x * ratio, y * ratio];
    }

    private middle(): [number, number] {
        const { left, top, width, height } = this.canvas.getBoundingClientRect();
        return this.place({ clientX: left + width / 2, clientY: top + height / 2 });
    }

    private listen(): void {
        const { canvas } = this;
        canvas.addEventListener("pointerdown", (event) => this.down(event));
        canvas.addEventListener("pointermove", (event) => this.move(event));
        canvas.addEventListener("pointerup", (event) => this.up(event, true));
        canvas.addEventListener("pointercancel", (event) => this.up(event, false));
        canvas.addEventListener("pointerleave", () => this.events.pointed(null));
        canvas.addEventListener("contextmenu", (event) => event.preventDefault());
        canvas.addEventListener("wheel", (event) => this.turnWheel(event), { passive: false });
        canvas.addEventListener("keydown", (event) => this.press(event));
        canvas.addEventListener("keyup", (event) => this.releaseKey(event));
        canvas.addEventListener("blur", () => this.releaseAll());
        canvas.addEventListener("focus", () => this.events.focused());
    }

    private down(event: PointerEvent): void {
        // A picture takes the focus from the editor, so that keys move its camera.
        this.canvas.focus({ preventScroll: true });
        event.preventDefault();
        this.canvas.setPointerCapture(event.pointerId);
        this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        if (this.fingers.size === 1) {
            this.way = 0;
            this.hadTwo = false;
            this.grip = event.button === 0 ? this.gripOf(event) : "pan";
        } else {
            this.hadTwo = true;
        }
    }

    private gripOf(event: PointerEvent): Grip {
        if (event.shiftKey) {
            return "pan";
        }
        return event.altKey === this.events.isFlying() ? "orbit" : "look";
    }

    private move(event: PointerEvent): void {
        const finger = this.fingers.get(event.pointerId);
        if (finger === undefined) {
            if (event.pointerType !== "touch") {
                void this.point(event);
            }
            return;
        }
        const view = this.info.id;
        const [x, y] = [event.clientX - finger.x, event.clientY - finger.y];
        if (this.fingers.size === 1) {
            this.way += Math.hypot(x, y);
            // A hand is not steady: what stays a click moves nothing.
            if (this.way <= CLICK && !this.hadTwo) {
                return;
            }
            this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
            this.core.tell("drag", { view, grip: this.grip ?? "orbit", by: this.by(x, y) });
        } else {
            const before = this.pair();
            this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
            const after = this.pair();
            if (before === undefined || after === undefined) {
                return;
            }
            const by = this.by(after.x - before.x, after.y - before.y);
            this.core.tell("drag", { view, grip: "pan", by });
            const at = this.place({ clientX: after.x, clientY: after.y });
            if (before.apart > 1 && after.apart > 1) {
                this.core.tell("zoom", { view, at, factor: before.apart / after.apart });
            }
            const turn = Math.atan2(Math.sin(after.angle - before.angle), Math.cos(after.angle - before.angle));
            if (this.isInside && turn !== 0) {
                this.core.tell("twist", { view, angle: turn });
            }
        }
        this.moved();
    }

    /** The middle of two fingers, their distance and the angle between them. */
    private pair(): { x: number; y: number; apart: number; angle: number } | undefined {
        const [one, two] = [...this.fingers.values()];
        if (one === undefined || two === undefined) {
            return undefined;
        }
        const [x, y] = [two.x - one.x, two.y - one.y];
        return { x: (one.x + two.x) / 2, y: (one.y + two.y) / 2, apart: Math.hypot(x, y), angle: Math.atan2(y, x) };
    }

    private up(event: PointerEvent, isClick: boolean): void {
        if (!this.fingers.delete(event.pointerId)) {
            return;
        }
        if (this.fingers.size > 0) {
            return;
        }
        this.core.tell("release", {});
        if (isClick && !this.hadTwo && this.way <= CLICK && event.button === 0) {
            const isDouble = performance.now() - this.clicked < DOUBLE;
            this.clicked = isDouble ? 0 : performance.now();
            const isControl = event.ctrlKey || event.metaKey;
            void this.click(this.place(event), isDouble ? "double" : isControl ? "control" : "single");
        }
    }

    private async click(at: [number, number], kind: "single" | "double" | "control"): Promise<void> {
        const view = this.info.id;
        try {
            if (kind !== "control" && this.events.isMeasuring?.()) {
                this.events.measured?.(await this.core.call("pick", { view, at, measures: true }));
            } else if (kind !== "single") {
                const call = kind === "double" ? "doubleClick" : "pick";
                this.events.declaration(await this.core.call(call, { view, at }));
            } else if (!this.isInside) {
                const clicked = await this.core.call("click", { view, at });
                this.events.pointed(clicked?.pick ?? null);
            }
        } catch (error) {
            this.events.say((error as Error).message);
        }
    }

    private async point(event: PointerEvent): Promise<void> {
        if (this.isPicking || this.picture === undefined) {
            return;
        }
        this.isPicking = true;
        const pick = await this.core.call("pick", { view: this.info.id, at: this.place(event) }).catch(() => null);
        this.events.pointed(pick);
        setTimeout(() => (this.isPicking = false), 60);
    }

    private turnWheel(event: WheelEvent): void {
        event.preventDefault();
        const view = this.info.id;
        const at = this.place(event);
        const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 34 : 1;
        const [x, y] = [event.deltaX * lines, event.deltaY * lines];
        if (event.ctrlKey) {
            this.core.tell("zoom", { view, at, factor: Math.exp(y * PINCH) });
        } else if (isTouchpad(event)) {
            this.core.tell("drag", { view, grip: "pan", by: this.by(-x, -y) });
        } else if (y !== 0) {
            this.core.tell("zoom", { view, at, factor: Math.exp(y * WHEEL) });
        }
        this.moved();
        clearTimeout(this.wheel);
        this.wheel = setTimeout(() => this.core.tell("release", {}), REST);
    }

    /** Takes a key of the page, if it is a view's; the page gives those that nothing has the focus for. */
    press(event: KeyboardEvent): void {
        if (this.command(event)) {
            event.preventDefault();
            return;
        }
        const key = motion(event);
        if (key === undefined || event.ctrlKey || event.metaKey) {
            this.hold(event);
            return;
        }
        event.preventDefault();
        this.held.set(event.code, key);
        this.moved();
        this.hold(event);
    }

    releaseKey(event: KeyboardEvent): void {
        const had = this.held.size > 0;
        this.held.delete(event.code);
        // A system keeps the release of a key to itself while Command is held.
        if (event.key === "Meta") {
            this.held.clear();
        }
        if (had) {
            this.hold(event);
        }
    }

    releaseAll(): void {
        if (this.held.size > 0) {
            this.held.clear();
            this.core.tell("hold", { view: this.info.id, keys: [], shift: false, alt: false });
            this.core.tell("release", {});
        }
    }

    private hold(event: KeyboardEvent): void {
        if (event.repeat) {
            return;
        }
        const isMoving = this.held.size > 0;
        if (isMoving || event.type === "keyup") {
            const keys = [...new Set(this.held.values())];
            const plus = event.code === "Equal" || this.held.has("Equal");
            // Where + is Shift and =, Shift means nothing else.
            this.core.tell("hold", { view: this.info.id, keys, shift: event.shiftKey && !plus, alt: event.altKey });
        }
        if (!isMoving) {
            this.core.tell("release", {});
        }
    }

    private command(event: KeyboardEvent): boolean {
        const view = this.info.id;
        const isControl = event.ctrlKey || event.metaKey;
        if (isControl && letter(event) === "z" && !event.altKey) {
            this.events.key(event.shiftKey ? "redo" : "undo");
            return true;
        }
        if (isControl && letter(event) === "y") {
            this.events.key("redo");
            return true;
        }
        if (event.key === "F6") {
            this.events.key(event.shiftKey ? "previous" : "next");
            return true;
        }
        if (event.key === "Enter") {
            void this.click(this.middle(), isControl ? "control" : "single");
            return true;
        }
        const axis = AXES[event.code];
        if (axis !== undefined && !this.isInside && !event.altKey) {
            this.core.tell("camera", { view, move: axis[isControl || event.shiftKey ? 1 : 0] });
            this.core.tell("release", {});
            return true;
        }
        if (isControl || event.altKey || event.shiftKey) {
            return false;
        }
        if (event.code === "Digit5" || event.code === "Numpad5") {
            this.events.key("orthographic");
            return true;
        }
        // A key whose place moves the camera does so whatever is written on it.
        switch (motion(event) === undefined ? letter(event) : undefined) {
            case "r":
                this.core.tell("camera", { view, move: "reset" });
                this.core.tell("release", {});
                return true;
            case "f":
                if (!this.isInside) {
                    this.core.tell("camera", { view, move: "frame" });
                    this.core.tell("release", {});
                }
                return !this.isInside;
            case "m":
                this.events.key("measure");
                return true;
            case "t":
                this.events.key("traced");
                return true;
            default:
                return false;
        }
    }
}

/** Returns the letter on a key; where there is no Latin one, that of its place on an American keyboard. */
export function letter({ key, code }: KeyboardEvent): string {
    return (/^[a-z]$/i.test(key) ? key : code.replace(/^Key/, "")).toLowerCase();
}

/** The key of the camera that a key of the keyboard is, by its place; plus and minus by what is written on them too. */
function motion(event: KeyboardEvent): CameraKey | undefined {
    if (event.key === "+" || event.key === "-") {
        return event.key === "+" ? "plus" : "minus";
    }
    return KEYS[event.code];
}

/** A wheel turns by whole notches; two fingers on a touchpad do not, or move sideways as well. */
function isTouchpad(event: WheelEvent): boolean {
    const notch = (event as WheelEvent & { wheelDeltaY?: number }).wheelDeltaY;
    const isWhole = notch === undefined || notch % 120 === 0;
    return event.deltaMode === WheelEvent.DOM_DELTA_PIXEL && (event.deltaX !== 0 || !isWhole) && !event.shiftKey;
}
