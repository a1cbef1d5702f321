// Checks every message that a server sent against the protocol's types, strictly: unknown fields, wrong kinds of number
// and missing fields are faults.
//
//   node validate.mjs TRANSCRIPT.jsonl…
//
// A transcript holds one message a line: {"from": "client" | "server", "message": {…}}. Exit status: 0 all are valid,
// 1 some are not, 2 there was nothing to check.
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import Ajv from "ajv";
import { createGenerator } from "ts-json-schema-generator";

const here = dirname(fileURLToPath(import.meta.url));
const schema = createGenerator({
    path: join(here, "types.ts"),
    type: "Messages",
    additionalProperties: false,
    strictTuples: true,
    skipTypeCheck: true,
}).createSchema("Messages");
Object.assign(schema.definitions.uinteger, { type: "integer", minimum: 0, maximum: 2 ** 31 - 1 });
Object.assign(schema.definitions.integer, { type: "integer", minimum: -(2 ** 31), maximum: 2 ** 31 - 1 });
const ajv = new Ajv({ allErrors: true, allowUnionTypes: true, strict: false });
ajv.addSchema(schema, "protocol");

/** The checker of one kind of message; none where the method is not one that the server may use. */
function checker(group, method) {
    const name = { results: "Results", notifications: "Notifications", requests: "Requests" }[group];
    const known = schema.definitions[name].properties[method];
    const escaped = method.replaceAll("~", "~0").replaceAll("/", "~1");
    return known && ajv.getSchema(`protocol#/definitions/${name}/properties/${encodeURIComponent(escaped)}`);
}
const checkError = ajv.getSchema("protocol#/definitions/ResponseError");

let checked = 0;
const faults = [];
for (const file of process.argv.slice(2)) {
    const methods = new Map();
    readFileSync(file, "utf8").split("\n").forEach((line, index) => {
        if (line === "") {
            return;
        }
        const { from, message } = JSON.parse(line);
        if (from === "client") {
            if (message.method !== undefined && message.id !== undefined) {
                methods.set(JSON.stringify(message.id), message.method);
            }
            return;
        }
        checked += 1;
        const fault = (text) => faults.push(`${file}:${index + 1}: ${text}`);
        if (message.jsonrpc !== "2.0") {
            fault("not JSON-RPC 2.0");
        }
        const run = (check, value, what) => {
            if (check === undefined) {
                fault(`${what}: not a method that the server may use`);
            } else if (!check(value)) {
                const first = check.errors.slice(0, 4).map((e) => `${e.instancePath || "/"} ${e.message} ${JSON.stringify(e.params)}`);
                fault(`${what}: ${first.join("; ")}`);
            }
        };
        if (message.method !== undefined) {
            const group = message.id === undefined ? "notifications" : "requests";
            run(checker(group, message.method), message.params ?? null, message.method);
        } else if (message.error !== undefined) {
            run(checkError, message.error, "an error");
        } else {
            const method = methods.get(JSON.stringify(message.id));
            if (method === undefined) {
                fault(`an answer to nothing: id ${JSON.stringify(message.id)}`);
            } else {
                run(checker("results", method), message.result, `the result of ${method}`);
            }
        }
    });
}
for (const fault of faults.slice(0, 50)) {
    console.error(fault);
}
console.log(`${checked} messages of the server checked, ${faults.length} faults`);
process.exit(faults.length > 0 ? 1 : checked === 0 ? 2 : 0);
