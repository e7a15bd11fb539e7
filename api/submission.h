// From a POST to a checked Submission.
#pragma once

#include "api/http.h"
#include "api/job_service.h"

namespace orbis::api {

// What can be said before the body arrives: is the media type one that orbis takes?
// Throws Refused: unsupported_media_type.
void check_media_type(const Request& request);

// Options come from the query and from the part "options" (a JSON object); where both name one, the query wins.
// The model is the body, or the part "model"; all other parts are files that the model names.
//
// Throws Refused: bad_request (no model, two models, bad options JSON), invalid_option with one entry in `errors` for
// each bad option, unsupported_format where the model's first bytes are of no format that orbis reads
// (core/model_format.h). Throws Error as check_options does (core/check_options.h).
[[nodiscard]] Submission parse_submission(const Request& request);

// POST /v1/morphs: the parts `a` and `b` are the models; b goes with the job as the file that options.morph_to names.
[[nodiscard]] Submission parse_morph(const Request& request);

} // namespace orbis::api
