// The little Markdown that the core's descriptions are written in: code, emphasis, links, lists. Everything else is text,
// so no description can bring elements of its own.

import { make } from "./dom.ts";
import type { Description } from "./protocol.ts";

const INLINE = /`([^`]+)`|\*\*([^*]+)\*\*|\*([^*\s][^*]*)\*|_([^_\s][^_]*)_(?!\w)|\[([^\]]+)\]\((https?:[^)\s]+)\)/g;

/** Returns a line of Markdown as elements. */
export function inline(text: string): DocumentFragment {
    const fragment = document.createDocumentFragment();
    let at = 0;
    for (const match of text.matchAll(INLINE)) {
        const [whole, code, strong, star, under, label, address] = match;
        fragment.append(text.slice(at, match.index));
        at = match.index + whole.length;
        if (code !== undefined) {
            fragment.append(make("code", {}, code));
        } else if (strong !== undefined) {
            fragment.append(make("strong", {}, strong));
        } else if (label !== undefined) {
            fragment.append(make("a", { href: address, target: "_blank", rel: "noreferrer" }, label));
        } else {
            fragment.append(make("em", {}, star ?? under));
        }
    }
    fragment.append(text.slice(at));
    return fragment;
}

/** Returns a description as an element. */
export function described({ code, text }: Description): HTMLElement {
    const element = make("div", { class: "tip" });
    if (code !== "") {
        element.append(make("pre", {}, code));
    }
    for (const paragraph of text) {
        const lines = paragraph.split("\n");
        if (lines.every((line) => /^\s*[-*] /.test(line))) {
            const items = lines.map((line) => make("li", {}, inline(line.replace(/^\s*[-*] /, ""))));
            element.append(make("ul", {}, ...items));
        } else {
            element.append(make("p", {}, inline(paragraph)));
        }
    }
    return element;
}
