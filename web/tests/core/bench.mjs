// Times of the core in Node, and the size of its download:
//   node web/tests/core/bench.mjs [EXAMPLE…]
// Times are in milliseconds, pictures have 400 × 400 pixels. "again" is the median of five other pictures of the same view: a
// camera that has moved on, drawn as a view at rest. "key" is an edit of a number, until its findings are there.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { brotliCompressSync, gzipSync } from "node:zlib";
import { Session, examples, root } from "./open.mjs";

const SIDE = 400;
const wanted = process.argv.slice(2);
const chosen = examples().filter(({ file }) => wanted.length === 0 || wanted.some((name) => file.startsWith(name)));

function timed(work) {
    const start = performance.now();
    work();
    return performance.now() - start;
}

function median(times) {
    return times.sort((a, b) => a - b)[Math.floor(times.length / 2)];
}

/** The first picture of a view, and the median of others, without the steps between. */
function pictureTimes(session, view) {
    session.tell("panes", { panes: [{ view, width: SIDE, height: SIDE }] });
    const draw = () => {
        const before = session.pictures.length;
        session.now += 1000;
        const time = timed(() => session.work());
        const last = session.pictures.at(-1);
        if (session.pictures.length === before || !last.pixels) return null;
        session.tell("shown", { view });
        return time;
    };
    const first = draw();
    const again = [];
    for (let k = 0; k < 5 && first !== null; k += 1) {
        session.tell("drag", { view, grip: "orbit", by: [7, 3] });
        session.tell("release");
        const time = draw();
        if (time !== null) again.push(time);
    }
    return { first, again: again.length > 0 ? median(again) : null };
}

const cell = (time) => (time === null || time === undefined ? "–" : time.toFixed(time < 10 ? 2 : 0)).padStart(8);
console.log(`${"".padEnd(18)}${["check", "key", "3d", "again", "geodesic", "again"].map((it) => it.padStart(8)).join("")}`);
for (const { file, text } of chosen) {
    const session = await Session.start();
    const check = timed(() => session.open(file, text));
    const at = text.search(/\d/);
    const key = median(
        Array.from({ length: 9 }, (_, k) => {
            session.edit([{ from: at, to: at + 1, insert: String(1 + (k % 9)) }]);
            return timed(() => session.work());
        }),
    );
    session.open(file, text);
    const space = pictureTimes(session, "3d");
    const inside = session.scene.views.find((view) => view.camera === "inside" && view.opensByItself);
    const geodesic = inside === undefined ? {} : pictureTimes(session, inside.id);
    console.log(file.padEnd(18) + [check, key, space.first, space.again, geodesic.first, geodesic.again].map(cell).join(""));
    session.close();
}

const built = join(root, "web/src/core");
for (const name of ["core_bg.wasm", "core.js"]) {
    const bytes = readFileSync(join(built, name));
    console.log(`${name}: ${bytes.length} bytes, gzip ${gzipSync(bytes, { level: 9 }).length}, brotli ${brotliCompressSync(bytes).length}`);
}
