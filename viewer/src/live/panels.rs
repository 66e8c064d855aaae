//! Text over the picture: how fast everything is, messages, keys.

use super::messages::{Gravity, Message};
use super::request::Request;
use crate::overlay::{Corner, Severity, draw_banner, draw_panel};
use crate::window::KEYS;
use image::RgbImage;

/// Draws what `request` asks for, and the messages.
pub fn draw(picture: &mut RgbImage, request: &Request, info: &[String], messages: &[Message]) {
    if request.marks.info {
        draw_panel(picture, Corner::UpperLeft, info);
    }
    if request.marks.keys {
        let keys: Vec<_> = KEYS.iter().map(|(key, does)| format!("{key:<12} {does}")).collect();
        draw_panel(picture, Corner::UpperRight, &keys);
    }
    // The gravest message is the first one.
    let Some(message) = messages.first() else { return };
    let told = format!("{}: {}", message.about, message.text);
    match message.gravity {
        Gravity::Note => draw_panel(picture, Corner::LowerLeft, &[told]),
        Gravity::Warning => draw_banner(picture, Severity::Warning, &told),
        Gravity::Error => draw_banner(picture, Severity::Error, &told),
    }
}
