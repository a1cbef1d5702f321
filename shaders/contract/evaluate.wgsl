// Generated: evaluates expressions at one row of inputs, and hands each result to `store_output`.
fn evaluate(row: u32) {
}
