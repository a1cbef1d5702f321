// The Worker of the language server in a browser. The first message is the WebAssembly; the others are the editor's, and so
// are the answers.
//
// Messages come first: each piece of work of the server is a task of its own, before which whatever has come is heard.

import { initSync, LanguageServer } from "../wasm/server.js";

let server: LanguageServer | undefined;

// A channel's message is a task, as a timer is, but without a timer's least delay.
const turn = new MessageChannel();
turn.port1.onmessage = () => {
    if (server?.turn()) {
        answer();
    }
};

/** Sends what the server has said, and lets it work. */
function answer(): void {
    for (const said of server?.takeSaid() ?? []) {
        postMessage(JSON.parse(said));
    }
    turn.port2.postMessage(null);
}

onmessage = ({ data }: MessageEvent<unknown>) => {
    if (server === undefined) {
        initSync({ module: data as BufferSource });
        server = new LanguageServer();
    } else {
        server.hear(JSON.stringify(data));
        answer();
    }
};
