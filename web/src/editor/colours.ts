// Colours by meaning: the core's semantic tokens of what is on the screen. Between an edit and the core's answer, the old
// ones move with the text.

import { type Range, StateEffect, StateField } from "@codemirror/state";
import { Decoration, type DecorationSet, EditorView, ViewPlugin, type ViewUpdate } from "@codemirror/view";
import type { Core } from "../core.ts";
import { TOKEN_MODIFIERS, TOKEN_TYPES, type Tokens } from "../protocol.ts";

const tokensOf = StateEffect.define<{ from: number; to: number; tokens: Tokens }>();

const field = StateField.define<DecorationSet>({
    create: () => Decoration.none,
    update(set, transaction) {
        let next = set.map(transaction.changes);
        for (const effect of transaction.effects) {
            if (effect.is(tokensOf)) {
                const { from, to, tokens } = effect.value;
                const add = marks(tokens, transaction.newDoc.length);
                next = next.update({ filter: (start, end) => end <= from || start >= to, add, sort: true });
            }
        }
        return next;
    },
    provide: (own) => EditorView.decorations.from(own),
});

const known = new Map<string, Decoration>();

function marks(tokens: Tokens, length: number): Range<Decoration>[] {
    const ranges: Range<Decoration>[] = [];
    for (let at = 0; at + 3 < tokens.length; at += 4) {
        const [from, to, type, bits] = [tokens[at]!, tokens[at + 1]!, tokens[at + 2]!, tokens[at + 3]!];
        if (from >= to || to > length) {
            continue;
        }
        const modifiers = TOKEN_MODIFIERS.filter((_, bit) => (bits >> bit) & 1);
        const name = [TOKEN_TYPES[type], ...modifiers].map((word) => `t-${word}`).join(" ");
        const mark = known.get(name) ?? Decoration.mark({ class: name });
        known.set(name, mark);
        ranges.push(mark.range(from, to));
    }
    return ranges;
}

/** Colours the text on the screen. */
export function colours(core: Core) {
    const plugin = ViewPlugin.define((view) => {
        let isAsking = false;
        let isStale = true;
        const ask = async () => {
            if (isAsking) {
                isStale = true;
                return;
            }
            isAsking = true;
            while (isStale) {
                isStale = false;
                const { from, to } = view.viewport;
                const { doc } = view.state;
                const tokens = await core.call("tokens", { from, to }).catch(() => undefined);
                if (tokens === undefined) {
                    break;
                }
                if (view.state.doc === doc) {
                    view.dispatch({ effects: tokensOf.of({ from, to, tokens }) });
                } else {
                    isStale = true;
                }
            }
            isAsking = false;
        };
        const again = () => {
            isStale = true;
            void ask();
        };
        // The program is opened by whoever made this state, after it.
        setTimeout(again);
        return {
            update(update: ViewUpdate) {
                if (update.docChanged || update.viewportChanged) {
                    again();
                }
                if (update.transactions.some((it) => it.effects.some((effect) => effect.is(recolour)))) {
                    setTimeout(again);
                }
            },
        };
    });
    return [field, plugin];
}

/** Asks for all colours again: the core has another text. */
export const recolour = StateEffect.define<null>();
