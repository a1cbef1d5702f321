// Writes the fonts of pictures without what no picture reads, above all the instructions for screens of few pixels. Every
// letter keeps its outline, so pictures stay the same, byte for byte.
//   node web/fonts.mjs OUT
// `geotrace-render` takes them in place of the whole ones where it is built with `--cfg reduced_fonts` and OUT in
// GEOTRACE_FONTS.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import subset from 'subset-font';

const out = process.argv[2];
const metadata = JSON.parse(execFileSync('cargo', ['metadata', '--format-version', '1', '--locked'], { maxBuffer: 1 << 28 }));
const manifest = metadata.packages.find((crate) => crate.name === 'epaint_default_fonts').manifest_path;

// All of Unicode but for the surrogates, which are no letters.
const codes = Array.from({ length: 0x20000 - 0x20 }, (_, k) => 0x20 + k).filter((code) => code < 0xd800 || code > 0xdfff);
const letters = codes.map((code) => String.fromCodePoint(code)).join('');
mkdirSync(out, { recursive: true });
for (const name of ['Ubuntu-Light.ttf', 'Hack-Regular.ttf']) {
  const whole = readFileSync(path.join(path.dirname(manifest), 'fonts', name));
  const reduced = await subset(whole, letters, { targetFormat: 'sfnt', noHinting: true });
  const file = path.join(out, name);
  // One that is written anew is compiled anew, with all that draws.
  if (!existsSync(file) || !readFileSync(file).equals(reduced)) {
    writeFileSync(file, reduced);
  }
}
