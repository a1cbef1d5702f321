// Runs a suite in VS Code's browser form: files of a web server and nothing behind them, so that extensions run in a Worker.
// The extension is that from the .vsix for the target web.
//
//   node web.mjs CACHE EXTENSION SUITE
//
// CACHE holds code-server, whose workbench is taken without its server, and playwright-core (see `install`), EXTENSION is the
// unpacked .vsix, SUITE the bundled suite. Exit status: that of the suite; 4 where it did not report in time.
import { createReadStream, readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { openSuiteBrowser } from "./suite_browser.mjs";

const [cache, extension, suite] = process.argv.slice(2);
/** In the extension's folder: so it runs in the host of that. */
const SUITE = "/extension/suite.js";
const LIMIT = 180_000;
const finish = async (status) => {
    await browser.close(status);
    process.exit(status);
};
const browser = await openSuiteBrowser(cache, LIMIT, finish);
const code = join(cache, "node_modules/code-server/lib/vscode");
const types = { ".html": "text/html", ".js": "text/javascript", ".json": "application/json", ".css": "text/css", ".svg": "image/svg+xml", ".wasm": "application/wasm" };

/** The workbench without a server: code-server's connects to one at its own address, and keeps the user's settings there. */
const workbench = () => {
    const text = readFileSync(join(code, "out/vs/code/browser/workbench/workbench.js"), "utf8");
    const changes = [
        ["remoteAuthority:location.host", "remoteAuthority:void 0"],
        [/\.with\(\{scheme:\w+\.vscodeRemote\}\),"User"\)/g, '.with({scheme:"vscode-userdata"}),"User")'],
    ];
    return changes.reduce((text, [from, to]) => {
        const parts = text.split(from);
        if (parts.length !== 2) {
            throw new Error(`this code-server is another one: ${from} is not there once`);
        }
        return parts.join(to);
    }, text);
};

const server = createServer((request, response) => {
    const { pathname } = new URL(request.url, "http://localhost");
    const [, root, rest = ""] = /^\/(\w*)(\/.*)?$/.exec(normalize(pathname)) ?? [];
    const send = (content, type) => response.writeHead(200, { "Content-Type": type }).end(content);
    if (root === "") {
        send(page(), "text/html");
        return;
    }
    if (rest.endsWith("/workbench.js")) {
        send(workbench(), "text/javascript");
        return;
    }
    const file = pathname === SUITE ? suite : join({ code, extension }[root] ?? "/none", rest);
    if (!statSync(file, { throwIfNoEntry: false })?.isFile()) {
        browser.lines.push(`there is no ${pathname}`);
        response.writeHead(404).end();
        return;
    }
    response.writeHead(200, { "Content-Type": types[extname(file)] ?? "application/octet-stream" });
    createReadStream(file).pipe(response);
});
await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
const { port } = server.address();
const address = (path) => ({ scheme: "http", authority: `localhost:${port}`, path });

/** The workbench's own page, filled in. */
function page() {
    const base = `http://localhost:${port}/code`;
    const configuration = {
        folderUri: { scheme: "tmp", path: "/" },
        developmentOptions: { extensions: [address("/extension")], extensionTestsPath: address(SUITE) },
        additionalBuiltinExtensions: [address("/code/extensions/theme-defaults")],
        configurationDefaults: { "files.autoSave": "off", "workbench.colorTheme": "Default Dark Modern" },
        enableWorkspaceTrust: false,
        // What code-server's workbench asks for besides.
        userDataPath: "/",
        isEnabledFileDownloads: true,
        isEnabledFileUploads: true,
        isEnabledCoderGettingStarted: false,
        webviewEndpoint: `${base}/out/vs/workbench/contrib/webview/browser/pre`,
    };
    const values = {
        BASE: "",
        VS_BASE: "",
        WORKBENCH_AUTH_SESSION: "",
        WORKBENCH_NLS_FALLBACK_URL: `${base}/out/nls.messages.js`,
        WORKBENCH_NLS_URL: `${base}/out/nls.messages.js`,
        WORKBENCH_SCRIPT_NONCE: "",
        WORKBENCH_WEB_BASE_URL: base,
        WORKBENCH_WEB_CONFIGURATION: JSON.stringify(configuration).replaceAll('"', "&quot;"),
    };
    const text = readFileSync(join(code, "out/vs/code/browser/workbench/workbench.html"), "utf8");
    return text.replaceAll(/\{\{(\w+)\}\}/g, (_, name) => values[name]);
}

await browser.tab.goto(`http://localhost:${port}/`);
