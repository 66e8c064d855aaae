//! The keys and what they do.

/// The keys of the window, for its help.
pub const KEYS: [(&str, &str); 21] = [
    ("drag", "turn around the subject"),
    ("right drag", "move a body, or the view"),
    ("wheel", "nearer, farther"),
    ("w a s d q e", "fly"),
    ("click", "throw a ball"),
    ("1 - 8", "place of a real camera"),
    ("0", "view of all"),
    ("space", "freeze time"),
    (".", "one frame on, while frozen"),
    ("r", "put the bodies back"),
    ("b", "other bodies"),
    ("l", "learn the empty room"),
    ("m", "next method of drawing"),
    ("f", "refinement"),
    ("h", "shape of the hull"),
    ("c", "contacts"),
    ("p", "sample points"),
    ("k", "cameras"),
    ("x v", "axes, work volume"),
    ("i", "information"),
    ("t ? esc", "take a picture, keys, quit"),
];

/// A key that does something.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Key {
    /// A character, in lower case.
    Char(char),
    /// The escape key.
    Escape,
}
