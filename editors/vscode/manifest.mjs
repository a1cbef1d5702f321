// Writes the package.json, README.md and examples.json of the packed extension into a folder: with the publisher and the
// addresses that the environment names (PUBLISHER, REPOSITORY), without what only building or another TARGET needs.
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";

const [folder] = process.argv.slice(2);
const { PUBLISHER: publisher, REPOSITORY: repository, TARGET: target } = process.env;
const manifest = JSON.parse(readFileSync("package.json", "utf8"));
delete manifest.scripts;
delete manifest.devDependencies;
if (target === "web") {
    delete manifest.main;
    delete manifest.capabilities;
    // The command needs a program.
    const { commands, menus, walkthroughs } = manifest.contributes;
    for (const entries of [commands, ...Object.values(menus), ...walkthroughs.map(({ steps }) => steps)]) {
        const isKept = (entry) => !JSON.stringify(entry).includes("geotrace.exportPicture");
        entries.splice(0, entries.length, ...entries.filter(isKept));
    }
} else {
    delete manifest.browser;
}
if (publisher) {
    manifest.publisher = publisher;
}
let readme = readFileSync("README.md", "utf8");
if (repository) {
    manifest.repository = { type: "git", url: repository };
    manifest.homepage = `${repository}#readme`;
    manifest.bugs = { url: `${repository}/issues` };
    readme = readme.replaceAll("](../../", `](${repository}/raw/HEAD/`);
} else {
    // The marketplace shows pictures from a public address only.
    readme = readme.replaceAll(/^!\[[^\]]*\]\(\.\.\/\.\.\/[^)]*\)\n\n/gm, "");
}
writeFileSync(join(folder, "package.json"), JSON.stringify(manifest, undefined, 2));
writeFileSync(join(folder, "README.md"), readme);
// A browser reads files of the extension, but lists no folder.
const folderOfExamples = "../../examples";
const names = readdirSync(folderOfExamples).filter((name) => name.endsWith(".gtr"));
const texts = names.sort().map((name) => [basename(name, ".gtr"), readFileSync(join(folderOfExamples, name), "utf8")]);
writeFileSync(join(folder, "examples.json"), JSON.stringify(Object.fromEntries(texts)));
