// Times of the core in Node, and the size of its download:
//   node web/tests/core/bench.mjs [EXAMPLE…]
// Times are in milliseconds, pictures have 400 × 400 pixels. "again" is the median of five other pictures of the same view: a
// camera that has moved on, drawn as a view at rest. "key" is an edit of a number, until its findings are there. "both" is
// such an edit until both views have a picture, maybe a coarse one; "fps" are the pairs of pictures a second while a key moves
// the camera of the geodesic view, or of the 3D view where there is no other.
import { existsSync, readFileSync } from "node:fs";
import { basename, join } from "node:path";
import { brotliCompressSync, gzipSync } from "node:zlib";
import { Session, examples, root } from "./open.mjs";

const SIDE = 400;
/** A traced picture at rest is not refined. */
const SETTINGS = { preferences: { samples: 1 } };
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

/** The time from an edit to the pictures of both views, and the pictures of each in a second of walking. */
function both(session, views, at) {
    session.tell("panes", { panes: views.map((view) => ({ view, width: SIDE, height: SIDE })) });
    session.rest(5000);
    const work = (until) => {
        const begin = performance.now() - session.now;
        for (;;) {
            session.now = performance.now() - begin;
            const count = session.pictures.length;
            session.step();
            const last = session.pictures.at(-1);
            if (session.pictures.length > count && last.pixels) session.tell("shown", { view: last.view });
            if (until()) return;
        }
    };
    const keys = Array.from({ length: 5 }, (_, k) => {
        session.edit([{ from: at, to: at + 1, insert: String(1 + (k % 9)) }]);
        const seen = session.pictures.length;
        // An edit in a comment shows nothing new.
        const late = performance.now() + 2000;
        const isSeen = (view) => session.pictures.slice(seen).some((it) => it.view === view);
        return timed(() => work(() => views.every(isSeen) || performance.now() > late));
    });
    session.open(session.file, session.text, SETTINGS);
    session.rest(5000);
    const view = views.at(-1);
    session.tell("hold", { view, keys: ["w", "d"], shift: false, alt: false });
    const end = performance.now() + 1000;
    const before = session.pictures.length;
    work(() => performance.now() > end);
    session.tell("hold", { view, keys: [], shift: false, alt: false });
    return { key: median(keys), rate: session.pictures.slice(before).filter((it) => it.view === view).length };
}

const cell = (time) => (time === null || time === undefined ? "–" : time.toFixed(time < 10 ? 2 : 0)).padStart(8);
console.log(`${"".padEnd(18)}${["check", "key", "3d", "again", "geodesic", "again", "both", "fps"].map((it) => it.padStart(8)).join("")}`);
for (const { file, text } of chosen) {
    const session = await Session.start();
    const check = timed(() => session.open(file, text, SETTINGS));
    const at = text.search(/\d/);
    const key = median(
        Array.from({ length: 9 }, (_, k) => {
            session.edit([{ from: at, to: at + 1, insert: String(1 + (k % 9)) }]);
            return timed(() => session.work());
        }),
    );
    session.open(file, text, SETTINGS);
    const space = pictureTimes(session, "3d");
    const inside = session.scene.views.find((view) => view.camera === "inside" && view.opensByItself);
    const geodesic = inside === undefined ? {} : pictureTimes(session, inside.id);
    Object.assign(session, { file, text });
    const pair = both(session, ["3d", ...(inside === undefined ? [] : [inside.id])], at);
    const times = [check, key, space.first, space.again, geodesic.first, geodesic.again, pair.key];
    console.log(file.padEnd(18) + times.map(cell).join("") + String(pair.rate).padStart(8));
    session.close();
}

// The language server for VS Code in a browser is built apart: `bash web/build server`.
const server = "editors/vscode/wasm/server_bg.wasm";
const files = ["web/src/core/core_bg.wasm", "web/src/core/core.js"];
for (const file of existsSync(join(root, server)) ? [...files, server] : files) {
    const bytes = readFileSync(join(root, file));
    console.log(`${basename(file)}: ${bytes.length} bytes, gzip ${gzipSync(bytes, { level: 9 }).length}, brotli ${brotliCompressSync(bytes).length}`);
}
