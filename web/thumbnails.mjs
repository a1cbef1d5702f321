// Makes the gallery's small pictures, `src/gallery/NAME.webp`, from those of the documentation: once they change, run
//   GEOTRACE_BIN=PROGRAM node thumbnails.mjs
// PROGRAM draws what the documentation has no picture of. A test fails where an example has none.
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, extname, join } from "node:path";
import { launch } from "./tests/page/browser.mjs";

const [WIDTH, HEIGHT] = [240, 180];
const root = join(import.meta.dirname, "..");
const from = (folder, prefix) =>
    readdirSync(join(root, folder))
        .filter((file) => file.startsWith(prefix) && file.endsWith(".png"))
        .map((file) => [file.slice(prefix.length, -4), join(root, folder, file)]);

const browser = await launch();
const page = await browser.newPage();
mkdirSync(join(root, "web/src/gallery"), { recursive: true });
const pictures = new Map([...from("docs/images/gallery", ""), ...from("docs/images", "crt-")]);
const scratch = mkdtempSync(join(tmpdir(), "geotrace-thumbnails-"));
for (const file of readdirSync(join(root, "examples"))) {
    const name = basename(file, extname(file));
    if (!pictures.has(name)) {
        const path = join(scratch, `${name}.png`);
        const program = process.env.GEOTRACE_BIN ?? "geotrace";
        execFileSync(program, ["render", join(root, "examples", file), "-o", path, "--view", "traced", "--size", `${2 * WIDTH}x${2 * HEIGHT}`]);
        pictures.set(name, path);
    }
}
for (const [name, path] of pictures) {
    const url = `data:image/png;base64,${readFileSync(path).toString("base64")}`;
    const webp = await page.evaluate(
        async ([url, width, height]) => {
            const image = new Image();
            image.src = url;
            await image.decode();
            const canvas = Object.assign(document.createElement("canvas"), { width, height });
            const scale = Math.max(width / image.width, height / image.height);
            const [across, down] = [image.width * scale, image.height * scale];
            const context = canvas.getContext("2d");
            context.imageSmoothingQuality = "high";
            context.drawImage(image, (width - across) / 2, (height - down) / 2, across, down);
            return canvas.toDataURL("image/webp", 0.72).split(",")[1];
        },
        [url, WIDTH, HEIGHT],
    );
    writeFileSync(join(root, "web/src/gallery", `${name}.webp`), Buffer.from(webp, "base64"));
}
await browser.close();
