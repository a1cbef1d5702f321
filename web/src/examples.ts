// The examples of the repository and the programs to begin with. Their texts are part of the page; the pictures in the
// gallery are fetched when it opens.

import curve from "../../examples/templates/curve.gtr?raw";
import metric from "../../examples/templates/metric.gtr?raw";
import solid from "../../examples/templates/solid.gtr?raw";
import surface from "../../examples/templates/surface.gtr?raw";

const texts = import.meta.glob<string>("../../examples/*.{gtr,crt}", { query: "?raw", import: "default", eager: true });
const pictures = import.meta.glob<string>("./gallery/*.webp", { query: "?url", import: "default", eager: true });

export interface Example {
    /** `torus.gtr`. */
    file: string;
    text: string;
    /** The first sentence of the comment that it begins with. */
    about: string;
    /** The address of its picture; absent where it has none. */
    picture: string | undefined;
}

/** All examples by their names, the scripts behind the programs. */
export const EXAMPLES: Example[] = Object.entries(texts)
    .map(([path, text]) => {
        const file = path.slice(path.lastIndexOf("/") + 1);
        return { file, text, about: aboutOf(text), picture: pictures[`./gallery/${file.replace(/\.\w+$/, "")}.webp`] };
    })
    .sort((a, b) => Number(a.file.endsWith(".crt")) - Number(b.file.endsWith(".crt")) || (a.file < b.file ? -1 : 1));

function aboutOf(text: string): string {
    const lines: string[] = [];
    for (const line of text.split("\n")) {
        const comment = /^\s*(?:#|--)\s?(.*)$/.exec(line);
        if (comment === null || comment[1] === "") {
            break;
        }
        lines.push(comment[1] ?? "");
    }
    return /^.*?\.(?=\s|$)/.exec(lines.join(" "))?.[0] ?? lines.join(" ");
}

/** The first program, which README has too. */
export const FIRST = `# A sphere, a point that two sliders move, and the direction in which u grows there.
param U = 4 : [0, 2pi];
param V = 1 : [0, pi];
function f(u, v) = (sin(v) cos(u), sin(v) sin(u), cos(v));
surface s(u, v) = f(u, v), u : [0, 2pi], v : [0, pi];
point p = f(U, V);
vector east = f_u(U, V) @ p;
`;

/** New programs: their title and text. */
export const TEMPLATES: { title: string; file: string; text: string }[] = [
    { title: "Empty", file: "untitled.gtr", text: "" },
    { title: "Curve", file: "curve.gtr", text: curve },
    { title: "Surface", file: "surface.gtr", text: surface },
    { title: "Metric", file: "metric.gtr", text: metric },
    { title: "Solid", file: "solid.gtr", text: solid },
    { title: "First program", file: "first.gtr", text: FIRST },
];
