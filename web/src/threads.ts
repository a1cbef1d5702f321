// The core with threads: Workers that share one memory, where the browser lets them (`crossOriginIsolated`).
//
// The Worker that loads it is the first thread. The others are started before it hands out work, since a Worker starts only
// while the one that has made it does nothing.

import init, { beginThreads, Core } from "./threaded/threaded.js";
import address from "./threaded/threaded_bg.wasm?url";

/** What a thread needs to begin. */
export interface ThreadStart {
    code: WebAssembly.Module;
    memory: WebAssembly.Memory;
    /** The name of the channel on which it says that it has ended. */
    channel: string;
}

/** A Worker that has not started by then, in milliseconds, is done without. */
const LONGEST_START = 3000;

/**
 * Loads the core with so many threads, or fewer where they do not start. Throws where the browser does not share memory
 * after all.
 */
export async function loadThreaded(wanted: number, channel: string): Promise<{ Core: typeof Core; threads: number }> {
    const code = await WebAssembly.compileStreaming(fetch(new URL(address, import.meta.url)));
    const { memory } = await init({ module_or_path: code });
    const starts = Array.from({ length: wanted - 1 }, () => startThread({ code, memory, channel }));
    const threads = 1 + (await Promise.all(starts)).filter((it) => it).length;
    beginThreads(threads);
    return { Core, threads };
}

/** Starts a thread; true once it waits for work. */
function startThread(start: ThreadStart): Promise<boolean> {
    const worker = new Worker(new URL("./thread.ts", import.meta.url), { type: "module", name: "geotrace thread" });
    return new Promise((resolve) => {
        const end = (isReady: boolean) => {
            clearTimeout(late);
            if (!isReady) {
                worker.terminate();
            }
            resolve(isReady);
        };
        const late = setTimeout(() => end(false), LONGEST_START);
        worker.onmessage = () => end(true);
        worker.onerror = (event) => {
            // Else it would be an error of this Worker too.
            event.preventDefault();
            end(false);
        };
        worker.postMessage(start);
    });
}
