// Texts that nest as deep as they can, and scripts that call themselves, end in findings: a Worker has a small stack.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Session } from "./open.mjs";

const N = 100_000;
const programs = {
    "brackets.gtr": `define a = ${"(".repeat(N)}1${")".repeat(N)};`,
    "powers.gtr": `define a = ${"2^".repeat(N)}2;`,
    "signs.gtr": `define a = ${"-".repeat(N)}2;`,
    "calls.gtr": `define a = ${"sin(".repeat(N)}1${")".repeat(N)};`,
    "functions.gtr": `function f(x) = x + 1;\ndefine a = ${"f(".repeat(5000)}1${")".repeat(5000)};`,
    "chain.gtr": Array.from({ length: 3000 }, (_, k) => `function f${"abcdefghij"[k % 10]}${k}(x) = x + ${k};`).join("\n"),
    "derivatives.gtr": `function f(x) = sin(x)${"'".repeat(500)};\nfunction g(x) = f${"'".repeat(40)}(x);\ndefine a = g(1);`,
    "solids.gtr": `solid s(x,y,z) = ${"(".repeat(2000)}x${")".repeat(2000)};\nsolid t = ${"(".repeat(N)}s${")".repeat(N)};`,
    "brackets.crt": `a = ${"(".repeat(N)}1${")".repeat(N)}`,
    "signs.crt": `a = ${"-".repeat(N)}2`,
    "sums.crt": `a = 1${" + 1".repeat(N)}`,
    "blocks.crt": `${"Scene { ".repeat(N)}${"}".repeat(N)}`,
    "lists.crt": `a = ${"[".repeat(N)}${"]".repeat(N)}`,
    "itself.crt": "m = Macro (n) { m(n + 1) }\nm(1)",
    "ifs.crt": `m = Macro (n) { ${"if (n > 0) { ".repeat(200)} m(n + 1) ${"}".repeat(200)} }\nm(1)`,
    "loops.crt": `m = Macro (n) { ${"while (true) { ".repeat(200)} m(n + 1) ${"}".repeat(200)} }\nm(1)`,
    "terms.crt": `m = Macro (n) { x = ${"(1 + ".repeat(200)} m(n + 1) ${")".repeat(200)} }\nm(1)`,
    "arguments.crt": `m = Macro (n) { x = ${"vec3(0, 0, length(".repeat(100)} m(n + 1) ${"))".repeat(100)} }\nm(1)`,
};
for (const [name, text] of Object.entries(programs)) {
    test(name, async () => {
        const session = await Session.start();
        session.open(name, text);
        session.tokens(0, text.length);
        session.call("format", { range: null });
        session.call("hover", { at: Math.floor(text.length / 2) });
        session.call("complete", { at: Math.floor(text.length / 2) });
        assert.ok(session.scene !== null);
        // A text that calls itself never ends by itself.
        const itself = text.includes("m(n + 1)");
        assert.equal(session.findings.some((found) => found.code === "call-depth" || found.code === "work-limit"), itself);
        session.close();
    });
}
