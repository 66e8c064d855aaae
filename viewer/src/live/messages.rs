//! What the threads have to say: shown in the window, and handed to the program for its terminal.

use std::fmt::Display;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long a message is shown.
const SHOWN: Duration = Duration::from_secs(6);

/// Messages that wait for the program at most.
const WAITING: usize = 100;

/// How grave a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Gravity {
    /// What happens.
    Note,
    /// What goes wrong, and may be well again.
    Warning,
    /// What went wrong for good.
    Error,
}

/// A message about one thing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// What it is about, such as a camera. A newer message about it replaces it.
    pub about: String,
    /// How grave it is.
    pub gravity: Gravity,
    /// What it says.
    pub text: String,
}

/// The messages of all threads.
#[derive(Debug, Default)]
pub struct Messages(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    shown: Vec<(Instant, Message)>,
    waiting: Vec<Message>,
}

impl Messages {
    /// Tells what happens.
    pub fn tell(&self, about: &str, text: impl Display) {
        self.add(about, Gravity::Note, &text);
    }

    /// Tells what goes wrong.
    pub fn warn(&self, about: &str, text: impl Display) {
        self.add(about, Gravity::Warning, &text);
    }

    /// Tells what went wrong for good.
    pub fn fail(&self, about: &str, text: impl Display) {
        self.add(about, Gravity::Error, &text);
    }

    /// The messages to show now, the gravest first. Errors stay.
    pub fn shown(&self) -> Vec<Message> {
        let mut state = self.lock();
        state.shown.retain(|(since, message)| message.gravity == Gravity::Error || since.elapsed() < SHOWN);
        let mut shown: Vec<_> = state.shown.iter().map(|(_, message)| message.clone()).collect();
        shown.sort_by_key(|message| std::cmp::Reverse(message.gravity));
        shown
    }

    /// Takes the messages that are new since the last call. What repeats is among them once.
    pub fn take_new(&self) -> Vec<Message> {
        std::mem::take(&mut self.lock().waiting)
    }

    fn add(&self, about: &str, gravity: Gravity, text: &dyn Display) {
        let message = Message { about: about.to_owned(), gravity, text: text.to_string() };
        let mut state = self.lock();
        let is_repeated = state.shown.iter().any(|(_, shown)| *shown == message);
        state.shown.retain(|(_, shown)| shown.about != about);
        state.shown.push((Instant::now(), message.clone()));
        if !is_repeated && state.waiting.len() < WAITING {
            state.waiting.push(message);
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_newer_message_about_a_thing_replaces_the_last_one_and_what_repeats_is_told_once() {
        let messages = Messages::default();
        messages.tell("left", "connected");
        messages.warn("left", "no image");
        messages.warn("left", "no image");
        messages.fail("recording", "the disk is full");
        let texts = |messages: Vec<Message>| messages.into_iter().map(|one| one.text).collect::<Vec<_>>();
        assert_eq!(texts(messages.shown()), ["the disk is full", "no image"]);
        assert_eq!(texts(messages.take_new()), ["connected", "no image", "the disk is full"]);
        assert!(messages.take_new().is_empty());
    }
}
