// The browser of the tests: Debian's Chromium, without a screen and without requests of its own.
import { chromium } from "playwright-core";

export function launch() {
    return chromium.launch({
        executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
        args: [
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
        ],
    });
}

/** Waits until each pane of the page shows an exact picture of its last text. */
export async function settled(page) {
    await page.waitForFunction(
        () => {
            const views = [...document.querySelectorAll(".view")].filter((view) => view.clientWidth > 8);
            return views.length > 0 && views.every((view) => view.dataset.exact === "true");
        },
        undefined,
        { timeout: 30_000 },
    );
}
