// The Worker: it loads the core, hands it the page's messages, and lets it work between them.
//
// Messages come first: each step of work (a text is compiled, a camera moves, a picture is drawn) is a task of its own, so
// that whatever has come in the meantime is heeded before the next one. So of texts and motions that come while a picture
// is drawn only the last is seen.
//
// The core without threads is part of this script: a preview inside VS Code has the script as a text, and no other files.

import init, { Core } from "./core/core.js";
import type { CallName, Calls, EventName, Events, FromWorker, ToWorker } from "./protocol.ts";

const start = performance.now();
const scope = self as unknown as {
    postMessage(message: FromWorker, transfer: Transferable[]): void;
    onmessage: ((event: MessageEvent<ToWorker>) => void) | null;
};

let core: Core | undefined;
/** Messages that came before the core was there. */
const early: ToWorker[] = [];

function post(message: FromWorker, transfer: Transferable[] = []): void {
    scope.postMessage(message, transfer);
}

function tell<K extends EventName>(event: K, params: Events[K], transfer: Transferable[] = []): void {
    post({ event, params } as FromWorker, transfer);
}

/** The core ends with a panic or runs out of memory: whatever it does after that is not to be trusted. */
function crash(error: unknown): void {
    core = undefined;
    scope.onmessage = null;
    tell("crashed", { message: error instanceof Error ? error.message : String(error) });
}

/** Runs work of the core; an error that is no sentence of its own ends it. */
function guarded(work: () => void): void {
    try {
        work();
    } catch (error) {
        crash(error);
    }
}

// A channel's message is a task, as a timer is, but without a timer's least delay.
const turn = new MessageChannel();
let isTurn = false;
let timer: ReturnType<typeof setTimeout> | undefined;

function soon(): void {
    if (!isTurn) {
        isTurn = true;
        turn.port2.postMessage(null);
    }
}

turn.port1.onmessage = () => {
    isTurn = false;
    guarded(step);
};

function step(): void {
    if (core === undefined) {
        return;
    }
    clearTimeout(timer);
    const done = core.step(performance.now());
    const { next, picture } = JSON.parse(done.text()) as { next: number | null; picture: Omit<Events["picture"], "pixels"> | null };
    tellEvents(core);
    if (picture !== null) {
        const pixels = done.pixels().buffer as ArrayBuffer;
        tell("picture", { ...picture, pixels }, [pixels]);
    }
    done.free();
    if (next === 0) {
        soon();
    } else if (next !== null) {
        timer = setTimeout(soon, next);
    }
}

function tellEvents(core: Core): void {
    for (const event of JSON.parse(core.events()) as FromWorker[]) {
        post(event);
    }
}

/** A file of the core for the page. */
function saved(file: ReturnType<Core["savePicture"]>): Calls["savePicture"]["result"] {
    const bytes = file.bytes().buffer as ArrayBuffer;
    const { type, notes } = JSON.parse(file.text()) as { type: string; notes: string[] };
    file.free();
    return { bytes, type, notes };
}

/** Answers a call; throws a sentence. What holds bytes has a function of its own. */
function answer(core: Core, message: { call: CallName; params: unknown }): unknown {
    switch (message.call) {
        case "tokens": {
            const { from, to } = message.params as Calls["tokens"]["params"];
            return core.tokens(from, to);
        }
        case "texture": {
            const { name, bytes } = message.params as Calls["texture"]["params"];
            return JSON.parse(core.texture(name, new Uint8Array(bytes))) as unknown;
        }
        case "savePicture": {
            const { view, width, height } = message.params as Calls["savePicture"]["params"];
            return saved(core.savePicture(view, width, height));
        }
        case "saveMesh": {
            const { format } = message.params as Calls["saveMesh"]["params"];
            return saved(core.saveMesh(format));
        }
        default:
            return JSON.parse(core.call(message.call, JSON.stringify(message.params), performance.now())) as unknown;
    }
}

function handle(core: Core, message: ToWorker): void {
    try {
        if ("notice" in message) {
            core.notice(message.notice, JSON.stringify(message.params), performance.now());
        } else {
            const result = answer(core, message);
            post({ answer: message.id, result }, transferable(result));
        }
    } catch (error) {
        // The core throws sentences, which are strings; anything else is a fault.
        if (typeof error !== "string") {
            throw error;
        }
        if ("call" in message) {
            post({ answer: message.id, error });
        } else {
            console.error(error);
        }
    }
    soon();
}

/** The buffers of an answer, which need not be copied. */
function transferable(result: unknown): Transferable[] {
    if (result instanceof Uint32Array) {
        return [result.buffer as ArrayBuffer];
    }
    const bytes = (result as { bytes?: unknown } | null)?.bytes;
    return bytes instanceof ArrayBuffer ? [bytes] : [];
}

scope.onmessage = ({ data }) => {
    if (core === undefined) {
        early.push(data);
        return;
    }
    const known = core;
    guarded(() => handle(known, data));
};

/** More threads than these draw a picture of a page no faster. */
const MOST_THREADS = 8;

/** Loads the core, with threads where the browser lets Workers share memory. */
async function load(channel: string): Promise<{ Core: typeof Core; threads: number }> {
    // The browser itself needs a core to bring pictures to the screen: on a machine with two, two threads are slower than one.
    const wanted = Math.min(navigator.hardwareConcurrency - 1, MOST_THREADS);
    if (globalThis.crossOriginIsolated && wanted > 1) {
        try {
            const { loadThreaded } = await import("./threads.ts");
            return await loadThreaded(wanted, channel);
        } catch (error) {
            console.warn(`without threads: ${String(error)}`);
        }
    }
    await init();
    return { Core, threads: 1 };
}

const channel = `geotrace-${Math.random()}`;
load(channel).then(
    (loaded) => {
        core = new loaded.Core();
        tell("ready", { took: performance.now() - start, threads: loaded.threads, channel });
        for (const message of early.splice(0)) {
            const known: Core | undefined = core;
            if (known !== undefined) {
                guarded(() => handle(known, message));
            }
        }
    },
    (error: unknown) => crash(error),
);
