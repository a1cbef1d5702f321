// The core as its Worker has it, for tests in Node: the same messages, without a Worker between.
import { readFileSync, readdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
export const root = join(here, "../../..");
const built = join(root, "web/src/core");

let loaded;

/** Loads the core that `web/build` has made. */
async function load() {
    if (loaded === undefined) {
        const { default: _, initSync, Core } = await import(join(built, "core.js"));
        initSync({ module: readFileSync(join(built, "core_bg.wasm")) });
        loaded = Core;
    }
    return loaded;
}

/** A core with what it has told so far. */
export class Session {
    version = 0;
    scene = null;
    findings = [];
    settings = null;
    pictures = [];
    events = [];

    static async start() {
        const Core = await load();
        const session = new Session();
        session.core = new Core();
        session.now = 0;
        return session;
    }

    call(name, params = {}) {
        return JSON.parse(this.core.call(name, JSON.stringify(params), this.now));
    }

    tell(name, params = {}) {
        this.core.notice(name, JSON.stringify(params), this.now);
    }

    open(name, text, settings) {
        this.version = 1;
        this.findings = [];
        const answer = this.call("open", { name, text, version: 1, ...(settings && { settings }) });
        this.work();
        return answer;
    }

    edit(changes) {
        this.version += 1;
        this.tell("edit", { version: this.version, changes });
    }

    /** One step; returns the milliseconds until the next, `null` for none. */
    step() {
        const done = this.core.step(this.now);
        const { next, picture } = JSON.parse(done.text());
        if (picture !== null) this.pictures.push({ ...picture, pixels: done.pixels() });
        done.free();
        for (const { event, params } of JSON.parse(this.core.events())) {
            this.events.push({ event, params });
            if (event === "findings") this.findings = params.findings;
            if (event === "scene") this.scene = params;
            if (event === "settings") this.settings = params.settings;
            if (event === "noPicture") this.pictures.push({ view: params.view, message: params.message });
        }
        return next;
    }

    /** Works until there is nothing to be done at once. */
    work() {
        while (this.step() === 0);
    }

    /** Works for some time, as though each picture were shown at once. */
    rest(milliseconds = 2000) {
        const end = this.now + milliseconds;
        for (let count = 0; count < 10_000; count += 1) {
            const next = this.step();
            const last = this.pictures.at(-1);
            if (last?.pixels) this.tell("shown", { view: last.view });
            if (next === null || this.now + next > end) break;
            this.now += next;
        }
        this.now = end;
        return this.pictures.at(-1);
    }

    savePicture(view, width, height) {
        const file = this.core.savePicture(view, width, height);
        const bytes = Buffer.from(file.bytes());
        file.free();
        return bytes;
    }

    tokens(from, to) {
        return [...this.core.tokens(from, to)];
    }

    close() {
        this.core.free();
    }
}

/** The programs of the folder `examples`. */
export function examples() {
    const folder = join(root, "examples");
    const files = readdirSync(folder).filter((file) => /\.(gtr|crt)$/.test(file));
    return files.sort().map((file) => ({ file, path: join(folder, file), text: readFileSync(join(folder, file), "utf8") }));
}

/** The native program that answers are compared with. */
export function native() {
    const program = process.env.GEOTRACE_BIN;
    if (program === undefined) {
        throw new Error("GEOTRACE_BIN is not set: name the native program that the core is compared with");
    }
    return program;
}

/** Numbers from 0 to below 2^32, the same in each run. */
export function random(seed) {
    let state = seed >>> 0;
    return () => {
        state = (state + 0x6d2b79f5) >>> 0;
        let mixed = Math.imul(state ^ (state >>> 15), state | 1);
        mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
        return (mixed ^ (mixed >>> 14)) >>> 0;
    };
}
