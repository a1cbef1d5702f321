// What the tests use of Node's `assert`, where there is no Node.
const fail = (message) => {
    throw new Error(message);
};
const same = (a, b) => {
    if (Object.is(a, b)) {
        return true;
    }
    if (typeof a !== "object" || typeof b !== "object" || a === null || b === null || Array.isArray(a) !== Array.isArray(b)) {
        return false;
    }
    const [these, those] = [Object.keys(a), Object.keys(b)];
    return these.length === those.length && these.every((key) => same(a[key], b[key]));
};

exports.ok = (value, message) => value || fail(message ?? "not true");
exports.strictEqual = (a, b, message) => Object.is(a, b) || fail(message ?? `${a} is not ${b}`);
exports.deepStrictEqual = (a, b) => same(a, b) || fail(`${JSON.stringify(a)} is not ${JSON.stringify(b)}`);
exports.match = (text, pattern) => pattern.test(text) || fail(`${text} does not match ${pattern}`);
exports.rejects = async (run, pattern) => {
    const reason = await run().then(
        () => fail("it was not rejected"),
        (error) => error,
    );
    exports.match(String(reason), pattern);
};
