// Makes the gallery's small pictures, `src/gallery/NAME.webp`, from those of the documentation: once they change, run
//   node thumbnails.mjs
// The test `gallery` fails where an example has none.
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
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
for (const [name, path] of [...from("docs/images/gallery", ""), ...from("docs/images", "crt-")]) {
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
