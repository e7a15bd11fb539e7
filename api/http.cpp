#include "api/http.h"

#include <algorithm>

namespace orbis::api {
namespace {

constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string_view find(const Fields& fields, std::string_view name) {
  const auto it =
      std::ranges::find_if(fields, [&](const auto& field) { return equal_ignoring_case(field.first, name); });
  return it == fields.end() ? std::string_view{} : std::string_view{it->second};
}

} // namespace

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), lower);
  return result;
}

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::string_view Request::header(std::string_view name) const { return find(headers, name); }

std::string Request::media_type() const {
  const std::string_view value = header("Content-Type");
  return lower_case(trim(value.substr(0, value.find(';'))));
}

std::string_view Response::header(std::string_view name) const { return find(headers, name); }

} // namespace orbis::api
