// The gallery of examples and the help: what a reader begins with.

import { openDialog } from "./dialogs.ts";
import { button, keys, make } from "./dom.ts";
import { EXAMPLES, type Example } from "./examples.ts";
import type { Scene } from "./protocol.ts";

/** Shows all examples; `choose` gets the one that is pressed. */
export function openGallery(choose: (example: Example) => void): void {
    const search = make("input", { class: "field", type: "search", placeholder: "Search", "aria-label": "Search the examples" });
    const cards = EXAMPLES.map((example) => {
        const press = () => {
            dialog.close();
            choose(example);
        };
        const image = make("img", { src: example.picture ?? "", alt: "", loading: "lazy", width: 240, height: 180 });
        const title = example.file.replace(/\.gtr$/, "");
        const text = make("span", {}, make("b", {}, title), example.about);
        return make("button", { type: "button", class: "card", onclick: press }, image, text);
    });
    search.addEventListener("input", () => {
        const words = search.value.toLowerCase().split(/\s+/);
        for (const card of cards) {
            const text = (card.textContent ?? "").toLowerCase();
            card.hidden = !words.every((word) => text.includes(word));
        }
    });
    const dialog = openDialog("Examples", [search, make("div", { class: "cards" }, ...cards)], { wide: true });
    search.focus();
}

const LANGUAGE: [string, string][] = [
    ["param r : [0, 1];", "a slider"],
    ["grid k : [0, 1, 5];", "five values; what uses k is drawn five times"],
    ["define a = 2pi;", "a name for a value"],
    ["function f(x, y) = x^2 + y;", "a function, of numbers or vectors"],
    ["curve c(t) = (cos t, sin t, 0), t : [0, 2pi];", "a curve"],
    ["surface s(u, v) = (u, v, u v), u : [0, 1], v : [0, 1];", "a surface"],
    ["point p = (1, 2, 3);", "a point"],
    ["vector v = c'2 @ p;", "a vector, drawn from p"],
    ["metric h(x, y) = (1, 0, 1)/y^2, x : [-2, 2], y : [1, 4];", "a surface by its E, F, G, seen from inside"],
    ["geodesic g(t) : s = (1, 2) @ (0, 0), t : [0, 1];", "the geodesic on s from a point in a direction"],
    ["solid b(x, y, z) = x^2 + y^2 + z^2 - 1;", "where the function is not positive"],
    ["solid s = a \\ b & c @ (1, 0, 0);", "a set: a | b union, a & b intersection, a \\ b difference, @ moves"],
    ["light l = @ (2, -2, 4);", "a light"],
    ["camera c = (0, 4, -1) @ (0, -4, 1);", "a camera: direction @ position"],
    ["background w = (0.8, 0.9, 1);", "a colour, or one for each direction"],
    ["f', f_u, f_u_v", "exact derivatives"],
    ["2x, a b", "the product; of two vectors the dot product"],
    ["a*b", "the product; of two vectors the cross product"],
];

const EDITOR_KEYS: [string, string][] = [
    ["Ctrl+Space", "words that fit here; Tab inserts one"],
    ["Ctrl+F", "find and replace"],
    ["Ctrl+/", "lines into comments and back"],
    ["F2", "rename what is at the cursor"],
    ["F12, Ctrl+click", "go to the declaration"],
    ["Shift+Alt+F", "format"],
    ["Ctrl+.", "apply all fixes"],
    ["Escape, then Tab", "leave the editor"],
];

const VIEW_KEYS: [string, string, string][] = [
    ["drag", "turn about the target", "walk"],
    ["Alt + drag", "look around", ""],
    ["right drag, Shift + drag", "move sideways", "walk"],
    ["wheel, pinch", "zoom towards the pointer", "zoom about the middle"],
    ["W S A D", "forward, back, left, right", "walk"],
    ["Q E", "up, down", "turn"],
    ["Z X", "", "zoom in, out"],
    ["arrows", "look around; Alt: turn, Shift: move sideways", "walk"],
    ["+ −", "nearer, farther", "zoom in, out"],
    ["F", "frame everything", ""],
    ["1 3 7", "front, right, top; with Shift the other side", ""],
    ["5", "perspective, orthographic", ""],
    ["T", "traced: lights, shadows, mirrors, glass", ""],
    ["R", "reset the camera", "reset the camera"],
    ["click, Enter", "put the geodesic camera there", ""],
    ["double click, Ctrl+Enter", "show the declaration", "show the declaration"],
    ["M", "measure", "measure"],
    ["Ctrl+Z, Ctrl+Shift+Z", "undo, redo", "undo, redo"],
    ["F6, Shift+F6", "the next view, the one before", "the next view, the one before"],
];

/** Shows the language on one page, and all keys. */
export function openHelp(scene: Scene | undefined): void {
    const row = (cells: (Node | string)[]) => make("tr", {}, ...cells.map((cell) => make("td", {}, cell)));
    const head = (cells: string[]) => make("tr", {}, ...cells.map((cell) => make("th", { scope: "col" }, cell)));
    const code = (text: string) => make("code", {}, text);
    openDialog(
        "Help",
        [
            make(
                "p",
                {},
                "A program is a list of declarations, and each may use the ones above it. The pictures follow while you type. ",
                "The geodesic view shows what an inhabitant of the surface sees: light runs along the surface, and the middle of the picture is where you stand.",
            ),
            make("h3", {}, "The language"),
            make("table", {}, ...LANGUAGE.map(([text, about]) => row([code(text), about]))),
            make("h3", {}, "The pictures"),
            make(
                "table",
                {},
                head(["", "3D view", "from inside"]),
                ...VIEW_KEYS.map(([key, space, inside]) => row([keys(key), space, inside])),
            ),
            make("h3", {}, "The editor"),
            make("table", {}, ...EDITOR_KEYS.map(([key, about]) => row([keys(key), about]))),
            make(
                "p",
                { class: "empty" },
                "Drop an image on a surface to show it there, and a program on the page to open it. ",
                "Programs, images and links stay in this browser: nothing is sent anywhere.",
                scene === undefined ? " The core has not started yet." : "",
            ),
        ],
        { wide: true },
    );
}

/** The first screen: what the program does, and what to try. It is part of the page, so that all can be tried at once. */
export function welcome(act: { gallery(): void; help(): void; close(): void }): HTMLElement {
    const link = (label: string, press: () => void) =>
        make("button", { type: "button", class: "button outline", onclick: press }, label);
    const steps = [
        ["Move the slider ", make("code", {}, "U"), ": the point walks around the sphere."],
        ["Click the sphere to stand there. The geodesic view is what you see if light follows the surface; drag it to walk."],
        ["Write ", make("code", {}, "2sin(v) cos(u)"), " for ", make("code", {}, "sin(v) cos(u)"), " in the program: the pictures follow."],
    ];
    return make(
        "aside",
        { class: "welcome", "aria-label": "First steps" },
        make(
            "header",
            {},
            make("h2", {}, "Curves, surfaces and solids, as short programs"),
            button("Close the first steps", act.close, { icon: "close", text: false }),
        ),
        make("ol", {}, ...steps.map((step) => make("li", {}, ...step))),
        make("div", { class: "actions" }, link("Examples", act.gallery), link("The language", act.help)),
    );
}
