// The sliders of the params: name, value, and what animates it.

import type { Core } from "./core.ts";
import { button, make, refill } from "./dom.ts";
import type { ComponentInfo, ParamInfo } from "./protocol.ts";

export class Sliders {
    readonly element = make("div", { class: "sliders" });
    private readonly rows = new Map<string, (component: ComponentInfo) => void>();
    private params: ParamInfo[] = [];
    private shape: string | undefined;

    /** `write` writes a param's value into the text, where there is one to be seen. */
    constructor(
        private readonly core: Core,
        private readonly write?: (param: string) => void,
    ) {}

    /** Takes the params with their values; returns how many sliders there are. */
    update(params: ParamInfo[]): number {
        this.params = params;
        const { animations } = this.core.settings;
        const shape = JSON.stringify(
            params.map((it) => [it.name, it.components.map((c) => [c.min, c.max]), animations?.[it.name]]),
        );
        if (shape !== this.shape) {
            this.shape = shape;
            this.rows.clear();
            const rows = params.flatMap((param) =>
                param.components.map((component, at) => this.param(param, component, at)),
            );
            const none = make(
                "p",
                { class: "empty" },
                "A param is a slider. Write ",
                make("code", {}, "param r : [0, 1];"),
                " and use ",
                make("code", {}, "r"),
                " below it.",
            );
            refill(this.element, ...(rows.length > 0 ? rows : [none]));
        }
        for (const param of params) {
            for (const [at, component] of param.components.entries()) {
                this.rows.get(`${param.name} ${at}`)?.(component);
            }
        }
        return this.rows.size;
    }

    private param(param: ParamInfo, { min, max }: ComponentInfo, at: number): HTMLElement {
        const { name } = param;
        const title = param.components.length > 1 ? `${name}_${at + 1}` : name;
        const id = `param-${name}-${at}`;
        const isOn = this.core.settings.animations?.[name]?.on?.[at] ?? false;
        const range = make("input", { type: "range", id, min: String(min), max: String(max), step: "any" });
        const number = make("input", { type: "text", inputMode: "decimal", class: "number", "aria-label": `Value of ${title}` });
        const set = (value: number) => {
            const chosen = this.core.settings.params?.[name] ?? [];
            const all = param.components.map((_, k) => (k === at ? value : (chosen[k] ?? null)));
            this.core.change({ params: { [name]: all } }, `param ${name}`);
        };
        range.addEventListener("input", () => {
            set(rounded(range.valueAsNumber, min, max));
            number.value = written(range.valueAsNumber);
        });
        // Steps by keys are one until the key is released, as those of a drag are.
        for (const event of ["change", "keyup", "blur"]) {
            range.addEventListener(event, () => this.core.tell("release", {}));
        }
        /** What was chosen last, which the scene may not have yet. */
        const chosen = () => (isOn ? undefined : this.core.settings.params?.[name]?.[at]) ?? undefined;
        // The keys of a slider: a hundredth of its range, not of its step.
        range.addEventListener("keydown", (event) => {
            const by = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
            if (by !== undefined) {
                event.preventDefault();
                range.valueAsNumber = (chosen() ?? range.valueAsNumber) + (by * (max - min)) / 100;
                range.dispatchEvent(new Event("input"));
            }
        });
        number.addEventListener("change", () => {
            const value = Number(number.value.replace(",", ".").replace("−", "-"));
            if (number.value.trim() !== "" && Number.isFinite(value)) {
                set(Math.min(max, Math.max(min, value)));
                this.core.tell("release", {});
            }
            number.blur();
        });
        number.addEventListener("blur", () => (number.value = written(range.valueAsNumber)));
        number.addEventListener("keydown", (event) => {
            if (event.key === "Enter") {
                number.dispatchEvent(new Event("change"));
            }
        });
        const animate = button(
            isOn ? `Stop ${title}` : `Animate ${title}`,
            () => {
                const on = param.components.map((_, k) => this.core.settings.animations?.[name]?.on?.[k] ?? false);
                on[at] = !isOn;
                this.core.change({ animations: { [name]: { on } } });
                this.update(this.params);
            },
            { icon: isOn ? "pause" : "animate", text: false, id: `animate-${name}-${at}` },
        );
        const { write } = this;
        const into = write && button(`Write ${title} into the program`, () => write(name), { icon: "code", text: false });
        this.rows.set(`${name} ${at}`, ({ value, initial }) => {
            const focused = (range.getRootNode() as Document | ShadowRoot).activeElement;
            // A scene that is older than the last key must not put the slider back.
            if (focused !== range || (chosen() ?? value) === value) {
                range.valueAsNumber = value;
            }
            if (focused !== number) {
                number.value = written(value);
            }
            if (into !== undefined) {
                into.disabled = value === initial;
            }
        });
        const label = make("label", { htmlFor: id }, title);
        return make("div", { class: "param" }, label, range, number, make("div", { class: "tools" }, animate, into));
    }
}

/** The value of a slider, with the decimals that distinguish ten thousand positions, as in the window. The ends are exact. */
function rounded(value: number, min: number, max: number): number {
    const step = Math.floor(Math.log10((max - min) / 10_000));
    if (!Number.isFinite(step) || value <= min || value >= max) {
        return value;
    }
    const near = step > 0 ? Math.round(value / 10 ** step) * 10 ** step : Number(value.toFixed(Math.min(-step, 100)));
    return Math.min(max, Math.max(min, near));
}

/** A number for a field: as many digits as tell values of a slider apart. */
export function written(value: number): string {
    return String(Number(value.toPrecision(4))).replace("-", "−");
}
