// Finds the language server: the setting, then the bundled program, then PATH. A program that is missing or of another
// version becomes a sentence that says what to do.

import { execFile } from "node:child_process";
import { access, constants, stat } from "node:fs/promises";
import { delimiter, isAbsolute, join } from "node:path";
import { promisify } from "node:util";
import { ServerMissing } from "./session";

/** A program that can be started. */
export interface Server {
    path: string;
    version: string;
    /** Where it was found: "the setting geotrace.server.path", "the extension", "PATH". */
    from: string;
}

const program = process.platform === "win32" ? "geotrace.exe" : "geotrace";

async function isProgram(path: string): Promise<boolean> {
    try {
        await access(path, constants.X_OK);
        // A folder has that right too.
        return (await stat(path)).isFile();
    } catch {
        return false;
    }
}

async function onPath(): Promise<string | undefined> {
    for (const folder of (process.env.PATH ?? "").split(delimiter)) {
        const path = join(folder, program);
        if (folder !== "" && (await isProgram(path))) {
            return path;
        }
    }
    return undefined;
}

async function versionOf(path: string, from: string): Promise<string> {
    try {
        const { stdout } = await promisify(execFile)(path, ["--version"], { timeout: 10_000 });
        const version = /^geotrace (\S+)/.exec(stdout)?.[1];
        if (version !== undefined) {
            return version;
        }
    } catch (error) {
        const reason = error instanceof Error ? error.message : String(error);
        throw new ServerMissing(`Geotrace's language server, ${path} (from ${from}), cannot start: ${reason}`);
    }
    throw new ServerMissing(`${path} (from ${from}) is not the geotrace program: it does not report a version.`);
}

/**
 * The server to start. `wanted` is the extension's version: the server's must agree with it in all but the last number.
 */
export async function findServer(setting: string, extensionFolder: string, wanted: string): Promise<Server> {
    const bundled = join(extensionFolder, "server", program);
    let path: string;
    let from: string;
    if (setting !== "") {
        from = "the setting geotrace.server.path";
        path = setting;
        if (!isAbsolute(path)) {
            throw new ServerMissing(`The setting geotrace.server.path, "${path}", must be an absolute path.`);
        }
        if (!(await isProgram(path))) {
            throw new ServerMissing(`${path}, named by the setting geotrace.server.path, is not a program that can be run.`);
        }
    } else if (await isProgram(bundled)) {
        from = "the extension";
        path = bundled;
    } else {
        from = "PATH";
        const found = await onPath();
        if (found === undefined) {
            throw new ServerMissing(
                "Geotrace's language server was not found: no geotrace program is on PATH. " +
                    "Build it with `cargo install --locked --path crates/cli`, or set geotrace.server.path to it.",
            );
        }
        path = found;
    }
    const version = await versionOf(path, from);
    const series = (text: string) => text.split(".").slice(0, 2).join(".");
    if (series(version) !== series(wanted)) {
        throw new ServerMissing(
            `${path} (from ${from}) is geotrace ${version}, but this extension is made for ${series(wanted)}. ` +
                "Install the same version of both, or set geotrace.server.path to another program.",
        );
    }
    return { path, version, from };
}
