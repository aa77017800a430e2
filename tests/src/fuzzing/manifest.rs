//! The fuzz target `manifest`: whatever is accepted as a manifest has its own text, and leads nowhere else.

use bitgrain::manifest::Manifest;

/// Reads bytes as the text of a manifest, as they are and with the closing hash that fits them; returns whether one
/// of them is sound.
pub fn manifest(data: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(data) else {
        return false;
    };
    // The same with a closing hash that fits, so that what comes after it is seen.
    let open = serde_json::from_str::<Manifest>(text);
    let closed = open.is_ok_and(|open| read(&open.text()));
    read(text) || closed
}

fn read(text: &str) -> bool {
    let Ok(manifest) = Manifest::parse(text) else {
        return false;
    };
    assert_eq!(manifest.text(), text, "another text passes for it");
    for entry in &manifest.files {
        let path = std::path::Path::new(&entry.path);
        let below = path
            .components()
            .all(|c| matches!(c, std::path::Component::Normal(_)));
        assert!(
            below && path.is_relative(),
            "{} leads elsewhere",
            entry.path
        );
        assert_eq!(manifest.entry(&entry.path), Some(entry));
        assert!(entry.read(std::path::Path::new("/nowhere")).is_err());
    }
    true
}
