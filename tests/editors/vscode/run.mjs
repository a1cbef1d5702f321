// Runs `suite/` in the real extension host of VS Code, with the extension from its .vsix, in a headless browser.
//
//   node run.mjs CACHE EXTENSION WORKSPACE PROGRAM
//
// CACHE holds code-server and playwright-core (see `install`), EXTENSION is the unpacked .vsix, WORKSPACE a folder of
// the test's own, PROGRAM the geotrace binary. Exit status: that of the suite; 4 where it did not report in time.
import { spawn, spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { NO_REPORT, openSuiteBrowser } from "./suite_browser.mjs";

const [cache, extension, workspace, program] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url));
// The preview's windows may take a software driver long.
const LIMIT = process.env.GEOTRACE_SUITE === undefined ? 180_000 : 420_000;

const port = await new Promise((resolve) => {
    const probe = createServer().listen(0, "127.0.0.1", () => {
        const { port } = probe.address();
        probe.close(() => resolve(port));
    });
});
const home = mkdtempSync(join(tmpdir(), "geotrace-vscode-"));
// The machine's own settings: a workspace's are not heeded until it is trusted.
mkdirSync(join(home, "data/Machine"), { recursive: true });
writeFileSync(join(home, "data/Machine/settings.json"), JSON.stringify({ "geotrace.server.path": program }));
const code = join(cache, "node_modules/code-server/lib/vscode");
const server = spawn(
    process.execPath,
    [
        join(code, "out/server-main.js"),
        "--host=127.0.0.1",
        `--port=${port}`,
        "--without-connection-token",
        "--accept-server-license-terms",
        "--disable-telemetry",
        "--enable-smoke-test-driver",
        "--reconnection-grace-time=1",
        `--server-data-dir=${home}`,
    ],
    {
        env: { ...process.env, XDG_CONFIG_HOME: home },
        stdio: ["ignore", "pipe", "pipe"],
    },
);
let log = "";
server.stdout.on("data", (data) => (log += data));
server.stderr.on("data", (data) => (log += data));
await new Promise((resolve, reject) => {
    const timer = setInterval(() => {
        if (log.includes("Web UI available") || log.includes("Server bound to")) {
            clearInterval(timer);
            resolve();
        }
    }, 50);
    server.on("exit", (status) => reject(new Error(`the server of VS Code ended with ${status}:\n${log}`)));
});

/** The processes of the windows of previews, where the suite opens any. */
const windows = () => {
    const report = process.env.GEOTRACE_REPORT;
    const pattern = `^[^ ]+ preview --attached --report ${report}`;
    return report === undefined ? "" : spawnSync("pgrep", ["-f", "--", pattern], { encoding: "utf8" }).stdout.trim();
};
const finish = async (status) => {
    const open = windows();
    await browser.close(status);
    if (status === NO_REPORT) {
        console.error(log);
    }
    if (status === 0 && open !== "") {
        // Nobody looks at VS Code any more: it ends its extensions, and they their server.
        const start = Date.now();
        while (windows() !== "" && Date.now() - start < 60_000) {
            await new Promise((resolve) => setTimeout(resolve, 100));
        }
        const left = windows();
        console.log(`${left === "" ? "ok     " : "FAILED "} the window closes when VS Code ends`);
        status = left === "" ? 0 : 1;
    }
    server.removeAllListeners("exit");
    server.kill("SIGKILL");
    process.exit(status);
};
const browser = await openSuiteBrowser(cache, LIMIT, finish);
const remote = (path) => `vscode-remote://localhost:${port}${path}`;
const payload = JSON.stringify([
    ["extensionDevelopmentPath", remote(extension)],
    ["extensionTestsPath", remote(join(here, "suite/index.js"))],
    ["skipWelcome", "true"],
]);
await browser.tab.goto(`http://localhost:${port}/?folder=${encodeURIComponent(workspace)}&payload=${encodeURIComponent(payload)}`);
