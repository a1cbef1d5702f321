// The service worker: it keeps the page's files, so that the page works without a network.
//
// The build writes the list of files and their version in front (`vite.config.ts`). A new version is fetched beside the
// old one and takes its place when the reader says so, or when no page of the old one is open: a page never gets the
// files of two versions.

declare const FILES: string[];
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
const PREFIX = "geotrace-";

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
        return (await cache.match(wanted, { ignoreSearch: true })) ?? fetch(request);
    };
    event.respondWith(answer());
});
