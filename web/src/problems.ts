// What is wrong with the program, at the foot of the editor: a click leads to the place, a button fixes it.

import { button, icon, make } from "./dom.ts";
import type { Shown } from "./editor.ts";
import { inline } from "./markdown.ts";
import type { Finding, Fix, TextRange } from "./protocol.ts";

export interface ProblemsEvents {
    /** A place is to be shown. */
    show(range: TextRange): void;
    /** A fix of the text as it was at a version is to be applied. */
    fix(fix: Fix, version: number): void;
}

export class Problems {
    readonly element = make("ul", { class: "problems", "aria-label": "Problems", hidden: true });
    /** How many there are, in words. */
    readonly count = make("span", { role: "status" });
    /** How many there are, where there is little room. */
    readonly badge = make("span", { class: "count", hidden: true });

    constructor(private readonly events: ProblemsEvents) {
        this.set([], []);
    }

    /** Lists what is wrong, and counts all of it. */
    set(findings: Shown[], all: Finding[]): void {
        const errors = all.filter((it) => it.severity === "error").length;
        const count = (number: number, word: string) => (number === 0 ? [] : [`${number} ${word}${number === 1 ? "" : "s"}`]);
        const listed = findings.length < all.length ? [`${findings.length} of them listed`] : [];
        const text = [...count(errors, "error"), ...count(all.length - errors, "warning"), ...listed].join(", ");
        this.count.textContent = text === "" ? "No problems" : text;
        this.count.className = errors > 0 ? "bad" : "";
        this.badge.hidden = all.length === 0;
        this.badge.textContent = String(all.length);
        this.element.hidden = all.length === 0;
        this.element.replaceChildren(...findings.map((finding) => this.row(finding)));
    }

    private row(finding: Shown): HTMLElement {
        const { line, column, message, hint, related, fix, severity, version } = finding;
        const go = make(
            "button",
            { type: "button", onclick: () => this.events.show(finding) },
            icon("error"),
            make("span", {}, inline(message)),
            make("span", { class: "place" }, `${line}:${column}`),
            hint !== null && make("span", { class: "help" }, inline(hint)),
        );
        const others = related.map(({ message: about, ...range }) =>
            make("button", { type: "button", class: "related", onclick: () => this.events.show(range) }, "↳ ", inline(about)),
        );
        const press = fix && button(fix.title.replaceAll("`", ""), () => this.events.fix(fix, version));
        return make("li", { class: severity }, go, ...others, press);
    }
}
