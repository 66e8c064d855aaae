//! The paper's response of whole bodies (section 5).

use super::pipeline::ContactPipeline;
use super::{BodyResponse, SampledBody, share_out};
use crate::hull::{EdgeModel, Hull};
use crate::sample::Samples;
use nalgebra::Isometry3;

/// The paper's response of a body (section 5). Its direction is the mean of the responses of the samples inside the
/// hull, or the response of the deepest sample where these cancel out. Its length is the longest exit of these samples
/// along that direction.
///
/// [`body_responses`] is faster for more than one body.
pub fn body_response(hull: &Hull, body: &Samples, hull_from_body: &Isometry3<f64>) -> BodyResponse {
    let mut response = [BodyResponse::NONE];
    let body = SampledBody { samples: body, hull_from_body: *hull_from_body, last_escape: None };
    respond_on_thread(&mut response, hull, &[body]);
    let [response] = response;
    response
}

/// Computes the [`body_response`] of each of `bodies` and writes them to `responses` in the order of the bodies. The
/// memory of `responses` is reused.
///
/// With the feature `threads` the bodies are divided among the threads of rayon's current pool. The response of a body
/// does not depend on the other bodies.
pub fn body_responses(hull: &Hull, bodies: &[SampledBody], responses: &mut Vec<BodyResponse>) {
    responses.clear();
    responses.resize(bodies.len(), BodyResponse::NONE);
    share_out(bodies, responses, &|bodies, responses| respond_on_thread(responses, hull, bodies));
}

/// Writes the responses of those of `bodies` that touch the hull to their elements of `responses`.
fn respond_on_thread(responses: &mut [BodyResponse], hull: &Hull, bodies: &[SampledBody]) {
    ContactPipeline::with_scratch(|pipeline| {
        pipeline.collect_penetrating(hull, bodies, EdgeModel::Pixel, usize::MAX);
        pipeline.group_by_mean_response(hull);
        pipeline.each_response(hull, |body, response| responses[body] = response);
    });
}
