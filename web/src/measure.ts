// Measuring: a kind of figure is chosen, places of a surface are clicked on in any picture, and what is measured of them
// stands here and is drawn on the surface. It follows the params and the text. A walk has no places: it is measured as the
// camera goes on.

import type { Core } from "./core.ts";
import { button, make } from "./dom.ts";
import type { Figure, Measured, Pick, Scene } from "./protocol.ts";

const KINDS = [
    { kind: "place", label: "Place", places: 1, hint: "Click on a point of a surface, in any picture." },
    { kind: "distance", label: "Distance", places: 2, hint: "Click on two points of a surface, in any picture." },
    { kind: "circle", label: "Circle", places: 1, hint: "Click on a point: the circle about the geodesic camera passes through it." },
    { kind: "triangle", label: "Triangle", places: 3, hint: "Click on the three corners, in any picture." },
    { kind: "walk", label: "Walk", places: 0, hint: "Drag the picture from inside, or hold the arrow keys in it: the path is measured." },
] as const;

type Kind = (typeof KINDS)[number];

export class Measuring {
    readonly element: HTMLElement;
    /** Opens and closes it. */
    readonly opener: HTMLButtonElement;
    private readonly kinds = new Map<Kind, HTMLButtonElement>();
    private readonly note = make("p", { role: "status" });
    private readonly rows = make("dl");
    private readonly back = button("Close the walk", () => void this.walkBack(), {
        hint: "Walks along the shortest geodesic to the start of the walk",
    });
    private kind: Kind = KINDS[1];
    private figure: Figure | undefined;
    /** The state that was asked for last. */
    private asked = "";
    private isAsking = false;
    private scene: Scene | undefined;

    constructor(private readonly core: Core) {
        for (const kind of KINDS) {
            this.kinds.set(kind, button(kind.label, () => this.choose(kind)));
        }
        const close = button("Close measuring", () => this.toggle(), { icon: "close", text: false });
        const bar = make("div", { role: "toolbar", "aria-label": "Figures" }, ...this.kinds.values(), close);
        this.element = make("section", { class: "measuring", "aria-label": "Measure", hidden: true }, bar, this.note, this.rows, this.back);
        this.element.addEventListener("keydown", (event) => event.key === "Escape" && this.toggle());
        this.opener = button("Measure", () => this.toggle(), { icon: "ruler", kind: "opener", hint: "Distances, circles, triangles and walks on a surface (M)" });
        this.choose(this.kind);
    }

    get isOpen(): boolean {
        return !this.element.hidden;
    }

    /** Clicks are places to be measured. */
    get takesPlaces(): boolean {
        return this.isOpen && this.kind.kind !== "walk";
    }

    /** Opens it, or closes it with all that was measured. */
    toggle(): void {
        this.element.hidden = this.isOpen;
        this.opener.setAttribute("aria-pressed", String(this.isOpen));
        this.clear();
        this.begin();
    }

    /** Takes a place that was clicked on. A figure that has all its places, or is on another surface, gives way to a new one. */
    take(pick: Pick | null): void {
        const [u, v] = pick?.parameters ?? [];
        if (pick === null || u === undefined || v === undefined || !["surface", "metric"].includes(pick.kind)) {
            this.note.textContent = `That is not a point of a surface. ${this.kind.hint}`;
            return;
        }
        const { kind, places: needed } = this.kind;
        if (kind === "walk") {
            return;
        }
        const begun = this.figure;
        const goesOn = begun?.surface === pick.object && begun.places.length < needed;
        this.figure = { surface: pick.object, kind, places: [...(goesOn ? begun.places : []), [u, v]] };
        void this.ask();
    }

    /** Takes the scene, or other params. */
    update(scene: Scene): void {
        this.scene = scene;
        void this.ask();
    }

    private choose(kind: Kind): void {
        this.kind = kind;
        for (const [other, press] of this.kinds) {
            press.setAttribute("aria-pressed", String(other === kind));
        }
        this.clear();
        this.begin();
    }

    /** A walk is measured from where its trail begins: it is shown from now on. */
    private begin(): void {
        this.back.hidden = this.kind.kind !== "walk";
        if (this.isOpen && this.kind.kind === "walk") {
            if (this.core.settings.preferences?.marks?.trail !== true) {
                this.core.change({ preferences: { marks: { trail: true } } }, "trail");
            }
            void this.ask();
        }
    }

    private async walkBack(): Promise<void> {
        try {
            await this.core.call("walkBack", {});
        } catch (error) {
            this.note.textContent = (error as Error).message;
        }
    }

    private clear(): void {
        if (this.figure !== undefined) {
            this.figure = undefined;
            void this.core.call("measure", { figure: null }).catch(() => {});
        }
        this.asked = "";
        this.note.textContent = this.kind.hint;
        this.rows.replaceChildren();
    }

    /** All that the measures depend on. */
    private state(): string {
        const { params, inside } = this.core.settings;
        const place = this.kind.kind === "walk" ? inside : this.figure;
        return JSON.stringify([this.kind.kind, place, this.scene?.version, params]);
    }

    /** Asks for the measures, unless they are known. While an answer is awaited, only the last state is asked for. */
    private async ask(): Promise<void> {
        const { figure, kind } = this;
        const isWalk = kind.kind === "walk" && this.isOpen;
        const state = this.state();
        if ((figure === undefined && !isWalk) || this.isAsking || state === this.asked) {
            return;
        }
        this.asked = state;
        this.isAsking = true;
        let answer: Measured | string;
        try {
            answer = await (figure === undefined ? this.core.call("measureWalk", {}) : this.core.call("measure", { figure }));
        } catch (error) {
            answer = (error as Error).message;
        }
        this.isAsking = false;
        if (this.figure === figure && this.kind === kind && this.isOpen) {
            const isCurrent = this.state() === state;
            this.show(figure, answer);
            if (isCurrent) {
                this.asked = this.state();
            }
        }
        void this.ask();
    }

    private show(figure: Figure | undefined, answer: Measured | string): void {
        if (typeof answer === "string") {
            this.note.textContent = answer;
            this.rows.replaceChildren();
            return;
        }
        const missing = this.kind.places - (figure?.places.length ?? 0);
        const more = missing === 1 ? "Click on one more point." : `Click on ${missing} more points.`;
        const nothing = answer.rows.length === 0 ? this.kind.hint : "";
        this.note.textContent = missing > 0 ? more : (answer.note ?? nothing);
        this.rows.replaceChildren(
            ...answer.rows.map(({ name, value }) => make("div", {}, make("dt", {}, name), make("dd", {}, value))),
        );
        if (missing <= 0 && figure !== undefined) {
            // The centre of a circle is where the camera was, also when that has gone on.
            this.figure = { ...figure, places: answer.places };
        }
    }
}
