//! Contacts on which a tilted body has not come down yet.
//!
//! ```text
//!          _____----
//!     ----      ____/       a box turns about its deep edge, d: its face comes down on the hull
//!     |   __----            the sample s is inside by a hair; as a contact it would be a new pivot,
//!     d-s----  hull         which lifts the edge: a box on a box touches at its edge until the face lies
//! ```

use super::Contact;

/// A contact waits only where it is less deep than this part of another's depth,
const MUCH_SHALLOWER: f64 = 0.7;

/// and where the two differ in depth by more than this part of their distance: a tilt of 0.3 degrees. A body that
/// lies has no such tilt.
const SLOPE: f64 = 0.005;

/// Those of `contacts` that wait for no other of the same direction.
pub(super) fn without_waiting(contacts: &[Contact]) -> impl Iterator<Item = Contact> {
    let waits = |shallow: &Contact| {
        contacts.iter().any(|deep| {
            deep.direction == shallow.direction
                && shallow.depth < MUCH_SHALLOWER * deep.depth
                && deep.depth - shallow.depth > SLOPE * (deep.point - shallow.point).norm()
        })
    };
    contacts.iter().filter(move |contact| !waits(contact)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Vector3};

    fn contact(x: f64, depth: f64) -> Contact {
        Contact { point: Point3::new(x, 0.0, 0.0), direction: Vector3::z(), depth }
    }

    #[test]
    fn only_the_deep_edge_of_a_tilted_face_is_kept() {
        // The edge 0.8 mm deep, a row of samples 2 cm beside it 0.2 mm deep: a tilt of 1.7 degrees.
        let kept = [contact(0.0, 8e-4), contact(0.02, 2e-4)];
        assert!(without_waiting(&kept).eq([contact(0.0, 8e-4)]));
    }

    #[test]
    fn all_of_a_face_that_lies_are_kept() {
        // A third of a pixel of noise over a face of 20 cm.
        let lying = [contact(0.0, 1.2e-3), contact(0.1, 0.9e-3), contact(0.2, 0.5e-3)];
        assert!(without_waiting(&lying).eq(lying));
    }

    #[test]
    fn clusters_do_not_wait_for_one_another() {
        let side = Contact { direction: Vector3::x(), ..contact(0.02, 1e-4) };
        assert_eq!(without_waiting(&[contact(0.0, 5e-3), side]).count(), 2);
    }
}
