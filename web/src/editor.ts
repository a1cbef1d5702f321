// The editor: CodeMirror, which knows no language; colours, mistakes, words and names are asked of the core.
//
// In: the text and what the core says of it. Out: edits, in order, each with a version. Positions are UTF-16 offsets on
// both sides.

import {
    acceptCompletion,
    autocompletion,
    closeBrackets,
    closeBracketsKeymap,
    closeCompletion,
    completionStatus,
    type CompletionContext,
    type CompletionResult,
    moveCompletionSelection,
    selectedCompletion,
    snippet,
} from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, indentLess, insertTab, toggleLineComment } from "@codemirror/commands";
import { bracketMatching, indentUnit } from "@codemirror/language";
import { type Diagnostic, setDiagnostics } from "@codemirror/lint";
import { highlightSelectionMatches, openSearchPanel, search, searchKeymap } from "@codemirror/search";
import { Compartment, EditorSelection, EditorState, Prec, Transaction } from "@codemirror/state";
import {
    drawSelection,
    dropCursor,
    EditorView,
    highlightActiveLine,
    highlightActiveLineGutter,
    hoverTooltip,
    keymap,
    lineNumbers,
    placeholder,
} from "@codemirror/view";
import type { Core } from "./core.ts";
import { colours } from "./editor/colours.ts";
import { occurrences } from "./editor/occurrences.ts";
import { signatures } from "./editor/signature.ts";
import { described } from "./markdown.ts";
import type { Completion, CompletionKind, Finding, Fix, TextEdit, TextRange } from "./protocol.ts";

/** The pause after the last key until mistakes are shown, in milliseconds. */
const PAUSE = 500;
/** The number of mistakes that are shown, and that fixes are asked for. */
const SHOWN = 200;
const FIXED = 20;

/** A mistake with its place for people, from 1, and the fix that may be applied without asking. */
export interface Shown extends Finding {
    line: number;
    column: number;
    fix: Fix | undefined;
    /** The version of the text that it belongs to. */
    version: number;
}

export interface EditorEvents {
    /** The text has changed; `isByHand` if the reader did it. */
    changed(isByHand: boolean): void;
    /** Of all that is wrong, what is listed is shown. */
    shown(findings: Shown[], all: Finding[]): void;
    /** Something cannot be done, as a sentence. */
    say(message: string): void;
    /** A name is to be replaced; returns the new one, or nothing. */
    askName(old: string): Promise<string | undefined>;
}

export class Editor {
    readonly view: EditorView;
    /** The number of the text: it grows with each edit. */
    version = 0;
    private readonly comment = new Compartment();
    private readonly mode = new Compartment();
    private edited = 0;
    private timer: ReturnType<typeof setTimeout> | undefined;

    constructor(
        parent: HTMLElement,
        private readonly core: Core,
        private readonly events: EditorEvents,
    ) {
        this.view = new EditorView({ parent, state: this.state("") });
    }

    get text(): string {
        return this.view.state.doc.toString();
    }

    /** Shows another program. Its undo does not lead back to the one before. */
    open(text: string): void {
        clearTimeout(this.timer);
        this.version += 1;
        this.edited = 0;
        this.view.setState(this.state(text));
        this.events.shown([], []);
    }

    /** The mark that begins a comment, `null` where the language has none. */
    setLineComment(mark: string | null): void {
        this.view.dispatch({ effects: this.comment.reconfigure(languageData(mark)) });
    }

    /** Takes what the core found; it is shown after a pause, and goes away at once. */
    found(version: number, findings: Finding[]): void {
        if (version !== this.version) {
            return;
        }
        clearTimeout(this.timer);
        const pause = findings.length === 0 ? 0 : this.edited + PAUSE - performance.now();
        this.timer = setTimeout(() => void this.show(version, findings), Math.max(0, pause));
    }

    /** Selects a range, brings it into view and goes there. */
    select({ from, to }: TextRange, focus = true): void {
        const { length } = this.view.state.doc;
        const [start, end] = [Math.min(from, length), Math.min(to, length)];
        this.view.dispatch({
            selection: EditorSelection.single(start, end),
            effects: EditorView.scrollIntoView(EditorSelection.range(start, end), { y: "center" }),
        });
        if (focus) {
            this.view.focus();
        }
    }

    /** Applies edits of the text as it was at a version. */
    apply(edits: TextEdit[], version: number, name: string): void {
        if (version !== this.version) {
            this.events.say(`The text has changed meanwhile: ${name} is not done. Try again.`);
        } else if (edits.length > 0) {
            this.view.dispatch({ changes: edits, userEvent: "input.replace" });
        }
    }

    /** Replaces the whole text, so that it can be undone. */
    replace(text: string): void {
        this.view.dispatch({ changes: { from: 0, to: this.view.state.doc.length, insert: text } });
    }

    /** Brings the text, or the declarations that are selected, into the canonical layout. */
    async format(): Promise<void> {
        const { version } = this;
        const { main } = this.view.state.selection;
        const range = main.empty ? null : { from: main.from, to: main.to };
        await this.attempt(async () => {
            this.apply(await this.core.call("format", { range }), version, "the layout");
        });
    }

    /** Gives the name at the cursor another one. */
    async rename(): Promise<void> {
        const at = this.view.state.selection.main.head;
        await this.attempt(async () => {
            const { version } = this;
            const { name } = await this.core.call("prepareRename", { at });
            const next = await this.events.askName(name);
            if (next !== undefined && next !== name) {
                this.apply(await this.core.call("rename", { at, name: next }), version, "the renaming");
            }
            this.view.focus();
        });
    }

    /** Applies all fixes that need no choice. */
    async fixAll(): Promise<void> {
        const { version } = this;
        await this.attempt(async () => {
            const { edits, count } = await this.core.call("fixAll", {});
            if (count === 0) {
                this.events.say("No fix can be applied without a choice.");
            }
            this.apply(edits, version, "the fix");
        });
    }

    toggleComment(): void {
        if (!toggleLineComment(this.view)) {
            this.events.say("This language has no comments up to the end of the line.");
        }
        this.view.focus();
    }

    find(): void {
        openSearchPanel(this.view);
    }

    private async definition(at: number): Promise<void> {
        await this.attempt(async () => {
            const found = await this.core.call("definition", { at });
            if (found !== null) {
                this.select(found.target);
            }
        });
    }

    private async attempt(action: () => Promise<void>): Promise<void> {
        try {
            await action();
        } catch (error) {
            this.events.say((error as Error).message);
        }
    }

    private async show(version: number, all: Finding[]): Promise<void> {
        const findings = all.slice(0, SHOWN);
        const fixable = findings.slice(0, FIXED);
        const asked = fixable.map(({ from, to }) => this.core.call("fixes", { from, to }).catch(() => []));
        const fixes = await Promise.all(asked);
        if (version !== this.version) {
            return;
        }
        const { doc } = this.view.state;
        const shown = findings.map((finding, at): Shown => {
            const from = Math.min(finding.from, doc.length);
            const line = doc.lineAt(from);
            const own = (fixes[at] ?? []).filter((fix) => fix.code === finding.code);
            return {
                ...finding,
                from,
                to: Math.min(finding.to, doc.length),
                line: line.number,
                // In characters, as the command line counts them.
                column: [...line.text.slice(0, from - line.from)].length + 1,
                fix: own.find((fix) => fix.preferred),
                version,
            };
        });
        const diagnostics = shown.map((finding, at): Diagnostic => {
            const own = (fixes[at] ?? []).filter((fix) => fix.code === finding.code);
            return {
                from: finding.from,
                to: finding.to,
                severity: finding.severity,
                message: finding.hint === null ? finding.message : `${finding.message}\n${finding.hint}`,
                actions: own.map((fix) => ({
                    name: fix.title.replaceAll("`", ""),
                    apply: () => this.apply(fix.edits, version, "the fix"),
                })),
            };
        });
        this.view.dispatch(setDiagnostics(this.view.state, diagnostics));
        this.events.shown(shown, all);
        // The list takes room from the text: what is being written stays in view.
        if (this.view.hasFocus) {
            this.view.dispatch({ effects: EditorView.scrollIntoView(this.view.state.selection.main.head) });
        }
    }

    private state(doc: string): EditorState {
        const { core } = this;
        return EditorState.create({
            doc,
            extensions: [
                lineNumbers(),
                highlightActiveLine(),
                highlightActiveLineGutter(),
                history(),
                drawSelection(),
                dropCursor(),
                indentUnit.of("    "),
                EditorState.tabSize.of(4),
                EditorState.allowMultipleSelections.of(true),
                EditorView.lineWrapping,
                EditorView.contentAttributes.of({ "aria-label": "Program", spellcheck: "false", autocapitalize: "off" }),
                bracketMatching(),
                closeBrackets(),
                search({ top: true }),
                highlightSelectionMatches({ minSelectionLength: 2 }),
                placeholder("Write a program, or choose an example."),
                this.comment.of(languageData("#")),
                this.mode.of([]),
                autocompletion({
                    override: [(context) => complete(core, context)],
                    selectOnOpen: false,
                    defaultKeymap: true,
                    icons: false,
                }),
                hoverTooltip((view, at) => hover(core, view, at), { hoverTime: 250 }),
                colours(core),
                occurrences(core),
                signatures(core),
                Prec.highest(keymap.of([{ key: "Tab", run: takeFirst }])),
                keymap.of([
                    { key: "Shift-Alt-f", run: () => (void this.format(), true) },
                    { key: "F2", run: () => (void this.rename(), true) },
                    {
                        key: "F12",
                        run: (view) => (void this.definition(view.state.selection.main.head), true),
                    },
                    { key: "Mod-.", run: () => (void this.fixAll(), true) },
                    { key: "Mod-/", run: () => (this.toggleComment(), true) },
                    // Tab moves on after Escape, as CodeMirror has it for those who use no mouse.
                    { key: "Tab", run: insertTab, shift: indentLess },
                    ...closeBracketsKeymap,
                    ...defaultKeymap,
                    ...searchKeymap,
                    ...historyKeymap,
                ]),
                EditorView.domEventHandlers({
                    mousedown: (event, view) => {
                        const at = view.posAtCoords({ x: event.clientX, y: event.clientY });
                        if ((event.ctrlKey || event.metaKey) && !event.altKey && at !== null) {
                            void this.definition(at);
                        }
                        return false;
                    },
                    blur: () => core.tell("cursor", { at: null }),
                }),
                EditorView.updateListener.of((update) => {
                    if (update.docChanged) {
                        this.tell(update.transactions);
                    }
                    if ((update.selectionSet || update.focusChanged) && update.view.hasFocus) {
                        core.tell("cursor", { at: update.state.selection.main.head });
                    }
                }),
            ],
        });
    }

    /** Sends each transaction's changes, which are of the text before it. */
    private tell(transactions: readonly Transaction[]): void {
        let isByHand = false;
        for (const transaction of transactions) {
            if (!transaction.docChanged) {
                continue;
            }
            const changes: TextEdit[] = [];
            transaction.changes.iterChanges((from, to, _start, _end, inserted) => {
                changes.push({ from, to, insert: inserted.toString() });
            });
            this.version += 1;
            isByHand ||= transaction.annotation(Transaction.userEvent) !== undefined;
            const { newDoc } = transaction;
            this.core.edit(this.version, changes, () => newDoc.toString());
        }
        this.edited = performance.now();
        this.events.changed(isByHand);
    }
}

function languageData(mark: string | null) {
    const data = {
        ...(mark === null ? {} : { commentTokens: { line: mark } }),
        closeBrackets: { brackets: ["(", "[", "{"] },
        wordChars: "",
    };
    return EditorState.languageData.of(() => [data]);
}

/** Takes the word that is selected in the list, or its first one. */
function takeFirst(view: EditorView): boolean {
    if (completionStatus(view.state) !== "active") {
        return false;
    }
    if (selectedCompletion(view.state) === null) {
        moveCompletionSelection(true)(view);
    }
    return acceptCompletion(view) || closeCompletion(view);
}

const KINDS: Record<CompletionKind, string> = {
    keyword: "keyword",
    function: "function",
    surface: "class",
    curve: "function",
    constant: "constant",
    parameter: "variable",
    solid: "class",
    attribute: "property",
    word: "text",
};

async function complete(core: Core, context: CompletionContext): Promise<CompletionResult | null> {
    const word = context.matchBefore(/[\p{L}\d_]+/u);
    if (!context.explicit && (word === null || /^\d/.test(word.text))) {
        return null;
    }
    const at = context.pos;
    const found = await core.call("complete", { at }).catch(() => null);
    if (found === null || context.aborted || found.list.length === 0) {
        return null;
    }
    const option = (entry: Completion) => ({
        label: entry.label,
        detail: entry.detail,
        type: KINDS[entry.kind],
        apply: entry.snippet ? snippet(entry.insert) : entry.insert,
        info: async () => {
            const description = await core.call("describe", { at, label: entry.label }).catch(() => null);
            return description && described(description);
        },
    });
    const result: CompletionResult = { from: found.from, to: found.to, options: found.list.map(option) };
    return found.isComplete ? { ...result, validFor: /^[\p{L}\d]*$/u } : result;
}

async function hover(core: Core, view: EditorView, at: number) {
    const { doc } = view.state;
    const found = await core.call("hover", { at }).catch(() => null);
    if (found === null || view.state.doc !== doc) {
        return null;
    }
    return { pos: found.from, end: found.to, above: true, create: () => ({ dom: described(found.description) }) };
}
