// The page works without a network once it was loaded: a service worker (`sw.ts`) keeps its files.

import { say } from "./dialogs.ts";

/** Starts the service worker, and says when a newer version of the page has come. */
export function keepOffline(): void {
    if (!("serviceWorker" in navigator) || !import.meta.env.PROD) {
        return;
    }
    const hadOne = navigator.serviceWorker.controller !== null;
    let isReloading = false;
    navigator.serviceWorker.addEventListener("controllerchange", () => {
        if (hadOne && !isReloading) {
            isReloading = true;
            location.reload();
        }
    });
    const start = async () => {
        const registration = await navigator.serviceWorker.register("./sw.js", { updateViaCache: "none" });
        const offer = (waiting: ServiceWorker | null) => {
            if (waiting !== null && navigator.serviceWorker.controller !== null) {
                const press = () => waiting.postMessage("take over");
                say("A newer version of this page is ready.", { stays: true, action: { label: "Reload", press } });
            }
        };
        offer(registration.waiting);
        registration.addEventListener("updatefound", () => {
            const next = registration.installing;
            next?.addEventListener("statechange", () => {
                if (next.state === "installed") {
                    offer(next);
                }
            });
        });
    };
    // After the first picture: the files that are kept are those that the page has loaded already.
    addEventListener("load", () => setTimeout(() => start().catch(() => {}), 1500));
}
