// Called by the generated `list_attributes`, defined in pass/trace_varied.wgsl: stores number `index` of a list.
fn store_attribute(index: u32, number: Range) {
}
