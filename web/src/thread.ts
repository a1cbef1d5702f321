// A thread of the core: it shares the core's memory and draws parts of its pictures. It has no other task to wait for, so
// that it never comes back from the core.

import init, { runThread } from "./threaded/threaded.js";
import type { ThreadStart } from "./threads.ts";

const scope = self as unknown as {
    postMessage(message: null): void;
    onmessage: ((event: MessageEvent<ThreadStart>) => void) | null;
};

scope.onmessage = async ({ data }) => {
    const { code, memory, channel } = data;
    await init({ module_or_path: code, memory });
    scope.postMessage(null);
    try {
        runThread();
    } catch (error) {
        // The core waits for this thread for ever, so that only the page can still hear of it.
        new BroadcastChannel(channel).postMessage(error instanceof Error ? error.message : String(error));
    }
};
