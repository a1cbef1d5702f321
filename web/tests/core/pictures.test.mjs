// The pictures of all examples, in all their views, are byte for byte those of the native program.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { Session, examples, native } from "./open.mjs";

const SIZE = [200, 150];
/** The samples of a pixel of a traced picture. */
const SAMPLES = 2;

const folder = mkdtempSync(join(tmpdir(), "geotrace-pictures-"));
after(() => rmSync(folder, { recursive: true }));

function nativePicture(path, view, more = []) {
    const out = join(folder, "picture.png");
    // The page writes names from the start.
    const options = ["--view", view, "--size", SIZE.join("x"), "--backend", "software", "--labels", ...more];
    execFileSync(native(), ["render", path, "-o", out, ...options], { stdio: "pipe" });
    return readFileSync(out);
}

function assertSame(own, expected, what) {
    if (!own.equals(expected)) {
        assert.fail(`${what}: ${own.length} bytes are not the ${expected.length} of the native program`);
    }
}

/** The picture, or the sentence that says why there is none. */
function outcome(draw) {
    try {
        return draw();
    } catch (error) {
        return typeof error === "string" ? error : String(error.stderr);
    }
}

for (const { file, path, text } of examples()) {
    test(file, async () => {
        const session = await Session.start();
        const preferences = { samples: SAMPLES, traced: false };
        session.open(file, text, { preferences });
        assert.deepEqual(session.findings.filter((found) => found.severity === "error"), []);
        const views = session.scene.views.filter((view) => view.opensByItself);
        assert.ok(views.length > 0);
        for (const { id } of views) {
            assertSame(session.savePicture(id, ...SIZE), nativePicture(path, id), `${file} ${id}`);
        }
        // Of the views that are opened by hand, of solids and often many, one. Not each solid has a place for a camera.
        const other = session.scene.views.find((view) => !view.opensByItself);
        if (other !== undefined) {
            const [own, expected] = [
                () => session.savePicture(other.id, ...SIZE),
                () => nativePicture(path, other.id),
            ].map(outcome);
            if (Buffer.isBuffer(own) && Buffer.isBuffer(expected)) assertSame(own, expected, `${file} ${other.id}`);
            else assert.ok(String(expected).includes(String(own)), `${file} ${other.id}: ${own} is not ${expected}`);
        }
        const isSolid = file.endsWith(".crt") || session.scene.objects.some((object) => object.kind === "solid");
        if (isSolid) {
            session.tell("change", { patch: { preferences: { traced: true } } });
            const more = ["--samples", String(SAMPLES)];
            assertSame(session.savePicture("3d", ...SIZE), nativePicture(path, "traced", more), `${file} traced`);
        }
        session.close();
    });
}
