// After any edits the core has found what it finds in the text that they lead to, with the same colours.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Session, examples, random } from "./open.mjs";

const EDITS = 3000;
/** The edits between two comparisons with the text opened anew. */
const STRIDE = 5;
const PIECES = ["", "", "x", "r", "1", "(", ")", ";", ",", "\n", " ", "=", "# ", "π", "𝕊", "^2", "param q = 1 : [0, 2];\n", "point p = (1, 2, 3);\n", "sin", "u", "_"];
const SCRIPT_PIECES = ["", "", "x", "1", "(", ")", ",", "\n", " ", "=", "->", "-- ", "π", "𝕊", "{", "}", "a = 2\n", "Sphere { }\n", "if", "vec(1, 2, 3)"];

function randomEdits(text, next, pieces) {
    const count = 1 + (next() % 2);
    const places = Array.from({ length: 2 * count }, () => next() % (text.length + 1)).sort((a, b) => a - b);
    // No place lies inside a pair of surrogates: an editor has none there.
    const outside = (at) => (/[\uDC00-\uDFFF]/.test(text[at] ?? "") ? at - 1 : at);
    const changes = [];
    for (let k = 0; k < count; k += 1) {
        const from = outside(places[2 * k]);
        const to = Math.max(from, outside(Math.min(places[2 * k + 1], from + (next() % 8))));
        changes.push({ from, to, insert: pieces[next() % pieces.length] });
    }
    return changes;
}

function applied(text, changes) {
    let result = text;
    for (const { from, to, insert } of [...changes].reverse()) result = result.slice(0, from) + insert + result.slice(to);
    return result;
}

// Of all kinds of declarations, and small: a program of a million operations is not run thousands of times.
const begun = ["torus.gtr", "trefoil.gtr", "dice.gtr", "rays.gtr", "lens.gtr", "spheres.crt", "mirror_room.crt"];
for (const [number, file] of begun.entries()) {
    test(file, async () => {
        const { text: first } = examples().find((it) => it.file === file);
        const next = random(1000 + number);
        const pieces = file.endsWith(".crt") ? SCRIPT_PIECES : PIECES;
        const edited = await Session.start();
        edited.open(file, first);
        const fresh = await Session.start();
        let text = first;
        let compared = 0;
        for (let k = 0; k < EDITS / begun.length; k += 1) {
            if (next() % 40 === 0) {
                const before = text;
                edited.edit([{ from: 0, to: before.length, insert: first }]);
                text = first;
            } else {
                const changes = randomEdits(text, next, pieces);
                edited.edit(changes);
                text = applied(text, changes);
            }
            if (k % STRIDE !== 0) continue;
            edited.work();
            fresh.open(file, text);
            assert.deepEqual(edited.findings, fresh.findings, `after ${k} edits:\n${text}`);
            assert.deepEqual(edited.tokens(0, text.length), fresh.tokens(0, text.length), `after ${k} edits:\n${text}`);
            compared += 1;
        }
        assert.ok(compared > 50 && edited.events.every(({ event }) => event !== "resync"));
        edited.close();
        fresh.close();
    });
}
