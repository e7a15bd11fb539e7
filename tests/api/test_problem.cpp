#include <doctest/doctest.h>

#include <set>

#include "api/problem.h"

using namespace orbis;

TEST_CASE("every error code and refusal has a type of its own: a slug, a client or server status, a title") {
  std::set<std::string_view> slugs;
  for (const api::ProblemType& type : api::problem_types()) {
    CAPTURE(type.slug);
    CHECK(slugs.insert(type.slug).second);
    CHECK(type.slug.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") == std::string_view::npos);
    CHECK(type.status >= 400);
    CHECK(type.status < 600);
    CHECK_FALSE(type.title.empty());
  }
}

TEST_CASE("the statuses are the contract's") {
  CHECK(api::problem_type(ErrorCode::malformed).status == 400);
  CHECK(api::problem_type(ErrorCode::too_large).status == 413);
  CHECK(api::problem_type(ErrorCode::unsupported_format).status == 415);
  CHECK(api::problem_type(ErrorCode::not_genus_zero).status == 422);
  CHECK(api::problem_type(ErrorCode::not_genus_zero).slug == "not-genus-zero");
  CHECK(api::problem_type(ErrorCode::invalid_option).status == 422);
  CHECK(api::problem_type(ErrorCode::not_certified).status == 500);
  CHECK(api::problem_type(ErrorCode::internal).status == 500);
  CHECK(api::problem_type(ErrorCode::internal).slug == "internal");
  CHECK(api::problem_type(api::Refusal::unauthorized).status == 401);
  CHECK(api::problem_type(api::Refusal::not_finished).status == 409);
  CHECK(api::problem_type(api::Refusal::expired).status == 410);
  CHECK(api::problem_type(api::Refusal::queue_full).status == 429);
  CHECK(api::problem_type(api::Refusal::draining).status == 503);
  CHECK(api::problem_type(api::Refusal::draining).slug == "draining");
}

TEST_CASE("an error code survives the way over its slug") {
  for (int i = 0; i <= static_cast<int>(ErrorCode::internal); ++i) {
    const auto code = static_cast<ErrorCode>(i);
    CHECK(api::error_code(api::problem_type(code).slug) == code);
  }
  CHECK_FALSE(api::error_code("queue-full").has_value());
  CHECK_FALSE(api::error_code("").has_value());
}

TEST_CASE("the place of an error becomes a JSON pointer") {
  const auto mesh = api::make_problem(Error(ErrorCode::invalid_geometry, "vertex 3 is not finite", "/meshes/0"));
  CHECK(mesh.errors == std::vector<api::FieldError>{{"/meshes/0", "vertex 3 is not finite"}});
  const auto option = api::make_problem(Error(ErrorCode::invalid_option, "too large", "texture_size"));
  CHECK(option.errors.at(0).pointer == "/texture_size");
  CHECK(api::make_problem(Error(ErrorCode::internal, "a defect")).errors.empty());
}
