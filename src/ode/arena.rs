//! Generational arena: ids stay safe to use after their object is removed, because each reuse of a slot raises its
//! generation number.

use std::fmt;

use crate::Error;

/// An arena's key: the world's serial number, the slot's index, and the slot's generation (how often it was reused).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Key {
    world: u32,
    index: u32,
    generation: u32,
}

impl Key {
    /// The value stored as the user data of the ODE object. It is never 0, which is ODE's
    /// default and so the user data of objects that other code made.
    pub(super) fn user_data(self) -> usize {
        self.index as usize + 1
    }
}

/// A typed id, with the noun that error messages use for its object.
pub(super) trait Id: Copy + fmt::Debug {
    const NOUN: &'static str;
    fn key(self) -> Key;
}

macro_rules! id {
    ($(#[$doc:meta])* $name:ident, $noun:literal) => {
        $(#[$doc])*
        ///
        /// Cheap to copy. It never refers to another object, even after its slot is reused.
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub(super) Key);

        impl Id for $name {
            const NOUN: &'static str = $noun;
            fn key(self) -> Key {
                self.0
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let Key { world, index, generation } = self.0;
                write!(f, "{}({index}v{generation} of world {world})", stringify!($name))
            }
        }
    };
}

id!(
    /// The id of a body of one [`World`](super::World).
    BodyId,
    "body"
);
id!(
    /// The id of a geom of one [`World`](super::World).
    GeomId,
    "geom"
);
id!(
    /// The id of a space of one [`World`](super::World).
    SpaceId,
    "space"
);
id!(
    /// The id of a joint of one [`World`](super::World).
    JointId,
    "joint"
);
id!(
    /// The id of a group of joints of one [`World`](super::World).
    JointGroupId,
    "joint group"
);

#[derive(Debug)]
struct Entry<T> {
    generation: u32,
    value: Option<T>,
}

/// The records of one kind of object, in slots that are reused after removal.
#[derive(Debug)]
pub(super) struct Arena<T> {
    world: u32,
    slots: Vec<Entry<T>>,
    vacant: Vec<u32>,
}

impl<T> Arena<T> {
    pub(super) fn new(world: u32) -> Self {
        Self { world, slots: Vec::new(), vacant: Vec::new() }
    }

    pub(super) fn insert(&mut self, value: T) -> Key {
        let index = self.vacant.pop().unwrap_or_else(|| {
            self.slots.push(Entry { generation: 0, value: None });
            u32::try_from(self.slots.len() - 1).expect("memory runs out before 2^32 objects exist")
        });
        let slot = &mut self.slots[index as usize];
        slot.value = Some(value);
        Key { world: self.world, index, generation: slot.generation }
    }

    pub(super) fn get(&self, key: Key) -> Option<&T> {
        let slot = self.slots.get(key.index as usize)?;
        if key.world == self.world && key.generation == slot.generation { slot.value.as_ref() } else { None }
    }

    pub(super) fn get_mut(&mut self, key: Key) -> Option<&mut T> {
        let slot = self.slots.get_mut(key.index as usize)?;
        if key.world == self.world && key.generation == slot.generation { slot.value.as_mut() } else { None }
    }

    pub(super) fn remove(&mut self, key: Key) -> Option<T> {
        self.get(key)?;
        let slot = &mut self.slots[key.index as usize];
        let value = slot.value.take();

        // A slot whose generation number would overflow is never reused, so that old keys stay invalid.
        if let Some(next) = slot.generation.checked_add(1) {
            slot.generation = next;
            self.vacant.push(key.index);
        }
        value
    }

    /// The record whose [`Key::user_data`] is `data`, if it still exists.
    pub(super) fn by_user_data(&self, data: usize) -> Option<(Key, &T)> {
        let index = data.checked_sub(1)?;
        let slot = self.slots.get(index)?;
        let key = Key { world: self.world, index: u32::try_from(index).ok()?, generation: slot.generation };
        slot.value.as_ref().map(|value| (key, value))
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (Key, &T)> {
        (0..self.slots.len()).filter_map(|index| self.by_user_data(index + 1))
    }

    pub(super) fn len(&self) -> usize {
        self.iter().count()
    }

    /// The record of `id`, or an error that says why there is none.
    pub(super) fn find(&self, id: impl Id) -> Result<&T, Error> {
        self.get(id.key()).ok_or_else(|| self.missing(id))
    }

    /// The record of `id`.
    ///
    /// # Panics
    ///
    /// Panics if there is no such record.
    #[track_caller]
    pub(super) fn expect(&self, id: impl Id) -> &T {
        self.find(id).unwrap_or_else(|error| panic!("{error}"))
    }

    fn missing<I: Id>(&self, id: I) -> Error {
        let noun = I::NOUN;
        if id.key().world == self.world {
            Error::argument(format!("{id:?}: expected an existing {noun}, but it was removed"))
        } else {
            Error::argument(format!(
                "{id:?}: expected a {noun} of world {}, found an id of another world",
                self.world
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_finds_its_value_until_it_is_removed() {
        let mut arena = Arena::new(7);
        let (a, b) = (arena.insert('a'), arena.insert('b'));
        assert_eq!((arena.get(a), arena.get(b)), (Some(&'a'), Some(&'b')));
        assert_eq!(arena.remove(a), Some('a'));
        assert_eq!(arena.remove(a), None);
        assert_eq!((arena.get(a), arena.get(b)), (None, Some(&'b')));
        assert_eq!(arena.len(), 1);
    }

    #[test]
    fn a_key_does_not_find_the_next_value_in_its_slot() {
        let mut arena = Arena::new(7);
        let old = arena.insert('a');
        arena.remove(old);
        let new = arena.insert('b');
        assert_eq!((old.index, arena.get(old), arena.get(new)), (new.index, None, Some(&'b')));
    }

    #[test]
    fn a_key_of_another_world_finds_nothing() {
        let (mut here, mut there) = (Arena::new(1), Arena::new(2));
        let key = here.insert('a');
        there.insert('b');
        assert_eq!(there.get(key), None);
        assert_eq!(there.get_mut(key), None);
        assert_eq!(there.remove(key), None);
    }

    #[test]
    fn a_slot_whose_generation_number_is_at_its_maximum_is_not_reused() {
        let mut arena = Arena::new(1);
        let key = arena.insert('a');
        arena.slots[0].generation = u32::MAX;
        let last = Key { generation: u32::MAX, ..key };
        assert_eq!(arena.remove(last), Some('a'));
        assert_ne!(arena.insert('b').index, last.index);
        assert_eq!(arena.get(last), None);
    }

    #[test]
    fn user_data_finds_only_values_that_still_exist() {
        let mut arena = Arena::new(1);
        let key = arena.insert('a');
        assert_eq!(arena.by_user_data(key.user_data()), Some((key, &'a')));
        assert_eq!(arena.by_user_data(0), None);
        assert_eq!(arena.by_user_data(usize::MAX), None);
        arena.remove(key);
        assert_eq!(arena.by_user_data(key.user_data()), None);
    }
}
