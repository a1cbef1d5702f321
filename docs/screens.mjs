// VS Code in a browser on the left of the screen, with the extension and its preview: `screens.py` takes the picture.
//
//   node screens.mjs CACHE EXTENSION WORKSPACE PROGRAM
//
// It ends when its standard input does.
import { spawn } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";

const [cache, extension, workspace, program] = process.argv.slice(2);
const { chromium } = createRequire(join(cache, "package.json"))("playwright-core");
const port = await new Promise((resolve) => {
    const probe = createServer().listen(0, "127.0.0.1", () => {
        const { port } = probe.address();
        probe.close(() => resolve(port));
    });
});
const home = mkdtempSync(join(tmpdir(), "geotrace-vscode-"));
mkdirSync(join(home, "data/Machine"), { recursive: true });
writeFileSync(
    join(home, "data/Machine/settings.json"),
    JSON.stringify({
        "geotrace.server.path": program,
        "geotrace.preview.open": "onOpen",
        "security.workspace.trust.enabled": false,
        "workbench.startupEditor": "none",
        "workbench.activityBar.location": "hidden",
        "workbench.colorTheme": "Default Dark Modern",
        "workbench.secondarySideBar.defaultVisibility": "hidden",
        "editor.minimap.enabled": false,
        "editor.fontFamily": "DejaVu Sans Mono, monospace",
    }),
);
cpSync(extension, join(home, "extensions/geotrace"), { recursive: true });
const server = spawn(
    process.execPath,
    [
        join(cache, "node_modules/code-server/lib/vscode/out/server-main.js"),
        "--host=127.0.0.1",
        `--port=${port}`,
        "--without-connection-token",
        "--accept-server-license-terms",
        "--disable-telemetry",
        "--disable-workspace-trust",
        `--server-data-dir=${home}`,
    ],
    { env: { ...process.env, XDG_CONFIG_HOME: home }, stdio: ["ignore", "pipe", "inherit"] },
);
await new Promise((resolve) => server.stdout.on("data", (data) => /Web UI|bound to/.test(String(data)) && resolve()));
// A browser's own folder, so that it opens as a program without tabs and bars.
const browser = await chromium.launchPersistentContext(join(home, "browser"), {
    headless: false,
    viewport: null,
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    ignoreDefaultArgs: ["--enable-automation"],
    args: [
        "--no-sandbox",
        "--disable-gpu",
        "--no-first-run",
        "--test-type",
        "--disable-infobars",
        "--disable-background-networking",
        "--window-position=0,0",
        "--window-size=720,900",
        `--app=http://localhost:${port}/?folder=${encodeURIComponent(workspace)}&payload=${encodeURIComponent(
            JSON.stringify([
                ["skipWelcome", "true"],
                ["openFile", `vscode-remote://localhost:${port}${workspace}/torus.gtr`],
            ]),
        )}`,
    ],
});
// What is not the text makes room for it.
const page = browser.pages()[0];
await page.waitForSelector(".monaco-editor .view-line", { timeout: 60_000 });
await page.keyboard.press("Control+b");
process.stdin.resume();
process.stdin.on("end", async () => {
    await browser.close().catch(() => {});
    server.kill("SIGKILL");
    rmSync(home, { recursive: true, force: true });
    process.exit(0);
});
