// The signature of the function whose arguments are being written, above the cursor.

import { Prec, StateEffect, StateField } from "@codemirror/state";
import { EditorView, keymap, showTooltip, type Tooltip, ViewPlugin, type ViewUpdate } from "@codemirror/view";
import type { Core } from "../core.ts";
import { make } from "../dom.ts";
import type { Signature } from "../protocol.ts";

const PAUSE = 80;
const shown = StateEffect.define<{ at: number; signature: Signature } | null>();

const field = StateField.define<Tooltip | null>({
    create: () => null,
    update(tooltip, transaction) {
        for (const effect of transaction.effects) {
            if (effect.is(shown)) {
                return effect.value && tooltipOf(effect.value.at, effect.value.signature);
            }
        }
        return tooltip && transaction.docChanged
            ? { ...tooltip, pos: transaction.changes.mapPos(tooltip.pos) }
            : tooltip;
    },
    provide: (own) => showTooltip.from(own),
});

function tooltipOf(at: number, { label, parameters, active, what }: Signature): Tooltip {
    return {
        pos: at,
        above: true,
        create: () => {
            const line = make("code");
            const range = parameters[Math.min(active, parameters.length - 1)];
            if (range === undefined) {
                line.append(label);
            } else {
                const strong = make("strong", { class: "active" }, label.slice(range.from, range.to));
                line.append(label.slice(0, range.from), strong, label.slice(range.to));
            }
            return { dom: make("div", { class: "tip" }, line, make("div", { class: "empty" }, what)) };
        },
    };
}

export function signatures(core: Core) {
    const plugin = ViewPlugin.define((view) => {
        let timer: ReturnType<typeof setTimeout> | undefined;
        const ask = async () => {
            const { doc, selection } = view.state;
            const at = selection.main.head;
            const signature = await core.call("signature", { at }).catch(() => null);
            if (view.state.doc === doc && view.state.selection.eq(selection)) {
                if (signature !== null || view.state.field(field) !== null) {
                    view.dispatch({ effects: shown.of(signature && { at, signature }) });
                }
            }
        };
        return {
            update(update: ViewUpdate) {
                const isTyping = update.docChanged && update.transactions.some((it) => it.isUserEvent("input"));
                const isOpen = update.state.field(field) !== null;
                // It opens while arguments are written, and follows the cursor until it leaves them.
                if (isTyping || (isOpen && (update.selectionSet || update.docChanged))) {
                    clearTimeout(timer);
                    timer = setTimeout(() => void ask(), PAUSE);
                }
            },
            destroy: () => clearTimeout(timer),
        };
    });
    const close = (view: EditorView) => {
        const isOpen = view.state.field(field) !== null;
        if (isOpen) {
            view.dispatch({ effects: shown.of(null) });
        }
        return isOpen;
    };
    return [field, plugin, Prec.high(keymap.of([{ key: "Escape", run: close }]))];
}
