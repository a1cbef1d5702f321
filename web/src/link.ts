// The link to a program and its settings: everything behind `#`, so that no server ever sees it.
//
//   #1.<base64url of the deflated JSON>     1 is the version of this format
//
// In: what is on the page. Out: text for the address bar, and back. A link that cannot be read is a `LinkError`, whose
// message is a sentence for the reader.

import type { Settings } from "./protocol.ts";

/** What a link carries: a program, and how it is looked at. */
export interface Shared {
    /** The name of the file, with its extension, which says the language. */
    name: string;
    text: string;
    /** The cameras, params and looks, as the core gives them; absent where all is as it was at first. */
    settings?: Settings;
}

/** The reason why a link cannot be read, as a sentence. */
export class LinkError extends Error {}

const VERSION = "1";
/** The longest text that a link is unpacked to, in bytes: a short link can deflate to gigabytes. */
const LONGEST = 8 << 20;

/** Returns what stands behind `#` for a program. */
export async function packed(shared: Shared): Promise<string> {
    const bytes = new TextEncoder().encode(JSON.stringify(shared));
    const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream("deflate-raw"));
    return `${VERSION}.${base64url(new Uint8Array(await new Response(stream).arrayBuffer()))}`;
}

/** Reads what stands behind `#`; `undefined` if nothing does. */
export async function unpacked(hash: string): Promise<Shared | undefined> {
    const written = hash.replace(/^#/, "");
    if (written === "") {
        return undefined;
    }
    const [version, body] = [written.slice(0, written.indexOf(".")), written.slice(written.indexOf(".") + 1)];
    if (!written.includes(".") || !/^\d+$/.test(version)) {
        throw new LinkError("This address does not contain a Geotrace program. It may have been truncated when it was copied.");
    }
    if (version !== VERSION) {
        throw new LinkError("This link was made by a newer version of this page. Reload the page to get that version.");
    }
    let shared: unknown;
    try {
        shared = JSON.parse(await inflated(bytesOf(body)));
    } catch {
        throw new LinkError("This link is damaged. It may have been truncated when it was copied.");
    }
    if (!isShared(shared)) {
        throw new LinkError("This link does not contain a Geotrace program.");
    }
    return shared;
}

function isShared(value: unknown): value is Shared {
    if (typeof value !== "object" || value === null) {
        return false;
    }
    const { name, text, settings } = value as Record<string, unknown>;
    const kept = settings === undefined || (typeof settings === "object" && settings !== null);
    return typeof name === "string" && typeof text === "string" && kept;
}

async function inflated(bytes: Uint8Array<ArrayBuffer>): Promise<string> {
    const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
    const parts: Uint8Array<ArrayBuffer>[] = [];
    let length = 0;
    for (;;) {
        const { done, value } = await reader.read();
        if (done) {
            break;
        }
        length += value.length;
        if (length > LONGEST) {
            await reader.cancel();
            throw new LinkError("too long");
        }
        parts.push(value as Uint8Array<ArrayBuffer>);
    }
    return new TextDecoder("utf-8", { fatal: true }).decode(await new Blob(parts).arrayBuffer());
}

function base64url(bytes: Uint8Array): string {
    let binary = "";
    // A call with too many arguments fails.
    for (let at = 0; at < bytes.length; at += 0x8000) {
        binary += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
    }
    return btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

function bytesOf(text: string): Uint8Array<ArrayBuffer> {
    const binary = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
    return Uint8Array.from(binary, (character) => character.charCodeAt(0));
}
