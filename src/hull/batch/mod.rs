//! Many points, or whole bodies, asked at once.
//!
//! ```text
//!   pose ─► fold ─► find ─► hits ─► ways out ─► V ─► longest exit
//!           one matrix a view      normals      the body's vector
//! ```
//!
//! The same answers as [`Hull::inside`] and [`Hull::respond`], point by point, but in single precision, from the
//! points' frame straight to the images: a point whose image lies within a few ten-thousandths of a pixel of a pixel's
//! border may count to the other side. Contacts do not rest on that: they use it to leave out what is surely outside.
//!
//! Frames in which a view may abstain are asked point by point, in double precision.

// Loops over the lanes of several arrays say what happens to lane k: it is what the compiler turns into vectors.
#![allow(clippy::needless_range_loop)]

mod bodies;
mod exit;
mod fold;
mod inside;
mod respond;
mod walk;
mod workspace;

pub use bodies::Body;
pub use workspace::{Inside, PointResponse, Workspace};

use super::points::Points;
use super::{Hull, Unseen};
use crate::Result;
use fold::{Folded, FoldedBox};
use inside::Within;
use nalgebra::{Isometry3, Point3, Vector3};
use respond::Way;

/// The paper's response of a body (section 5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyResponse {
    /// The vector that moves the body out, in metres; zero where nothing collides.
    pub vector: Vector3<f64>,
    /// How many samples collide.
    pub colliding: usize,
}

impl Hull {
    /// Which of `points` are inside, in the pose `world_from_points`.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn inside_many<'w>(
        &self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        workspace: &'w mut Workspace,
    ) -> Result<Inside<'w>> {
        self.find(points, world_from_points, Within::Subject, workspace)?;
        Ok(workspace.mark(points))
    }

    /// The points that may be inside by any edge model: all but those surely outside.
    pub(crate) fn candidates<'w>(
        &self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        workspace: &'w mut Workspace,
    ) -> Result<Inside<'w>> {
        self.find(points, world_from_points, Within::NearSubject, workspace)?;
        Ok(workspace.mark(points))
    }

    /// The paper's response of each point inside, in the order in which the points lie in memory.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn respond_many<'w>(
        &self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        workspace: &'w mut Workspace,
    ) -> Result<&'w [PointResponse]> {
        self.ways_out(points, world_from_points, workspace)?;
        let rotation = world_from_points.rotation.cast::<f32>();
        let views = &workspace.views;
        workspace.responses.clear();
        workspace.responses.extend(workspace.ways.iter().map(|way| PointResponse {
            point: points.given(way.place as usize),
            view: views[way.view as usize],
            normal: rotation * way.normal,
            depth: way.depth,
        }));
        Ok(&workspace.responses)
    }

    /// The paper's vector of a body (section 5) with these samples: the mean of the responses gives the direction,
    /// the longest exit along it the length. Where the responses cancel out, the deepest sample's stands in.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn respond_body(
        &self,
        samples: &Points,
        world_from_body: &Isometry3<f64>,
        workspace: &mut Workspace,
    ) -> Result<BodyResponse> {
        self.ways_out(samples, world_from_body, workspace)?;
        let ways = &workspace.ways;
        // The first among the deepest.
        let deepest = ways.iter().reduce(|best, way| if way.depth > best.depth { way } else { best });
        let Some(deepest) = deepest else {
            return Ok(BodyResponse { vector: Vector3::zeros(), colliding: 0 });
        };
        let sum = ways.iter().fold(Vector3::zeros(), |sum, way| sum + (way.normal * way.depth).cast::<f64>());
        let direction = sum.try_normalize(0.0).unwrap_or(deepest.normal.cast::<f64>());
        let longest = self.longest_exit(samples, world_from_body, &direction.cast::<f32>(), workspace);
        let vector = world_from_body.rotation * direction * f64::from(longest);
        Ok(BodyResponse { vector, colliding: workspace.ways.len() })
    }

    /// Fills the workspace with the places of the points inside: or, with [`Within::NearSubject`], of all but those
    /// surely outside by any edge model.
    fn find(
        &self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        within: Within,
        workspace: &mut Workspace,
    ) -> Result<()> {
        let world_from_middle = fold::world_from_middle(points, world_from_points)?;
        workspace.found.clear();
        let (_, radius) = points.bounding_sphere();
        let centre = Point3::from(world_from_middle.translation.vector);
        if points.is_empty() || self.aabb().is_empty() || !self.may_touch(&centre, radius * (1.0 + 1e-9)) {
            return Ok(());
        }
        if self.may_abstain() {
            self.find_one_by_one(points, &world_from_middle, within, workspace);
            return Ok(());
        }
        let mut folded = workspace.lend();
        if let Some(volume) = self.fold_near(radius, &world_from_middle, within, &mut folded) {
            // A millimetre is more than rounding, and less than any margin that a work volume needs.
            let cut = !self.bounds().grown(-radius - 1e-3).contains(&centre);
            let cut = (cut && within == Within::Subject).then_some(&volume);
            inside::find(points, &folded, cut, within, &mut workspace.found);
        }
        workspace.take_back(folded);
        Ok(())
    }

    /// Folds the views with the pose; `None` where one of them sees that the whole lies outside.
    fn fold_near<'a>(
        &'a self,
        radius: f64,
        world_from_middle: &Isometry3<f64>,
        within: Within,
        folded: &mut Vec<Folded<'a>>,
    ) -> Option<FoldedBox> {
        let (views, volume) = fold::fold(self, world_from_middle);
        let near = f32::from(u8::from(within == Within::NearSubject));
        for view in views {
            if !view.may_touch(&view.tables.tiles.lookup(), [0.0; 3], radius as f32 * (1.0 + 1e-6), near) {
                return None;
            }
            folded.push(view);
        }
        Some(volume)
    }

    /// Whether some view's silence matters: then the tables do not tell all.
    fn may_abstain(&self) -> bool {
        self.unseen() != Unseen::Outside || self.enabled_views().any(|view| view.seen().is_some())
    }

    fn find_one_by_one(
        &self,
        points: &Points,
        world_from_middle: &Isometry3<f64>,
        within: Within,
        workspace: &mut Workspace,
    ) {
        let inside = |&place: &u32| {
            let p = world_from_middle * Point3::from(points.at(place as usize)).cast::<f64>();
            within == Within::NearSubject || self.inside(&p)
        };
        workspace.found.extend((0..points.len() as u32).filter(inside));
    }

    /// Fills the workspace with the ways out of the points inside.
    fn ways_out(
        &self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        workspace: &mut Workspace,
    ) -> Result<()> {
        self.find(points, world_from_points, Within::Subject, workspace)?;
        workspace.ways.clear();
        workspace.views.clear();
        if workspace.found.is_empty() {
            return Ok(());
        }
        let world_from_middle = fold::world_from_middle(points, world_from_points)?;
        if self.may_abstain() {
            self.ways_one_by_one(points, &world_from_middle, workspace);
            return Ok(());
        }
        let mut folded = workspace.lend();
        let (views, volume) = fold::fold(self, &world_from_middle);
        folded.extend(views);
        workspace.views.extend(folded.iter().map(|view| view.index));
        let Workspace { found, sightings, ways, .. } = workspace;
        respond::ways_out(points, found, &folded, &volume, sightings, ways);
        workspace.take_back(folded);
        Ok(())
    }

    fn ways_one_by_one(
        &self,
        points: &Points,
        world_from_middle: &Isometry3<f64>,
        workspace: &mut Workspace,
    ) {
        let Workspace { found, ways, views, .. } = workspace;
        views.extend(0..self.views().len());
        for &place in found.iter() {
            let p = world_from_middle * Point3::from(points.at(place as usize)).cast::<f64>();
            let Some(response) = self.respond(&p) else { continue };
            let same = |view: &super::View| std::ptr::eq(view, response.nearest.view);
            let Some(view) = self.views().iter().position(same) else { continue };
            let normal = world_from_middle.inverse_transform_vector(&response.normal).cast::<f32>();
            ways.push(Way { place, view: view as u32, normal, depth: response.depth as f32 });
        }
    }

    /// The longest exit along `direction`, in the points' frame, of the points whose ways out are known.
    fn longest_exit(
        &self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        direction: &Vector3<f32>,
        workspace: &mut Workspace,
    ) -> f32 {
        let Ok(world_from_middle) = fold::world_from_middle(points, world_from_points) else { return 0.0 };
        if self.may_abstain() {
            let along = world_from_middle * direction.cast::<f64>();
            let exit = |way: &Way| {
                let p = world_from_middle * Point3::from(points.at(way.place as usize)).cast::<f64>();
                self.exit(&p, &along, super::EdgeModel::Pixel)
            };
            return workspace.ways.iter().map(exit).fold(0.0, f64::max) as f32;
        }
        let mut folded = workspace.lend();
        let (views, volume) = fold::fold(self, &world_from_middle);
        folded.extend(views);
        let Workspace { ways, sightings, .. } = workspace;
        let longest = respond::longest_exit(points, ways, direction, &folded, &volume, sightings);
        workspace.take_back(folded);
        longest
    }
}

#[cfg(test)]
mod tests;
