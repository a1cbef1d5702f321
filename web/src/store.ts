// What the browser remembers: the program of this tab, those that were open before, and the theme. Nothing of it leaves
// the browser. A browser that remembers nothing (or has no room) loses that and nothing else.

import type { Settings } from "./protocol.ts";

export interface Kept {
    name: string;
    text: string;
    settings?: Settings;
    /** The tab that had it open when another one took its place. */
    tab?: string;
    /** What stood behind `#` in the address while this tab had it open. */
    link?: string;
}

const CURRENT = "geotrace.program";
const RECENT = "geotrace.recent";
const THEME = "geotrace.theme";
const WELCOME = "geotrace.welcome";
const MOST = 12;
/** The room of the programs that were open before, in UTF-16 units: a browser gives a page about five million. */
const ROOM = 2_500_000;

function read<Value>(storage: () => Storage, key: string): Value | undefined {
    try {
        const text = storage().getItem(key);
        return text === null ? undefined : (JSON.parse(text) as Value);
    } catch {
        return undefined;
    }
}

function write(storage: () => Storage, key: string, value: unknown): boolean {
    try {
        storage().setItem(key, JSON.stringify(value));
        return true;
    } catch {
        return false;
    }
}

const session = () => sessionStorage;
const local = () => localStorage;

const tab = Math.random().toString(36).slice(2);

function isProgram(kept: Kept | undefined): kept is Kept {
    return typeof kept?.name === "string" && typeof kept.text === "string";
}

/** The program of this tab, else of the tab that was used last. */
export function current(): Kept | undefined {
    const kept = read<Kept>(session, CURRENT) ?? read<Kept>(local, CURRENT);
    return isProgram(kept) ? kept : undefined;
}

/** Keeps the program of this tab; returns false if there is no room for it. That of another tab is remembered. */
export function keep({ link, ...program }: Kept): boolean {
    const isKept = write(session, CURRENT, { ...program, link });
    const last = read<Kept>(local, CURRENT);
    if (isProgram(last) && last.tab !== tab && last.text !== program.text) {
        remember(last);
    }
    return write(local, CURRENT, { ...program, tab }) || isKept;
}

/** The programs that were open before, the last one first. */
export function recent(): Kept[] {
    const list = read<Kept[]>(local, RECENT);
    return Array.isArray(list) ? list.filter(isProgram) : [];
}

/** Adds a program to those that were open before, in place of the oldest ones; returns false if there is no room for it. */
export function remember(program: Kept): boolean {
    if (program.text.trim() === "") {
        return true;
    }
    // Tabs that are used in turn leave one program each, as it was last.
    const isSame = (it: Kept) => it.text === program.text || (it.tab !== undefined && it.tab === program.tab && it.name === program.name);
    const others = recent().filter((it) => !isSame(it));
    let list = [program, ...others].slice(0, MOST);
    while (list.length > 0 && (JSON.stringify(list).length > ROOM || !write(local, RECENT, list))) {
        list = list.slice(0, -1);
    }
    return list.length > 0;
}

export type Theme = "light" | "dark";

/** The theme that was chosen; the system's if none was. */
export function theme(): Theme | undefined {
    const chosen = read<Theme>(local, THEME);
    return chosen === "light" || chosen === "dark" ? chosen : undefined;
}

export function keepTheme(chosen: Theme): void {
    write(local, THEME, chosen);
}

export function hasSeenWelcome(): boolean {
    return read<boolean>(local, WELCOME) === true;
}

export function seenWelcome(): void {
    write(local, WELCOME, true);
}
