// A server of static files on this machine, as any host of the page is one.
import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { extname, join, normalize } from "node:path";

const TYPES = {
    ".css": "text/css",
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".wasm": "application/wasm",
    ".webmanifest": "application/manifest+json",
    ".webp": "image/webp",
};

/**
 * Serves a folder; `pages` are further pages by their paths. With `isolated` Workers may share memory. Returns its address, the paths that were asked for, and how it
 * is closed.
 */
export async function serve(folder, pages = {}, { cors = false, isolated = false } = {}) {
    const further = {
        ...(cors && { "access-control-allow-origin": "*" }),
        ...(isolated && { "cross-origin-opener-policy": "same-origin", "cross-origin-embedder-policy": "require-corp" }),
    };
    const asked = [];
    const server = createServer((request, response) => {
        const path = normalize(decodeURIComponent(new URL(request.url, "http://x").pathname));
        asked.push(path);
        const file = path.endsWith("/") ? `${path}index.html` : path;
        try {
            const content = pages[path] ?? readFileSync(join(folder, file));
            const headers = { "content-type": TYPES[extname(file)] ?? "application/octet-stream", "cache-control": "no-cache" };
            response.writeHead(200, { ...headers, ...further });
            response.end(content);
        } catch {
            response.writeHead(404).end();
        }
    });
    await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
    const close = () => new Promise((resolve) => (server.closeAllConnections(), server.close(resolve)));
    return { url: `http://127.0.0.1:${server.address().port}/`, asked, close };
}
