// The language cases: the core finds in each program what the native program finds.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { Session, native, root } from "./open.mjs";

const folder = mkdtempSync(join(tmpdir(), "geotrace-cases-"));
after(() => rmSync(folder, { recursive: true }));

/** The programs of a file of cases; the format is told in the README beside it. */
function cases(text) {
    const all = [];
    for (const line of text.split("\n")) {
        if (line.startsWith("=== ")) all.push({ title: line.slice(4), lines: [], directives: [] });
        const last = all.at(-1);
        if (last === undefined) continue;
        if (line.startsWith("% ")) last.directives.push(line.slice(2).trim());
        else if (line.startsWith("  ")) last.lines.push(line.slice(2));
    }
    return all.map(({ title, lines, directives }) => {
        // Line ends and marks of a byte order are the editor's: the page's text has none.
        let source = lines.map((line) => `${line}\n`).join("");
        if (directives.includes("no-newline")) source = source.replace(/\n$/, "");
        return { title, source };
    });
}

/** Line and column of an offset, from 1; columns are in characters. */
function position(source, offset) {
    const before = source.slice(0, offset);
    const line = before.split("\n").length;
    const column = [...before.slice(before.lastIndexOf("\n") + 1)].length + 1;
    return [line, column];
}

const casesFolder = join(root, "tests/cases/language");
for (const file of readdirSync(casesFolder).filter((file) => file.endsWith(".cases"))) {
    test(file, async () => {
        const ending = file.startsWith("crt_") ? "crt" : "gtr";
        const all = cases(readFileSync(join(casesFolder, file), "utf8"));
        assert.ok(all.length > 3, "the cases were read");
        const paths = all.map(({ source }, index) => {
            const path = join(folder, `${file}-${index}.${ending}`);
            writeFileSync(path, source);
            return path;
        });
        const checked = spawnSync(native(), ["check", "--format", "json", ...paths], { encoding: "utf8", maxBuffer: 1 << 28 });
        const { diagnostics } = JSON.parse(checked.stdout);
        let count = 0;
        for (const [index, { title, source }] of all.entries()) {
            const session = await Session.start();
            session.open(paths[index], source);
            const own = session.findings.map((found) => ({
                from: position(source, found.from),
                to: position(source, found.to),
                severity: found.severity,
                code: found.code,
                message: found.message,
                hint: found.hint,
            }));
            const expected = diagnostics
                .filter((it) => it.file === paths[index])
                .map((it) => ({
                    from: [it.line, it.column],
                    to: [it.end_line, it.end_column],
                    severity: it.severity,
                    code: it.code,
                    message: it.message,
                    hint: it.hint,
                }));
            assert.deepEqual(own, expected, title);
            count += own.length;
            session.close();
        }
        assert.equal(count, diagnostics.length);
    });
}
