// Files that the reader opens: programs, and images for surfaces. What cannot be opened is refused with a sentence.

import { make } from "./dom.ts";

/** The longest files that are opened, in bytes. */
const LONGEST_PROGRAM = 4 << 20;
const LONGEST_IMAGE = 32 << 20;

/** What programs and images are to the browser's dialog. */
export const PROGRAMS = ".gtr,.crt,text/plain";
export const IMAGES = "image/png,image/jpeg";

/** Lets the reader choose a file. */
export function chooseFile(accept: string, take: (file: File) => void): void {
    const input = make("input", { type: "file", accept });
    input.addEventListener("change", () => {
        const file = input.files?.[0];
        if (file !== undefined) {
            take(file);
        }
    });
    input.click();
}

/** Returns whether a file is a program, by its name and type. */
export function isProgram(file: File): boolean {
    return /\.(gtr|crt|txt)$/i.test(file.name) || file.type.startsWith("text/");
}

/** Reads a program; fails with a sentence. */
export async function readProgram(file: File): Promise<{ name: string; text: string }> {
    if (file.size > LONGEST_PROGRAM) {
        throw new Error(`${file.name} is larger than 4 MB, the limit of this page. The command line reads larger programs.`);
    }
    const bytes = await file.arrayBuffer();
    try {
        const text = new TextDecoder("utf-8", { fatal: true }).decode(bytes);
        return { name: named(file.name), text: text.replaceAll(/\r\n?/g, "\n") };
    } catch {
        throw new Error(`${file.name} is not UTF-8 text, so it is not a program.`);
    }
}

/** Reads an image; fails with a sentence. */
export async function readImage(file: File): Promise<ArrayBuffer> {
    if (!IMAGES.split(",").includes(file.type)) {
        throw new Error(`${file.name} is neither a program (.gtr, .crt) nor an image (PNG, JPEG).`);
    }
    if (file.size > LONGEST_IMAGE) {
        throw new Error(`${file.name} is larger than 32 MB, the limit of a texture.`);
    }
    return file.arrayBuffer();
}

/** A file's name with the extension of a language, without characters that divide a path or are not seen. */
export function named(name: string): string {
    const trimmed = name.trim().replaceAll(/[\\/\p{Cc}\p{Cf}]/gu, "-").slice(0, 100) || "untitled.gtr";
    if (/\.(gtr|crt)$/i.test(trimmed)) {
        return trimmed.replace(/\.\w+$/, (end) => end.toLowerCase());
    }
    return `${trimmed.replace(/\.txt$/i, "")}.gtr`;
}
