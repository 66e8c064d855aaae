//! How masks are corrected, and which views count.

use super::{HullData, border_of};
use crate::hull::{MaskFilter, Unseen};
use crate::{Error, Result};

impl HullData {
    /// Sets the policy for views that do not see a point, from the next [`update`](Self::update) on.
    ///
    /// # Errors
    /// `min_views` of zero.
    pub fn set_unseen(&self, unseen: Unseen) -> Result<()> {
        if unseen == (Unseen::Abstain { min_views: 0 }) {
            return Err(Error::argument(
                "min_views: expected at least 1, found 0; one view alone bounds no depth",
            ));
        }

        let mut state = self.lock();
        if border_of(state.unseen) != border_of(unseen) {
            state.views.iter_mut().for_each(|view| view.change_border(border_of(unseen)));
        }
        state.unseen = unseen;
        Ok(())
    }

    /// Sets the depth in metres from which on all other views overrule one, from the next [`update`](Self::update) on;
    /// `None`, the default, for never. Use it against masks from which a part of the subject is missing now and then, such
    /// as where it has the background's colour in one camera.
    ///
    /// A point's depth in a view is its Chebyshev distance to the background there, in metres at the point. Where one view
    /// sees the point as background, or much nearer to it than the others do, and the depth in each of at least three other
    /// views that see it is greater by `metres`, the one abstains. The depth of contacts falls to zero where the others'
    /// falls to `metres`, so that it has no jump there. 0.02 m is a good choice for seven cameras or more. With few
    /// cameras the hull grows where one of them alone cuts it off: by 3 % of its volume for a person and seven cameras, by
    /// 4 % for four on a ring, by 29 % for four in worse places.
    ///
    /// Contacts overrule, and so do [`inside`](crate::hull::Hull::inside) and the other queries of points; rays do not
    /// ([`ray_cast`](crate::hull::Hull::ray_cast)).
    ///
    /// # Errors
    /// A depth that is not finite or not positive.
    pub fn set_overrule_depth(&self, metres: Option<f64>) -> Result<()> {
        if let Some(found) = metres.filter(|depth| !(depth.is_finite() && *depth > 0.0)) {
            return Err(Error::argument(format!(
                "depth from which views overrule another: expected a positive, finite number of metres, found {found}; \
                 0.02 is a good choice, and no depth at all switches it off"
            )));
        }
        self.lock().overrule_depth = metres;
        Ok(())
    }

    /// Sets the corrections of masks, for those that are set from now on.
    ///
    /// # Errors
    /// A weight of new masks that is not above 0 and at most 1.
    pub fn set_mask_filter(&self, filter: MaskFilter) -> Result<()> {
        filter.check()?;
        self.lock().filter = filter;
        Ok(())
    }

    /// Enables or disables a view, from the next [`update`](Self::update) on. A disabled view abstains under either
    /// policy.
    ///
    /// # Errors
    /// A view index out of range.
    pub fn set_view_enabled(&self, view: usize, enabled: bool) -> Result<()> {
        self.lock().view_mut(view)?.enabled = enabled;
        Ok(())
    }

    /// Sets how old, in seconds, a view's latest mask may be, from the next [`update`](Self::update) on; `None`, the
    /// default, for any age. A view whose mask is older than that at the time of a frame is late: it abstains in that
    /// frame as a disabled view does, and takes part again in the first frame that has a newer mask of it.
    ///
    /// A frame in which every view is late, or disabled, is no error: its hull is empty. Where some are, the hull is
    /// larger; a hull geom of ODE does not push out the bodies over which it grows then.
    ///
    /// # Errors
    /// An age that is not finite or not positive.
    pub fn set_max_age(&self, seconds: Option<f64>) -> Result<()> {
        if let Some(found) = seconds.filter(|age| !(age.is_finite() && *age > 0.0)) {
            return Err(Error::argument(format!(
                "max_age: expected a positive, finite number of seconds, found {found}; pass several times the time \
                 between two masks, or no age at all to use masks however old they are"
            )));
        }
        self.lock().max_age = seconds;
        Ok(())
    }
}
