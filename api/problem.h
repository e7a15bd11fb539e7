// RFC 9457 problem documents: the one table from what went wrong to status, slug and title.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace orbis::api {

// What can go wrong between the client and a job; what goes wrong inside a job is an ErrorCode.
enum class Refusal {
  unauthorized,
  forbidden,
  not_found,
  method_not_allowed,
  not_finished,
  expired,
  range_not_satisfiable,
  bad_request,
  unsupported_media_type,
  key_reused,
  queue_full,
  too_many_waiting,
  uri_too_long,
  draining,
};

struct ProblemType {
  std::string_view slug; // the stable part of `type`: /problems/<slug>
  int status;
  std::string_view title;
};

[[nodiscard]] const ProblemType& problem_type(ErrorCode code);
[[nodiscard]] const ProblemType& problem_type(Refusal refusal);
// Every type, for /problems/<slug>, the documentation and the tests.
[[nodiscard]] std::span<const ProblemType> problem_types();
// The ErrorCode with that slug, or nothing: how a code crosses a process border.
[[nodiscard]] std::optional<ErrorCode> error_code(std::string_view slug);

struct FieldError {
  std::string pointer; // JSON pointer into the model's JSON, or "/option_name"
  std::string detail;
  friend bool operator==(const FieldError&, const FieldError&) = default;
};

struct Problem {
  std::string slug, title;
  int status = 500;
  std::string detail;   // what is wrong, where, and what the caller can do
  std::string instance; // the job's address, where there is one
  std::vector<FieldError> errors;
  friend bool operator==(const Problem&, const Problem&) = default;
};

[[nodiscard]] Problem make_problem(Refusal refusal, std::string detail);
// Keeps error.where() as the one entry of `errors`.
[[nodiscard]] Problem make_problem(const Error& error);

// Thrown by routes and services to answer with this problem.
class Refused : public std::exception {
public:
  explicit Refused(Problem problem) : problem_(std::move(problem)) {}
  Refused(Refusal refusal, std::string detail) : problem_(make_problem(refusal, std::move(detail))) {}
  [[nodiscard]] const Problem& problem() const noexcept { return problem_; }
  [[nodiscard]] const char* what() const noexcept override { return problem_.detail.c_str(); }

private:
  Problem problem_;
};

} // namespace orbis::api
