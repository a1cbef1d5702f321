// Dialogs, menus and notices: small windows over the page, which Escape closes.

import { button, keys, make } from "./dom.ts";

/** Opens a dialog over the page; it is gone when it is closed. */
export function openDialog(title: string, body: (Node | string)[], { wide = false } = {}): HTMLDialogElement {
    const close = button("Close", () => dialog.close(), { icon: "close", text: false });
    const dialog: HTMLDialogElement = make(
        "dialog",
        { class: wide ? "wide" : "", "aria-label": title },
        make("header", {}, make("h2", {}, title), close),
        make("div", { class: "body" }, ...body),
    );
    dialog.addEventListener("close", () => {
        if (dialog.contains(notices)) {
            (document.querySelector("dialog[open]") ?? document.body).append(notices);
        }
        dialog.remove();
    });
    dialog.addEventListener("click", (event) => {
        // A click beside it, which is on its backdrop.
        if (event.target === dialog) {
            const { left, right, top, bottom } = dialog.getBoundingClientRect();
            const { clientX: x, clientY: y } = event;
            if (x < left || x > right || y < top || y > bottom) {
                dialog.close();
            }
        }
    });
    document.body.append(dialog);
    // Behind it, their buttons could not be pressed.
    dialog.append(notices);
    dialog.showModal();
    return dialog;
}

/** Asks for a line of text; nothing if it is not given. */
export function ask(title: string, label: string, initial: string): Promise<string | undefined> {
    return new Promise((resolve) => {
        const input = make("input", { class: "field", id: "asked", value: initial, autocomplete: "off", spellcheck: false });
        let answer: string | undefined;
        const form = make("form", { method: "dialog" }, make("label", { htmlFor: "asked" }, label), input);
        form.append(
            make(
                "div",
                { class: "buttons" },
                button("Cancel", () => dialog.close(), { kind: "outline" }),
                make("button", { class: "button primary", type: "submit" }, title),
            ),
        );
        form.addEventListener("submit", () => (answer = input.value.trim()));
        const dialog = openDialog(title, [form]);
        dialog.addEventListener("close", () => resolve(answer === "" ? undefined : answer));
        input.focus();
        input.select();
    });
}

export interface MenuEntry {
    label: string;
    keys?: string;
    press(): void;
}

/** Makes a button open a menu below it. */
export function menu(opener: HTMLButtonElement, entries: () => (MenuEntry | undefined)[]): void {
    const list = make("div", { class: "menu", role: "menu", popover: "auto" });
    opener.setAttribute("aria-haspopup", "menu");
    opener.setAttribute("aria-expanded", "false");
    opener.popoverTargetElement = list;
    list.addEventListener("beforetoggle", (event) => {
        const isOpen = (event as ToggleEvent).newState === "open";
        opener.setAttribute("aria-expanded", String(isOpen));
        if (!isOpen) {
            return;
        }
        list.replaceChildren(...entries().flatMap((entry) => (entry === undefined ? [] : item(entry, list))));
        const { left, right, bottom } = opener.getBoundingClientRect();
        const { clientWidth: width, clientHeight: height } = document.documentElement;
        // It grows towards the middle of the page.
        const isLeft = left < width / 2;
        list.style.left = isLeft ? `${Math.max(8, left)}px` : "auto";
        list.style.right = isLeft ? "auto" : `${Math.max(8, width - right)}px`;
        list.style.top = `${bottom + 4}px`;
        list.style.maxHeight = `${height - bottom - 12}px`;
    });
    list.addEventListener("toggle", (event) => {
        if ((event as ToggleEvent).newState === "open") {
            list.querySelector("button")?.focus();
        }
    });
    list.addEventListener("keydown", (event) => {
        const items = [...list.querySelectorAll("button")];
        const by = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
        if (by !== 0) {
            event.preventDefault();
            const at = items.indexOf(document.activeElement as HTMLButtonElement);
            items[(at + by + items.length) % items.length]?.focus();
        }
    });
    document.body.append(list);
}

function item({ label, keys: shortcut, press }: MenuEntry, list: HTMLElement): HTMLElement {
    const run = () => {
        list.hidePopover();
        press();
    };
    const properties = { type: "button", role: "menuitem", onclick: run };
    return make("button", properties, label, shortcut !== undefined && make("kbd", {}, keys(shortcut)));
}

/** It is in the page before there is anything to say: what comes together with its first sentence is not read out. */
const notices = make("div", { class: "notices", role: "status", "aria-live": "polite" });
document.body.append(notices);

export interface SayOptions {
    /** It says that something is wrong, and stays. */
    bad?: boolean;
    /** What can be done about it. */
    action?: { label: string; press(): void };
    /** It stays until it is closed. */
    stays?: boolean;
}

/** Says a sentence at the edge of the page; what it returns takes it back. */
export function say(message: string, { bad = false, action, stays = bad || action !== undefined }: SayOptions = {}): () => void {
    // The same sentence stands there once.
    for (const old of [...notices.children]) {
        if (old.querySelector("p")?.textContent === message) {
            old.remove();
        }
    }
    while (notices.children.length > 3) {
        notices.firstElementChild?.remove();
    }
    const act = action && button(action.label, () => (toast.remove(), action.press()), { kind: "outline" });
    const close = button("Close", () => toast.remove(), { icon: "close", text: false });
    const toast = make("div", { class: bad ? "toast bad" : "toast" }, make("p", {}, message), act, close);
    notices.append(toast);
    if (!stays) {
        setTimeout(() => toast.remove(), 5000);
    }
    return () => toast.remove();
}

/** Does something that can fail with a sentence, which is said then. */
export async function attempt(action: () => Promise<void>): Promise<void> {
    try {
        await action();
    } catch (error) {
        say((error as Error).message, { bad: true });
    }
}
