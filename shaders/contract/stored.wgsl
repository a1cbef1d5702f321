// Called by the generated `list_attributes`, written in pass/trace_varied.wgsl: takes number `index` of a list.
fn store_attribute(index: u32, number: Range) {
}
