// Writes the package.json and README.md of the packed extension into a folder: with the publisher and the addresses that
// the environment names (PUBLISHER, REPOSITORY), without what only building needs.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [folder] = process.argv.slice(2);
const { PUBLISHER: publisher, REPOSITORY: repository } = process.env;
const manifest = JSON.parse(readFileSync("package.json", "utf8"));
delete manifest.scripts;
delete manifest.devDependencies;
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
