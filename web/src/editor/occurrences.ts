// The other places of the name at the cursor are set off, after a short pause.

import { StateEffect, StateField } from "@codemirror/state";
import { Decoration, type DecorationSet, EditorView, ViewPlugin, type ViewUpdate } from "@codemirror/view";
import type { Core } from "../core.ts";
import type { Occurrence } from "../protocol.ts";

const PAUSE = 200;
const found = StateEffect.define<Occurrence[]>();
const mark = Decoration.mark({ class: "cm-occurrence" });

const field = StateField.define<DecorationSet>({
    create: () => Decoration.none,
    update(set, transaction) {
        const effect = transaction.effects.find((it) => it.is(found));
        if (effect !== undefined) {
            const ranges = (effect.value as Occurrence[]).filter(({ from, to }) => from < to && to <= transaction.newDoc.length);
            return Decoration.set(
                ranges.map(({ from, to }) => mark.range(from, to)),
                true,
            );
        }
        return transaction.docChanged || transaction.selection ? Decoration.none : set;
    },
    provide: (own) => EditorView.decorations.from(own),
});

export function occurrences(core: Core) {
    const plugin = ViewPlugin.define((view) => {
        let timer: ReturnType<typeof setTimeout> | undefined;
        const ask = async () => {
            const { doc, selection } = view.state;
            if (!selection.main.empty || !view.hasFocus) {
                return;
            }
            const list = await core.call("occurrences", { at: selection.main.head }).catch(() => []);
            if (list.length > 1 && view.state.doc === doc && view.state.selection.eq(selection)) {
                view.dispatch({ effects: found.of(list) });
            }
        };
        return {
            update(update: ViewUpdate) {
                if (update.selectionSet || update.docChanged) {
                    clearTimeout(timer);
                    timer = setTimeout(() => void ask(), PAUSE);
                }
            },
            destroy: () => clearTimeout(timer),
        };
    });
    return [field, plugin];
}
