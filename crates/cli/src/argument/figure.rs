//! Parsers of lines on surfaces: measured figures, and paths.

use render::figure::FigureKind;

use super::{Pair, Quantity, pair, quantity};

/// `SURFACE=KIND:U,V:…`: points on a surface whose measures are wanted.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FigureArgument {
    /// The surface's name.
    pub(crate) surface: String,
    /// The kind.
    pub(crate) kind: FigureKind,
    /// The points, at most as many as the kind requires.
    pub(crate) places: Vec<Pair>,
    /// The radius of a circle.
    pub(crate) radius: Option<Quantity>,
}

/// `SURFACE=U,V:U,V:…`: a path on a surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PathArgument {
    /// The surface's name.
    pub(crate) surface: String,
    /// The points of the path in order, two or more.
    pub(crate) places: Vec<Pair>,
}

impl FigureArgument {
    /// Returns the option up to its kind, for sentences.
    pub(crate) fn option(&self) -> String {
        format!("--figure {}={}", self.surface, self.kind.name())
    }
}

/// Parses `SURFACE=KIND:U,V:…`.
pub(crate) fn figure(text: &str) -> Result<FigureArgument, String> {
    let expected = "expected SURFACE=KIND:U,V:…, such as s=distance:0,0:1,pi, s=circle:0,0:0.5 or s=triangle:0,0:1,0:0,1";
    let (surface, text) = named(text).ok_or(expected)?;
    let mut parts = text.split(':');
    let word = parts.next().unwrap_or_default().trim();
    let kind = FigureKind::ALL.into_iter().find(|kind| kind.name() == word);
    let kind = kind.ok_or_else(|| {
        let words = FigureKind::ALL.map(FigureKind::name).join(", ");
        format!("`{word}` is not a kind of figure; the kinds are {words}")
    })?;
    let mut parts: Vec<&str> = parts.collect();
    let mut radius = None;
    // A point has two numbers, a radius has one.
    if kind == FigureKind::Circle
        && parts.len() > 1
        && let Some(last) = parts.pop_if(|last| !last.contains(','))
    {
        radius = Some(quantity(last)?);
    }
    let places = parts.into_iter().map(pair).collect::<Result<Vec<_>, _>>()?;
    if places.is_empty() || places.len() > kind.places() {
        let most = kind.places();
        let given = places.len();
        return Err(format!(
            "a {word} takes places U,V, at most {most}, found {given}"
        ));
    }
    Ok(FigureArgument {
        surface,
        kind,
        places,
        radius,
    })
}

/// Parses `SURFACE=U,V:U,V:…`.
pub(crate) fn path(text: &str) -> Result<PathArgument, String> {
    let expected = "expected SURFACE=U,V:U,V:…, two places or more, such as s=0,0:0.5,1:1,1";
    let (surface, text) = named(text).ok_or(expected)?;
    let places = text.split(':').map(pair).collect::<Result<Vec<_>, _>>()?;
    match places.len() {
        0 | 1 => Err(expected.into()),
        _ => Ok(PathArgument { surface, places }),
    }
}

fn named(text: &str) -> Option<(String, &str)> {
    let (name, text) = text.split_once('=')?;
    let name = name.trim();
    (!name.is_empty()).then(|| (name.to_owned(), text))
}

#[cfg(test)]
mod tests {
    use render::figure::FigureKind;

    use super::{figure, path};

    #[test]
    fn figures_and_paths_are_read_or_refused_with_a_sentence() {
        let circle = figure("s=circle:0,pi:1/2").expect("a circle");
        assert_eq!((circle.kind, circle.places.len()), (FigureKind::Circle, 1));
        assert!(circle.radius.is_some());
        let through = figure("s=circle:0,0:1,1").expect("a circle");
        assert_eq!((through.places.len(), through.radius), (2, None));
        let begun = figure("s=triangle:0,0:1,1").expect("two corners");
        assert_eq!(begun.places.len(), 2);
        for (text, part) in [
            ("triangle:0,0", "SURFACE=KIND"),
            ("s=square:0,0", "place, distance, circle, triangle"),
            ("s=distance:0,0:1,1:2,2", "at most 2, found 3"),
            ("s=place", "found 0"),
            ("s=place:1", "two numbers"),
        ] {
            let refused = figure(text).expect_err(text);
            assert!(refused.contains(part), "{text}: {refused}");
        }
        assert_eq!(path("s=0,0:1,1:2,0").expect("a path").places.len(), 3);
        assert!(path("s=0,0").is_err());
    }
}
