// The lines between the panes: they are dragged, or moved by the arrows, and remembered.

import { make } from "./dom.ts";

const KEY = "geotrace.layout";
const STEP = 24;

function kept(): { column?: number; settings?: number } {
    try {
        return JSON.parse(localStorage.getItem(KEY) ?? "{}") as object;
    } catch {
        return {};
    }
}

function keep(part: { column?: number; settings?: number }): void {
    try {
        localStorage.setItem(KEY, JSON.stringify({ ...kept(), ...part }));
    } catch {
        // Without storage, the next visit begins as the first one.
    }
}

/** Puts a line between the column and the pictures, and one between the program and the settings. */
export function columns(panes: HTMLElement, column: HTMLElement, program: HTMLElement): void {
    const wide = line("vertical", "Width of the program", (by, from) => {
        const most = panes.clientWidth - 240;
        return Math.max(240, Math.min(most, from + by));
    });
    wide.element.addEventListener("resize-to", (event) => {
        const width = (event as CustomEvent<number>).detail;
        panes.style.setProperty("--column", `${width}px`);
        keep({ column: width });
    });
    wide.measure = () => column.clientWidth;
    column.after(wide.element);
    const high = line("horizontal", "Height of the settings", (by, from) => {
        const most = column.clientHeight - 140;
        return Math.max(90, Math.min(most, from - by));
    });
    high.element.addEventListener("resize-to", (event) => {
        const height = (event as CustomEvent<number>).detail;
        column.style.setProperty("--settings", `${height}px`);
        keep({ settings: height });
    });
    high.measure = () => column.lastElementChild?.clientHeight ?? 0;
    program.after(high.element);
    const told = new ResizeObserver(() => {
        wide.tell(panes.clientWidth);
        high.tell(column.clientHeight);
    });
    told.observe(column);
    told.observe(program);
    const { column: width, settings: height } = kept();
    if (typeof width === "number") {
        panes.style.setProperty("--column", `min(${width}px, calc(100vw - 245px))`);
    }
    if (typeof height === "number") {
        column.style.setProperty("--settings", `min(${height}px, 70%)`);
    }
}

function line(orientation: "vertical" | "horizontal", label: string, place: (by: number, from: number) => number) {
    const element = make("div", {
        class: "splitter",
        role: "separator",
        tabIndex: 0,
        "aria-orientation": orientation,
        "aria-label": label,
    });
    const result = {
        element,
        measure: () => 0,
        /** Tells a screen reader where the line stands, in percent. */
        tell: (whole: number) => element.setAttribute("aria-valuenow", String(Math.round((100 * result.measure()) / whole) || 0)),
    };
    const to = (value: number) => element.dispatchEvent(new CustomEvent("resize-to", { detail: Math.round(value) }));
    element.addEventListener("pointerdown", (down) => {
        element.setPointerCapture(down.pointerId);
        const from = result.measure();
        const move = (event: PointerEvent) => {
            const by = orientation === "vertical" ? event.clientX - down.clientX : event.clientY - down.clientY;
            to(place(by, from));
        };
        element.addEventListener("pointermove", move);
        element.addEventListener("lostpointercapture", () => element.removeEventListener("pointermove", move), { once: true });
    });
    element.addEventListener("keydown", (event) => {
        const [less, more] = orientation === "vertical" ? ["ArrowLeft", "ArrowRight"] : ["ArrowUp", "ArrowDown"];
        const by = event.key === less ? -STEP : event.key === more ? STEP : 0;
        if (by !== 0) {
            event.preventDefault();
            to(place(by, result.measure()));
        }
    });
    return result;
}
