// Writes the licences of all that is packed for a platform, each text once: what the program and the core of the page are
// linked with, and what the scripts of the page and of the extension for VS Code contain. Fails where a package has no licence
// text, and where the licence is none of those that deny.toml allows.
//   node .ci/notices.mjs PLATFORM FILE
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const TARGETS = {
    "linux-x64": "x86_64-unknown-linux-gnu",
    "linux-arm64": "aarch64-unknown-linux-gnu",
    "darwin-x64": "x86_64-apple-darwin",
    "darwin-arm64": "aarch64-apple-darwin",
    "win32-x64": "x86_64-pc-windows-msvc",
    web: "wasm32-unknown-unknown",
};
const root = dirname(dirname(fileURLToPath(import.meta.url)));
const [platform, out] = process.argv.slice(2);
if (!(platform in TARGETS) || !out) {
    console.error(`usage: node .ci/notices.mjs ${Object.keys(TARGETS).join("|")} FILE`);
    process.exit(2);
}

/** What crates of the workspace are linked with on a platform, the workspace left out. */
function linked(programs, target) {
    const options = ["metadata", "--locked", "--format-version", "1", "--filter-platform", target];
    const metadata = JSON.parse(execFileSync("cargo", options, { cwd: root, encoding: "utf8", maxBuffer: 2 ** 28 }));
    const nodes = new Map(metadata.resolve.nodes.map((node) => [node.id, node]));
    const packages = new Map(metadata.packages.map((one) => [one.id, one]));
    const found = new Set();
    const open = metadata.packages.filter((one) => programs.includes(one.name)).map((one) => one.id);
    for (let id = open.pop(); id !== undefined; id = open.pop()) {
        if (!found.has(id)) {
            found.add(id);
            const normal = nodes.get(id).deps.filter((to) => to.dep_kinds.some((kind) => kind.kind === null));
            open.push(...normal.map((to) => to.pkg));
        }
    }
    const others = [...found].map((id) => packages.get(id)).filter((one) => one.source !== null);
    if (others.length === 0) {
        faults.push(`nothing is linked: is there a package ${programs.join(" or ")}?`);
    }
    return others;
}

const allowed = new Set(
    /^allow = \[([^\]]*)\]/m
        .exec(readFileSync(join(root, "deny.toml"), "utf8"))[1]
        .split(",")
        .map((name) => name.trim().replaceAll('"', ""))
        .filter((name) => name !== ""),
);

// Permissive, of a package of JavaScript: deny.toml may name none that no crate has.
allowed.add("BlueOak-1.0.0");

/** Whether an SPDX expression can be met by allowed licences. */
function isAllowed(expression) {
    const words = expression.replaceAll("/", " OR ").match(/[()]|[^\s()]+/g) ?? [];
    let at = 0;
    const either = () => {
        let met = both();
        while (words[at] === "OR") {
            at += 1;
            met = both() || met;
        }
        return met;
    };
    const both = () => {
        let met = one();
        while (words[at] === "AND") {
            at += 1;
            met = one() && met;
        }
        return met;
    };
    const one = () => {
        const word = words[at];
        at += 1;
        if (word === "(") {
            const met = either();
            at += 1;
            return met;
        }
        const exception = words[at] === "WITH";
        at += exception ? 2 : 0;
        return allowed.has(word) && !exception;
    };
    return either();
}

const IS_LICENCE = /^(licen[cs]e|copying|copyright|notice|unlicense|ofl|ufl)/i;

/** The licence files of a package: beside its manifest, in folders below, and each text beside a font. */
function texts(one) {
    const folder = dirname(one.manifest_path);
    const entries = readdirSync(folder, { withFileTypes: true, recursive: true });
    return entries
        .filter((entry) => entry.isFile())
        .map((entry) => join(entry.parentPath ?? entry.path, entry.name))
        .filter((path) => (IS_LICENCE.test(basename(path)) && !path.endsWith(".rs")) || /\bfonts\b.*\.txt$/.test(path))
        .sort()
        .map((path) => readFileSync(path, "utf8").replaceAll("\r\n", "\n").trim());
}

/** The text of a licence that a package names and does not bring along. */
function standard(one) {
    if (/Apache-2\.0/.test(one.license)) {
        return readFileSync(join(root, "LICENSE-APACHE"), "utf8").trim();
    }
    if (/MIT/.test(one.license)) {
        const owner = one.authors.join(", ") || `the authors of ${one.name}`;
        return readFileSync(join(root, "LICENSE-MIT"), "utf8").replace(/^Copyright.*$/m, `Copyright (c) ${owner}`).trim();
    }
    if (/BSL-1\.0/.test(one.license)) {
        return "Boost Software License 1.0, https://www.boost.org/LICENSE_1_0.txt: programs in machine code need no notice.";
    }
    return undefined;
}

/** A package of JavaScript, as cargo describes packages. */
function script(folder) {
    const path = join(folder, "package.json");
    return { authors: [], ...JSON.parse(readFileSync(path, "utf8")), repository: undefined, manifest_path: path };
}

/** The folder of a project of JavaScript, with what it needs. */
function installed(folder) {
    if (!existsSync(join(folder, "node_modules"))) {
        // On Windows npm is a script of the shell.
        const where = { cwd: folder, stdio: ["ignore", "ignore", "inherit"], shell: process.platform === "win32" };
        execFileSync("npm", ["ci", "--no-audit", "--no-fund"], where);
    }
    return folder;
}

/** The packages in the page and in the preview inside VS Code. */
function inPage() {
    const folder = installed(join(root, "web"));
    const lock = JSON.parse(readFileSync(join(folder, "package-lock.json"), "utf8"));
    const places = Object.keys(lock.packages).filter((place) => place !== "" && !lock.packages[place].dev);
    return places.map((place) => script(join(folder, place)));
}

/** The packages in the extension for VS Code: those whose files its bundle contains. */
function inExtension() {
    const folder = installed(join(root, "editors/vscode"));
    const entries = platform === "web" ? ["src/browser.ts", "src/worker.ts"] : ["src/extension.ts"];
    const { metafile } = createRequire(join(folder, "package.json"))("esbuild").buildSync({
        absWorkingDir: folder,
        entryPoints: entries,
        bundle: true,
        metafile: true,
        write: false,
        outdir: "dist",
        external: ["vscode", "../wasm/*"],
        format: "cjs",
        platform: platform === "web" ? "browser" : "node",
        logLevel: "error",
    });
    const inputs = Object.keys(metafile.inputs).map((path) => /^.*node_modules\/(@[^/]+\/)?[^/]+/.exec(path)?.[0]);
    const folders = new Set(inputs.filter((path) => path !== undefined));
    if (folders.size === 0) {
        faults.push("the extension contains no package: is its bundle another one?");
    }
    return [...folders].map((path) => script(join(folder, path)));
}

const faults = [];
const rust =
    platform === "web"
        ? linked(["geotrace-web", "geotrace-web-server"], TARGETS.web)
        : [...linked(["geotrace"], TARGETS[platform]), ...linked(["geotrace-web"], TARGETS.web)];
const named = new Map([...rust, ...inPage(), ...inExtension()].map((one) => [`${one.name} ${one.version}`, one]));
const packages = [...named].sort(([a], [b]) => (a < b ? -1 : 1)).map(([, one]) => one);
const users = new Map();
for (const one of packages) {
    if (!isAllowed(one.license ?? "")) {
        faults.push(`${one.name} ${one.version}: deny.toml does not allow its licence, ${one.license ?? "none"}`);
    }
    let found = texts(one);
    if (found.length === 0) {
        found = [standard(one)].filter((text) => text !== undefined);
    }
    if (found.length === 0) {
        faults.push(`${one.name} ${one.version}: no licence text`);
    }
    for (const text of found) {
        users.set(text, [...(users.get(text) ?? []), `${one.name} ${one.version}`]);
    }
}
if (faults.length > 0) {
    console.error(faults.join("\n"));
    process.exit(1);
}

const line = "-".repeat(80);
const list = packages.map((one) => `${one.name} ${one.version}: ${one.license}${one.repository ? `, ${one.repository}` : ""}`);
const all = [...users].map(([text, names]) => `${line}\n${[...new Set(names)].join(", ")}\n${line}\n\n${text}\n`);
writeFileSync(out, `Geotrace contains these packages, under these licences:\n\n${list.join("\n")}\n\n${all.join("\n")}`);
