//! The paper's response of whole bodies (section 5).

use super::pipeline::ContactPipeline;
use super::{BodyResponse, SampledBody, share_out};
use crate::hull::{EdgeModel, Hull};
use crate::sample::Samples;
use nalgebra::Isometry3;

/// The paper's response of a body (section 5): the mean of its colliding samples' responses gives the direction, the
/// longest exit along it the length. Where the responses cancel out, the deepest sample's stands in.
///
/// Many bodies are sooner answered together, by [`body_responses`].
pub fn body_response(hull: &Hull, body: &Samples, hull_from_body: &Isometry3<f64>) -> BodyResponse {
    let mut response = [BodyResponse::NONE];
    let body = SampledBody { samples: body, hull_from_body: *hull_from_body, last_escape: None };
    respond_on_thread(&mut response, hull, &[body]);
    let [response] = response;
    response
}

/// The [`body_response`] of each of `bodies`, in their order, written to `responses`, whose memory is used again.
///
/// With the feature `threads` the bodies are shared out among the threads of rayon's current pool. No body's response
/// depends on another's.
pub fn body_responses(hull: &Hull, bodies: &[SampledBody], responses: &mut Vec<BodyResponse>) {
    responses.clear();
    responses.resize(bodies.len(), BodyResponse::NONE);
    share_out(bodies, responses, &|bodies, responses| respond_on_thread(responses, hull, bodies));
}

/// Writes the responses of `bodies`, where they touch, to their places.
fn respond_on_thread(responses: &mut [BodyResponse], hull: &Hull, bodies: &[SampledBody]) {
    ContactPipeline::with_scratch(|pipeline| {
        pipeline.collect_penetrating(hull, bodies, EdgeModel::Pixel, usize::MAX);
        pipeline.group_by_mean_response(hull);
        pipeline.each_response(hull, |place, response| responses[place] = response);
    });
}
