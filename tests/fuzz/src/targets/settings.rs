//! The file that a window keeps beside a program.

use session::Choices;

/// Keys and values of the file.
pub(crate) const WORDS: &[&str] = &[
    "{",
    "}",
    "[",
    "]",
    ":",
    ",",
    "\"",
    "null",
    "true",
    "-1",
    "0",
    "1e308",
    "1e999",
    "NaN",
    "\"looks\"",
    "\"params\"",
    "\"openings\"",
    "\"animations\"",
    "\"space\"",
    "\"inside\"",
    "\"closed\"",
    "\"textures\"",
    "\"preferences\"",
    "\"eye\"",
    "\"target\"",
    "\"radius\"",
    "\"colour\"",
    "\"image\"",
    "\"s\"",
];

/// The settings of a window that was used, and none.
pub(crate) fn seeds() -> Vec<Vec<u8>> {
    let used = r#"{"looks":{"s":{"colour":[255,0,10],"texture":"curvature","flipped":true,"hidden":false}},"params":{"r":[0.5,null]},"openings":{"r":[{"value":0.5,"min":0,"max":1}]},"animations":{"r":{"on":[true],"speed":2}},"space":{"eye":[1,2,3],"target":[0,0,0],"radius":2,"moved":true,"tangent":0.4},"inside":{"s":{"at":[0.1,0.2],"x":[1,0],"zoom":2,"moved":true}},"closed":["geodesic:s"],"textures":["a.png"],"defaultTexture":{"image":"a.png"},"preferences":{}}"#;
    let plain = serde_json::to_vec(&Choices::default()).expect("it can be written");
    vec![used.as_bytes().to_vec(), plain, b"{}".to_vec()]
}

/// Reads settings. What was read is written, and read again as it was.
pub(crate) fn run(input: &[u8]) {
    let Ok(choices) = serde_json::from_slice::<Choices>(input) else {
        return;
    };
    let text = serde_json::to_string(&choices).expect("it can be written");
    let again: Choices = serde_json::from_str(&text).expect("it can be read again");
    assert_eq!(again, choices, "settings that were written as {text}");
}
