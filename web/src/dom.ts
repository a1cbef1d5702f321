// Elements in one call, for a page without a framework.

type Child = Node | string | undefined | false;
type Properties = Record<string, unknown>;

/** Makes an element. `on…` are listeners, `class`, `aria-…` and `data-…` attributes, the rest properties. */
export function make<Name extends keyof HTMLElementTagNameMap>(
    name: Name,
    properties: Properties = {},
    ...children: Child[]
): HTMLElementTagNameMap[Name] {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(properties)) {
        if (value === undefined || value === false) {
            continue;
        }
        if (key.startsWith("on") && typeof value === "function") {
            element.addEventListener(key.slice(2), value as EventListener);
        } else if (key in element && !key.includes("-")) {
            (element as unknown as Properties)[key] = value;
        } else {
            element.setAttribute(key, value === true ? "" : String(value));
        }
    }
    element.append(...children.filter((child) => child !== undefined && child !== false));
    return element;
}

/** The icons: 24 × 24, drawn as lines in the text's colour. */
const ICONS = {
    add: "M12 5v14M5 12h14",
    animate: "M8 5.5v13l10.5-6.5z",
    chevron: "M7 10l5 5 5-5",
    close: "M6 6l12 12M18 6L6 18",
    code: "M9 7l-5 5 5 5M15 7l5 5-5 5",
    cube: "M12 3l8 4.5v9L12 21l-8-4.5v-9zM4 7.5l8 4.5 8-4.5M12 12v9",
    dots: "M12 5.5v.01M12 12v.01M12 18.5v.01",
    download: "M12 4v11M7.5 11l4.5 4.5 4.5-4.5M5 20h14",
    error: "M12 8v5M12 16.5v.01M12 3.5a8.5 8.5 0 100 17 8.5 8.5 0 000-17z",
    eye: "M2.5 12S6 5.5 12 5.5 21.5 12 21.5 12 18 18.5 12 18.5 2.5 12 2.5 12zM12 9.2a2.8 2.8 0 100 5.6 2.8 2.8 0 000-5.6z",
    eyeOff: "M4 4l16 16M9.5 5.9A9 9 0 0112 5.5c6 0 9.5 6.5 9.5 6.5a17 17 0 01-2.6 3.4M6.2 7.7A16 16 0 002.5 12S6 18.5 12 18.5a9 9 0 004-.9",
    fit: "M4 9V5.5A1.5 1.5 0 015.5 4H9M15 4h3.5A1.5 1.5 0 0120 5.5V9M20 15v3.5a1.5 1.5 0 01-1.5 1.5H15M9 20H5.5A1.5 1.5 0 014 18.5V15",
    gallery: "M4 4h6.5v6.5H4zM13.5 4H20v6.5h-6.5zM4 13.5h6.5V20H4zM13.5 13.5H20V20h-6.5z",
    help: "M9.3 9.2a2.8 2.8 0 015.4.9c0 1.9-2.7 2.3-2.7 4M12 17.2v.01M12 3.5a8.5 8.5 0 100 17 8.5 8.5 0 000-17z",
    image: "M4 5h16v14H4zM4 16l4.5-4.5 4 4 3-3L20 17M15.5 9.2v.01",
    inside: "M12 4a8 8 0 100 16 8 8 0 000-16zM12 8.5a3.5 3.5 0 100 7 3.5 3.5 0 000-7zM12 1.5v5M12 17.5v5M1.5 12h5M17.5 12h5",
    link: "M10 14a4 4 0 005.7 0l3-3a4 4 0 00-5.7-5.7l-1 1M14 10a4 4 0 00-5.7 0l-3 3a4 4 0 005.7 5.7l1-1",
    menu: "M4 7h16M4 12h16M4 17h16",
    moon: "M19.5 14A8 8 0 019.9 4.5 8 8 0 1019.5 14z",
    open: "M4 19V6a1 1 0 011-1h4.5l2 2.5H19a1 1 0 011 1V19z",
    pause: "M9 6v12M15 6v12",
    reset: "M5 5v5h5M5.5 10a7.5 7.5 0 11-1 4",
    ruler: "M3 15.5L15.5 3 21 8.5 8.5 21zM6.500 12l2 2M9.500 9l3 3M12.500 6l2 2",
    sliders: "M4 7h9M17 7h3M4 17h3M11 17h9M15 5v4M9 15v4",
    sun: "M12 8a4 4 0 100 8 4 4 0 000-8zM12 2.5v2M12 19.5v2M2.5 12h2M19.5 12h2M5.3 5.3l1.400 1.400M17.3 17.3l1.400 1.400M5.3 18.7l1.400-1.400M17.3 6.7l1.400-1.400",
    traced: "M12 3.5v2.5M12 18v2.5M3.5 12H6M18 12h2.5M12 8.5a3.5 3.5 0 100 7 3.5 3.5 0 000-7zM6 6l1.7 1.7M16.3 16.3L18 18M6 18l1.7-1.7M16.3 7.7L18 6",
} as const;

/** The name of an icon. */
export type IconName = keyof typeof ICONS;

/** Makes an icon, which a screen reader passes over. */
export function icon(name: IconName): SVGSVGElement {
    const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    svg.setAttribute("viewBox", "0 0 24 24");
    svg.setAttribute("aria-hidden", "true");
    svg.classList.add("icon");
    const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
    path.setAttribute("d", ICONS[name]);
    svg.append(path);
    return svg;
}

/** Makes a button with an icon, a text or both. Without a text, `label` is what it is called. */
export function button(
    label: string,
    press: (event: MouseEvent) => void,
    { icon: name, text = true, hint, kind = "", id }: { icon?: IconName; text?: boolean; hint?: string; kind?: string; id?: string } = {},
): HTMLButtonElement {
    return make(
        "button",
        {
            type: "button",
            id,
            class: `button ${text ? "" : "square"} ${kind}`.trim(),
            "aria-label": text ? undefined : label,
            title: hint ?? (text && !kind.includes("wide") ? undefined : label),
            onclick: press,
        },
        name && icon(name),
        text && make("span", { class: "label" }, label),
    );
}

/** Replaces the content of an element; the control in it that has the focus gives it to the new one of the same id. */
export function refill(element: HTMLElement, ...children: Node[]): void {
    const root = element.getRootNode() as Document | ShadowRoot;
    const focused = root.activeElement;
    const id = element.contains(focused) ? focused?.id : undefined;
    element.replaceChildren(...children);
    if (id) {
        root.getElementById(id)?.focus();
    }
}

const isMac = /Mac|iP(hone|ad)/.test(navigator.platform);

/** Returns keys as they are written on this system. On a Mac, Ctrl+Space is the same key: ⌘+Space is the system's. */
export function keys(text: string): string {
    return isMac ? text.replaceAll(/Ctrl(?!\+Space)/g, "⌘").replaceAll("Alt", "⌥") : text;
}

/** Gives the reader a file. */
export function download(name: string, content: BlobPart, type: string): void {
    save(name, new Blob([content], { type }));
}

let save = (name: string, content: Blob): void => {
    const url = URL.createObjectURL(content);
    make("a", { href: url, download: name }).click();
    // The browser reads it after the click.
    setTimeout(() => URL.revokeObjectURL(url), 60_000);
};

/** Sets what gives files to the reader, where a browser's downloads are not to be had. */
export function saveBy(other: (name: string, content: Blob) => void): void {
    save = other;
}
