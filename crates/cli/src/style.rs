//! Colours of text. `anstream` decides by the stream and the environment (`NO_COLOR`, `CLICOLOR_FORCE`, `TERM`) whether
//! to use them; `anstyle` writes them.

use annotate_snippets::Renderer;
use anstream::stream::RawStream;
use anstream::{AutoStream, ColorChoice};
use anstyle::{AnsiColor, Style};

const ERROR: Style = AnsiColor::Red.on_default().bold();
const WARNING: Style = AnsiColor::Yellow.on_default().bold();
const HELP: Style = AnsiColor::Cyan.on_default().bold();
const STRONG: Style = Style::new().bold();

/// The colours of text, or none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TextColours {
    has_colour: bool,
}

impl TextColours {
    /// Returns the colours of standard output.
    pub(crate) fn for_stdout() -> Self {
        Self::for_stream(&std::io::stdout())
    }

    /// Returns the colours of standard error.
    pub(crate) fn for_stderr() -> Self {
        Self::for_stream(&std::io::stderr())
    }

    /// Returns no colours.
    #[cfg(test)]
    pub(crate) fn plain() -> Self {
        Self { has_colour: false }
    }

    /// Returns colours, whatever the streams are.
    #[cfg(test)]
    pub(crate) fn coloured() -> Self {
        Self { has_colour: true }
    }

    fn for_stream(stream: &impl RawStream) -> Self {
        Self {
            has_colour: AutoStream::choice(stream) != ColorChoice::Never,
        }
    }

    /// Paints the word of an error.
    pub(crate) fn error(self, text: &str) -> String {
        self.paint(ERROR, text)
    }

    /// Paints the word of a warning.
    pub(crate) fn warning(self, text: &str) -> String {
        self.paint(WARNING, text)
    }

    /// Paints the word of a help or a note.
    pub(crate) fn help(self, text: &str) -> String {
        self.paint(HELP, text)
    }

    /// Emphasises the most important text.
    pub(crate) fn strong(self, text: &str) -> String {
        self.paint(STRONG, text)
    }

    /// Returns the renderer of source snippets, with or without colours.
    pub(crate) fn renderer(self) -> Renderer {
        if self.has_colour {
            Renderer::styled()
        } else {
            Renderer::plain()
        }
    }

    fn paint(self, style: Style, text: &str) -> String {
        if self.has_colour {
            format!("{style}{text}{style:#}")
        } else {
            text.into()
        }
    }
}

/// Escapes control characters, which could move the terminal's cursor.
pub(crate) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter.is_control() {
            true => escaped.extend(letter.escape_default()),
            false => escaped.push(letter),
        }
    }
    escaped
}
