// Runs in the extension host: every test of `tests.js`, or of the file that GEOTRACE_SUITE names, one after the other.
const tests = require(process.env.GEOTRACE_SUITE ?? "./tests");

exports.run = async function run() {
    let failed = 0;
    const names = Object.keys(tests);
    for (const name of names) {
        try {
            await tests[name]();
            console.log(`ok      ${name}`);
        } catch (error) {
            failed += 1;
            console.log(`FAILED  ${name}\n${error.stack}`);
        }
    }
    console.log(`VS Code: ${names.length - failed} passed, ${failed} failed`);
    if (failed > 0 || names.length === 0) {
        throw new Error(`${failed} of ${names.length} tests failed`);
    }
};
