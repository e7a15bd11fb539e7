#include "api/problem.h"

#include <algorithm>
#include <array>

namespace orbis::api {
namespace {

constexpr std::size_t error_count = static_cast<std::size_t>(ErrorCode::internal) + 1;
constexpr std::size_t refusal_count = static_cast<std::size_t>(Refusal::draining) + 1;

// First the ErrorCodes, then the Refusals, each in the order of its enum.
//
// A model that needs more time or memory than the operator allows is understood but not processable: 422, not a defect
// of the server.
constexpr std::array<ProblemType, error_count + refusal_count> table{{
    {"malformed", 400, "The data is malformed"},
    {"unsupported-format", 415, "The format is not supported"},
    {"unsupported-feature", 422, "The model uses a feature that is not supported"},
    {"too-large", 413, "A limit was exceeded"},
    {"missing-resource", 422, "A file that the model names is missing"},
    {"invalid-option", 422, "An option is invalid"},
    {"invalid-geometry", 422, "The geometry is invalid"},
    {"not-genus-zero", 422, "The surface is not one closed surface of genus 0"},
    {"not-certified", 500, "The result failed its proof"},
    {"canceled", 409, "The job was canceled"},
    {"out-of-time", 422, "The job reached its time limit"},
    {"out-of-memory", 422, "The job reached its memory limit"},
    {"internal", 500, "Internal error"},

    {"unauthorized", 401, "A key is required"},
    {"forbidden", 403, "The key is not accepted"},
    {"not-found", 404, "Not found"},
    {"method-not-allowed", 405, "The method is not allowed here"},
    {"not-finished", 409, "The job is not finished"},
    {"expired", 410, "The job has expired"},
    {"range-not-satisfiable", 416, "The range lies outside the file"},
    {"bad-request", 400, "The request cannot be read"},
    {"unsupported-media-type", 415, "The media type is not supported"},
    {"key-reused", 422, "The Idempotency-Key was used for another request"},
    {"queue-full", 429, "The queue is full"},
    {"too-many-waiting", 429, "Too many requests wait"},
    {"uri-too-long", 414, "The address is too long"},
    {"draining", 503, "The service is shutting down"},
}};

Problem from(const ProblemType& type, std::string detail) {
  return {std::string(type.slug), std::string(type.title), type.status, std::move(detail), {}, {}};
}

} // namespace

const ProblemType& problem_type(ErrorCode code) { return table.at(static_cast<std::size_t>(code)); }

const ProblemType& problem_type(Refusal refusal) { return table.at(error_count + static_cast<std::size_t>(refusal)); }

std::span<const ProblemType> problem_types() { return table; }

std::optional<ErrorCode> error_code(std::string_view slug) {
  const auto errors = problem_types().first(error_count);
  const auto it = std::ranges::find(errors, slug, &ProblemType::slug);
  if (it == errors.end()) return std::nullopt;
  return static_cast<ErrorCode>(it - errors.begin());
}

Problem make_problem(Refusal refusal, std::string detail) { return from(problem_type(refusal), std::move(detail)); }

Problem make_problem(const Error& error) {
  Problem problem = from(problem_type(error.code()), error.message());
  if (!error.where().empty()) {
    const std::string pointer = error.where().front() == '/' ? error.where() : "/" + error.where();
    problem.errors.push_back({pointer, error.message()});
  }
  return problem;
}

} // namespace orbis::api
