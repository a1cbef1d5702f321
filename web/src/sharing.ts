// The button *Copy link*: the program and its settings as one address.

import type { Core } from "./core.ts";
import { attempt, openDialog, say } from "./dialogs.ts";
import { make } from "./dom.ts";
import { packed } from "./link.ts";
import type { Settings } from "./protocol.ts";
import type { Kept } from "./store.ts";

/** A link that is longer, in characters, is cut off by some programs. */
const LONG_LINK = 30_000;

/** Puts the link to a program and its settings on the clipboard and into the address. */
export async function copyLink(core: Core, { name, text }: Kept): Promise<void> {
    await attempt(async () => {
        // A Worker that does not answer shall not keep the reader from the link.
        const known = await Promise.race([
            core.call("settings", {}).catch(() => core.settings),
            new Promise<undefined>((resolve) => setTimeout(() => resolve(undefined), 1500)),
        ]);
        const settings = withCameras(known ?? core.settings);
        const hash = await packed({ name, text, settings });
        const url = `${location.href.replace(/#.*$/, "")}#${hash}`;
        history.replaceState(null, "", `#${hash}`);
        const images = (settings.textures ?? []).length > 0 ? " Images are not part of it." : "";
        const long = url.length > LONG_LINK ? " It is long, and some programs truncate it: send the file instead." : "";
        try {
            await navigator.clipboard.writeText(url);
            say(`The link to this program and its settings is copied.${images}${long}`);
        } catch {
            // Without the right to the clipboard, the reader copies it.
            const field = make("textarea", { class: "field", rows: 5, readOnly: true, value: url, "aria-label": "Link" });
            openDialog("Link", [make("p", {}, `Copy this link.${images}${long}`), field]);
            field.select();
        }
    });
}

/**
 * Settings whose cameras stay where they are. One that nobody has moved is put anew where a program opens, and would stand
 * elsewhere where params have other values than the text's.
 */
function withCameras(settings: Settings): Settings {
    if (Object.keys(settings.params ?? {}).length === 0) {
        return settings;
    }
    const inside = Object.entries(settings.inside ?? {}).map(([name, camera]) => [name, { ...(camera as object), moved: true }]);
    const space = settings.space && { ...settings.space, moved: true };
    return { ...settings, ...(space && { space }), inside: Object.fromEntries(inside) as Record<string, unknown> };
}
