//! Counts of line ends and characters at checkpoints of a text, so that a count up to any offset reads at most one
//! block.

/// Bytes between two checkpoints.
pub(crate) const BLOCK: usize = 1024;

/// The counts before byte `(k + 1) · BLOCK` of a text, for each k; empty for a short text.
///
/// Each method takes the text from which the checkpoints were made.
#[derive(Clone, Debug, Default)]
pub(crate) struct Checkpoints(Box<[Counts]>);

/// The numbers of line ends, `\n`, and of characters that start before an offset.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    line_ends: u32,
    characters: u32,
}

impl Checkpoints {
    /// Counts line ends and characters in a text of less than 4 GiB.
    pub(crate) fn new(text: &str) -> Self {
        let mut counts = Counts::default();
        let blocks = text.as_bytes().chunks_exact(BLOCK);
        let all = blocks.map(|block| {
            counts.line_ends += count(block, is_line_end);
            counts.characters += count(block, starts_character);
            counts
        });
        Self(all.collect())
    }

    /// Returns the number of line ends before an offset; an offset past the end counts as the end.
    pub(crate) fn line_ends_before(&self, text: &str, offset: u32) -> u32 {
        let (counts, rest) = self.up_to(text, offset);
        counts.line_ends + count(rest, is_line_end)
    }

    /// Returns the number of characters that start before an offset; an offset past the end counts as the end.
    pub(crate) fn characters_before(&self, text: &str, offset: u32) -> u32 {
        let (counts, rest) = self.up_to(text, offset);
        counts.characters + count(rest, starts_character)
    }

    /// Returns the offset of the line end with this number, from 0.
    pub(crate) fn line_end(&self, text: &str, number: u32) -> Option<u32> {
        self.find(text, number, |counts| counts.line_ends, is_line_end)
    }

    /// Returns the offset of the character with this number, from 0.
    pub(crate) fn character(&self, text: &str, number: u32) -> Option<u32> {
        self.find(text, number, |counts| counts.characters, starts_character)
    }

    /// Returns the counts at the last checkpoint before an offset, and the bytes between the two.
    fn up_to<'t>(&self, text: &'t str, offset: u32) -> (Counts, &'t [u8]) {
        let offset = (offset as usize).min(text.len());
        let block = offset / BLOCK;
        (self.before(block), &text.as_bytes()[block * BLOCK..offset])
    }

    /// Returns the counts before a block.
    fn before(&self, block: usize) -> Counts {
        let counts = block.checked_sub(1).and_then(|k| self.0.get(k));
        counts.copied().unwrap_or_default()
    }

    /// Returns the offset of the byte with this number, from 0, among the bytes that are `counted`.
    fn find(
        &self,
        text: &str,
        number: u32,
        before: impl Fn(Counts) -> u32,
        counted: impl Fn(u8) -> bool,
    ) -> Option<u32> {
        let block = self.0.partition_point(|counts| before(*counts) <= number);
        let left = number - before(self.before(block));
        let bytes = text.as_bytes()[block * BLOCK..].iter().enumerate();
        let (at, _) = bytes
            .filter(|(_, byte)| counted(**byte))
            .nth(left as usize)?;
        Some((block * BLOCK + at) as u32)
    }
}

fn count(bytes: &[u8], counted: impl Fn(u8) -> bool) -> u32 {
    bytes.iter().filter(|byte| counted(**byte)).count() as u32
}

fn is_line_end(byte: u8) -> bool {
    byte == b'\n'
}

/// Returns true unless the byte continues a character in UTF-8.
fn starts_character(byte: u8) -> bool {
    byte & 0xC0 != 0x80
}
