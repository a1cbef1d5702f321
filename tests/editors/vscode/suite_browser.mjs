// The browser in which VS Code runs a suite: it prints the suite's own lines, and keeps the others for when it fails.
import { createRequire } from "node:module";
import { join } from "node:path";

/** The exit status where a suite has not reported in time; that of web/build for no compiler is 3. */
export const NO_REPORT = 4;

/**
 * Starts it and opens a tab. `cache` holds playwright-core. `finish` receives the suite's exit status, or NO_REPORT where it has not
 * reported after `limit` milliseconds.
 */
export async function openSuiteBrowser(cache, limit, finish) {
    const { chromium } = createRequire(join(cache, "package.json"))("playwright-core");
    const browser = await chromium.launch({
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
    const tab = await (await browser.newContext({ viewport: { width: 1280, height: 800 } })).newPage();
    const lines = [];
    await tab.exposeFunction("codeAutomationLog", (_kind, args) => {
        const line = args.join(" ");
        // The workbench talks much; the suite's own lines begin like this.
        if (/^(ok|FAILED|VS Code:)/.test(line)) {
            console.log(line);
        } else {
            lines.push(line);
        }
    });
    await tab.exposeFunction("codeAutomationExit", (status) => void finish(status));
    tab.on("console", (message) => lines.push(message.text()));
    tab.on("pageerror", (error) => lines.push(String(error)));
    setTimeout(() => {
        console.error(`no report within ${limit / 1000} s`);
        void finish(NO_REPORT);
    }, limit);
    /** Closes the browser; of a failure, the last lines are printed. GEOTRACE_SCREENSHOT is a file for a picture of the end. */
    const close = async (status) => {
        if (process.env.GEOTRACE_SCREENSHOT) {
            await tab.screenshot({ path: process.env.GEOTRACE_SCREENSHOT }).catch(() => {});
        }
        if (status !== 0) {
            console.error(lines.slice(-40).join("\n"));
        }
        await browser.close().catch(() => {});
    };
    return { tab, lines, close };
}
