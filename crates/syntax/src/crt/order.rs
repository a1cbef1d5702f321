//! The order of a script's blocks: one block of each kind, and nothing after the scene.

use super::codes;
use super::tree::{Block, BlockKind, Script};
use crate::diagnostic::Diagnostic;
use crate::span::Span;

impl Script {
    /// Returns the diagnostics of misplaced or missing blocks.
    pub(crate) fn misplaced(&self) -> Vec<Diagnostic> {
        let mut found = Vec::new();
        let mut first: [Option<Span>; 2] = [None; 2];
        let mut has_blocks = false;
        let mut is_reported = false;
        for (start, block) in self.blocks() {
            has_blocks = true;
            let scene = first[1];
            let keyword =
                keyword(block).map(|(kind, word, place)| (kind, word, place.moved(start)));
            if let Some((kind, word, place)) = keyword {
                if let Some(earlier) = first[kind] {
                    let message = format!("a script has one block `{word}`");
                    let diagnostic = Diagnostic::error(codes::SECOND_BLOCK, place, message);
                    found.push(diagnostic.with_related(earlier, "the first one is here"));
                    continue;
                }
                first[kind] = Some(place);
            }
            if let Some(scene) = scene
                && !std::mem::replace(&mut is_reported, true)
            {
                let place = block.span.moved(start);
                let message = "nothing may follow the block `Scene`";
                let diagnostic = Diagnostic::error(codes::AFTER_SCENE, place, message);
                found.push(
                    diagnostic
                        .with_hint("move it above the scene")
                        .with_related(scene, "the scene"),
                );
            }
        }
        if first[1].is_none() && has_blocks {
            let mut hint = Diagnostic::error(
                codes::NO_SCENE,
                Span::default(),
                "this script has no block `Scene`: it draws nothing",
            );
            hint.severity = crate::diagnostic::Severity::Hint;
            found.push(hint);
        }
        found
    }
}

/// Returns the number of the kind of a block that may occur only once, its keyword, and the keyword's span.
fn keyword(block: &Block) -> Option<(usize, &'static str, Span)> {
    let (kind, word) = match block.kind {
        BlockKind::Settings(..) => (0, "Settings"),
        BlockKind::Scene(_) => (1, "Scene"),
        BlockKind::Statement(_) => return None,
    };
    let start = block.span.start;
    Some((kind, word, Span::new(start, start + word.len() as u32)))
}
