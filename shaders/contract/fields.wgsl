// Generated: returns the range of field `field` for these ranges of its coordinates. The numbers of its expression begin at
// `instance`.
fn field_range(field: u32, x: Range, y: Range, z: Range, instance: u32) -> Range {
    return x;
}
