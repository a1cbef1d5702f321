// The service worker: it keeps the page's files, so that the page works without a network.
//
// The build writes the list of files and their version in front (`vite.config.ts`). A new version is fetched beside the
// old one and takes its place when the reader says so, or when no page of the old one is open: a page never gets the
// files of two versions.
//
// It also lets the page's Workers share memory, for threads, which takes two headers that a host of static files need not
// know. So a page has threads from its second visit on. Other pages of the folder, which show images of other hosts, go as
// they came.

declare const FILES: string[];
/** Files that not every browser asks for: they are kept once they were used. */
declare const LATER: string[];
declare const VERSION: string;

interface Scope {
    skipWaiting(): Promise<void>;
    clients: { claim(): Promise<void> };
    addEventListener(name: string, listener: (event: never) => void): void;
}
interface Extendable extends Event {
    waitUntil(done: Promise<unknown>): void;
}
interface Fetch extends Extendable {
    request: Request;
    respondWith(answer: Promise<Response>): void;
}

const scope = globalThis as unknown as Scope;
/** A copy of the page in another folder has caches of its own. */
const PREFIX = `geotrace-${new URL("./", location.href).pathname}-`;

scope.addEventListener("install", (event: Extendable) => {
    const fill = async () => {
        const cache = await caches.open(PREFIX + VERSION);
        // Names with a hash are in the browser's own cache already; the others are asked for again.
        await cache.addAll(FILES.map((file) => new Request(file, { cache: /-[\w-]{8}\./.test(file) ? "default" : "reload" })));
    };
    event.waitUntil(fill());
});

scope.addEventListener("activate", (event: Extendable) => {
    const clean = async () => {
        for (const name of await caches.keys()) {
            if (name.startsWith(PREFIX) && name !== PREFIX + VERSION) {
                await caches.delete(name);
            }
        }
        await scope.clients.claim();
    };
    event.waitUntil(clean());
});

scope.addEventListener("message", (event: MessageEvent<unknown>) => {
    if (event.data === "take over") {
        void scope.skipWaiting();
    }
});

scope.addEventListener("fetch", (event: Fetch) => {
    const { request } = event;
    const url = new URL(request.url);
    if (request.method !== "GET" || url.origin !== location.origin) {
        return;
    }
    const answer = async () => {
        const cache = await caches.open(PREFIX + VERSION);
        const own = new URL("./", location.href);
        const wanted = url.pathname === own.pathname ? new URL("index.html", own).href : request.url;
        const kept = await cache.match(wanted, { ignoreSearch: true });
        const response = kept ?? (await fetch(request));
        const isLater = LATER.some((file) => new URL(file, own).href === url.href);
        if (kept === undefined && response.ok && isLater) {
            await cache.put(url.href, response.clone());
        }
        if (kept === undefined && !isLater) {
            return response;
        }
        // Other files need no headers, and browsers keep what they have compiled of a response only as it came.
        return ["document", "iframe", "worker"].includes(request.destination) ? isolated(response) : response;
    };
    event.respondWith(answer());
});

/** The response with the headers without which no memory is shared. */
function isolated(response: Response): Response {
    if (response.type === "opaqueredirect") {
        return response;
    }
    const headers = new Headers(response.headers);
    headers.set("Cross-Origin-Opener-Policy", "same-origin");
    headers.set("Cross-Origin-Embedder-Policy", "require-corp");
    const { status, statusText } = response;
    return new Response(response.body, { status, statusText, headers });
}
