// The core in its Worker: calls, notices and events of `protocol.ts`, and another Worker where one has died.
//
// What a Worker knows, the page knows too: the program, its version and the settings. So a new Worker goes on where the
// old one ended. If that one fails at once, whether it crashes or does not answer, no third one is started until the program
// is changed or another one is opened.

import {
    Connection,
    type CallName,
    type Calls,
    type EventName,
    type Events,
    type FromWorker,
    type NoticeName,
    type Notices,
    type Settings,
    type SettingsPatch,
} from "./protocol.ts";
import address from "./worker.ts?worker&url";

/** The program that is open, as a Worker needs it to begin. */
export interface Program {
    name: string;
    text: string;
    version: number;
}

export type Listeners = { [K in EventName]?: (params: Events[K]) => void } & {
    /** A Worker has ended; `isBack` if another one has taken its place. */
    lost?: (why: string, isBack: boolean) => void;
    /** The settings that came with a program cannot be read; it is open without them. */
    unreadable?: () => void;
};

export const UNREADABLE = "The settings that came with this program cannot be read, so it is shown without them.";

/** Starts a Worker. */
export type Start = () => Worker;

/** A Worker has failed at once if it was heard for less than this, in milliseconds, before it failed. */
const AT_ONCE = 10_000;
/** A call that takes longer than this, in milliseconds, has met a program that is too much for it. */
const LONGEST_CALL = 45_000;
/** Calls that may take as long as they like: the reader waits for a file, and can cancel them. */
const isLong = (call: CallName) => call === "savePicture" || call === "saveMesh";

/** Merges a patch into a value, as RFC 7396 says. */
export function merged(value: unknown, patch: unknown): unknown {
    if (typeof patch !== "object" || patch === null || Array.isArray(patch)) {
        return patch;
    }
    const base = typeof value === "object" && value !== null && !Array.isArray(value) ? value : {};
    const result: Record<string, unknown> = { ...base };
    for (const [key, part] of Object.entries(patch)) {
        if (part === null) {
            delete result[key];
        } else {
            result[key] = merged(result[key], part);
        }
    }
    return result;
}

/** Whether a list has an image. What a link brings may be no list. */
function isListed(textures: unknown, image: string): boolean {
    return Array.isArray(textures) && textures.includes(image);
}

export class Core {
    /** The settings, as far as they are known here. */
    settings: Settings = {};
    private worker: Worker | undefined;
    private connection: Connection | undefined;
    /** On it a thread of the Worker says that it has failed. */
    private channel: BroadcastChannel | undefined;
    private program: Program | undefined;
    /** What a new Worker is told before the program is opened, and after. */
    private readonly kept = new Map<NoticeName, unknown>();
    private readonly images = new Map<string, ArrayBuffer>();
    /** When the Worker was ready, and when it was heard last. */
    private ready = 0;
    private heard = 0;
    /** The Worker has taken the place of one that failed on this program. */
    private isSecond = false;
    private watch: ReturnType<typeof setTimeout> | undefined;
    private waiting = 0;
    /** How many of the calls that are waited for may take long. */
    private saving = 0;
    /** How many programs have been opened. */
    private opened = 0;
    /** The version of the text that findings have come for. */
    private checked = -1;

    constructor(
        private readonly start: Start,
        private readonly on: Listeners,
    ) {
        this.begin();
    }

    /** Opens a program, in the place of the one that is open. */
    async open(program: Program, settings: Settings = {}): Promise<Calls["open"]["result"]> {
        this.program = program;
        this.settings = settings;
        this.isSecond = false;
        this.opened += 1;
        const { opened } = this;
        for (const image of this.images.keys()) {
            if (!isListed(settings.textures, image)) {
                this.images.delete(image);
            }
        }
        const answer = this.connection === undefined ? this.restore(program) : this.call("open", { ...program, settings });
        const { connection } = this;
        try {
            return await answer;
        } catch (error) {
            const isOpen = opened === this.opened && connection === this.connection;
            if (!isOpen || Object.keys(settings).length === 0) {
                throw error;
            }
            // Those of another version of the page, or of a link that was written by hand. The text may have changed since.
            this.settings = {};
            const { name, text, version } = this.program ?? program;
            const result = await this.call("open", { name, text, version, settings: {} });
            this.on.unreadable?.();
            return result;
        }
    }

    call<K extends CallName>(
        call: K,
        params: Calls[K]["params"],
        transfer: Transferable[] = [],
    ): Promise<Calls[K]["result"]> {
        if (this.connection === undefined) {
            return Promise.reject(new Error("The program needs more than this page has. Change it to try again."));
        }
        const saving = isLong(call) ? 1 : 0;
        this.waiting += 1;
        this.saving += saving;
        this.guard();
        const { connection } = this;
        return connection.call(call, params, transfer).finally(() => {
            if (connection === this.connection) {
                this.waiting -= 1;
                this.saving -= saving;
                this.guard();
            }
        });
    }

    /** Gives up what the Worker computes: another one takes its place. */
    cancel(): void {
        this.end();
        if (this.program !== undefined) {
            this.restore(this.program).catch(() => {});
        }
    }

    tell<K extends NoticeName>(notice: K, params: Notices[K]): void {
        if (notice === "panes" || notice === "light" || notice === "focus") {
            this.kept.set(notice, params);
        }
        this.connection?.tell(notice, params);
    }

    /** Tells of edits; `text` is what they lead to. */
    edit(version: number, changes: Notices["edit"]["changes"], text: () => string): void {
        if (this.program === undefined) {
            return;
        }
        this.program = { name: this.program.name, version, text: "" };
        // A text of a megabyte is not put together for each key, only where it is needed.
        Object.defineProperty(this.program, "text", { get: text });
        if (this.connection === undefined) {
            this.isSecond = false;
            this.restore(this.program).catch(() => {});
        } else {
            this.connection.tell("edit", { version, changes });
            this.guard();
        }
    }

    /** Changes settings, here and there. */
    change(patch: SettingsPatch, step?: string): void {
        this.settings = merged(this.settings, patch) as Settings;
        this.tell("change", step === undefined ? { patch } : { patch, step });
    }

    /** Gives the core an image, which it keeps by its name. */
    async texture(name: string, bytes: ArrayBuffer): Promise<Calls["texture"]["result"]> {
        const size = await this.call("texture", { name, bytes: bytes.slice(0) });
        this.images.set(name, bytes);
        return size;
    }

    /** The images that were given, by name. */
    textures(): ReadonlyMap<string, ArrayBuffer> {
        return this.images;
    }

    /** Ends the Worker. */
    end(): void {
        clearTimeout(this.watch);
        this.worker?.terminate();
        this.connection?.close();
        this.channel?.close();
        this.channel = undefined;
        this.worker = undefined;
        this.connection = undefined;
    }

    private begin(): void {
        const worker = this.start();
        this.waiting = 0;
        this.saving = 0;
        this.checked = -1;
        this.ready = 0;
        this.heard = 0;
        const connection = new Connection(worker, {
            ...this.on,
            ready: (event) => {
                this.ready = Date.now();
                if (event.threads > 1) {
                    this.channel = new BroadcastChannel(event.channel);
                    this.channel.onmessage = ({ data }: MessageEvent<string>) => this.lose(data);
                }
                this.on.ready?.(event);
            },
            settings: (event) => {
                this.settings = event.settings;
                this.on.settings?.(event);
            },
            resync: () => {
                const { program } = this;
                if (program !== undefined) {
                    connection.tell("text", { version: program.version, text: program.text });
                }
            },
            findings: (event) => {
                this.checked = event.version;
                this.on.findings?.(event);
            },
            crashed: ({ message }) => this.lose(message),
        });
        worker.addEventListener("message", ({ data }: MessageEvent<FromWorker>) => {
            if (connection !== this.connection) {
                return;
            }
            connection.receive(data);
            // It may have said that it crashed, and another one is there.
            if (connection === this.connection) {
                this.heard = Date.now();
                this.guard();
            }
        });
        worker.addEventListener("error", (event) => {
            event.preventDefault();
            if (connection === this.connection) {
                this.lose(event.message || "the worker could not be started");
            }
        });
        this.worker = worker;
        this.connection = connection;
    }

    /** Waits for an answer, but not for ever. */
    private guard(): void {
        clearTimeout(this.watch);
        if (this.connection === undefined || this.saving > 0) {
            return;
        }
        if (this.waiting > 0 || (this.program !== undefined && this.program.version !== this.checked)) {
            this.watch = setTimeout(() => this.lose("it does not answer"), LONGEST_CALL);
        }
    }

    private lose(why: string): void {
        this.end();
        const { program } = this;
        const isAtOnce = this.heard - this.ready < AT_ONCE;
        const isBack = !(this.isSecond && isAtOnce) && program !== undefined;
        this.isSecond = true;
        if (isBack) {
            this.restore(program).catch(() => {});
        }
        this.on.lost?.(why, isBack);
    }

    /** Starts another Worker, opens a program there and tells it what the one before knew. */
    private restore({ name, text, version }: Program): Promise<Calls["open"]["result"]> {
        this.begin();
        for (const [image, bytes] of this.images) {
            this.call("texture", { name: image, bytes: bytes.slice(0) }).catch(() => {});
        }
        const opened = this.call("open", { name, text, version, settings: this.settings });
        for (const [notice, params] of this.kept) {
            this.connection?.tell(notice, params as never);
        }
        return opened;
    }
}

/** Starts the Worker. A page of another place may not start it by its address, but a script of its own may import it. */
export function startWorker(): Worker {
    const url = new URL(address, import.meta.url);
    if (url.origin === location.origin) {
        return new Worker(url, { type: "module", name: "geotrace" });
    }
    const script = new Blob([`import ${JSON.stringify(url.href)};`], { type: "text/javascript" });
    const own = URL.createObjectURL(script);
    const worker = new Worker(own, { type: "module", name: "geotrace" });
    // It is read when the Worker starts, which is after this call.
    setTimeout(() => URL.revokeObjectURL(own), 60_000);
    return worker;
}
