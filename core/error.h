// The one error type of orbis: what failed, where in the input, and what can be done about it.
#pragma once

#include <exception>
#include <string>
#include <utility>

namespace orbis {

// Each code has one HTTP status, slug and title (api/problem.h holds the table).
enum class ErrorCode {
  malformed,           // the bytes are not what they claim to be
  unsupported_format,  // not a format that orbis reads
  unsupported_feature, // a known format, but a required extension or mode that orbis cannot decode
  too_large,           // a configured limit was exceeded; the message says which and its value
  missing_resource,    // a URI names a file that did not come with the request
  invalid_option,      // unknown option, or a value out of range
  invalid_geometry,    // NaN or infinite coordinates, no triangles, no extent
  not_genus_zero,      // the surface is not one closed manifold component of genus 0
  not_certified,       // the result failed its proof; nothing is delivered
  canceled,            // the caller asked to stop
  out_of_time,         // the job's time limit was reached
  out_of_memory,       // the job's memory limit was reached
  internal,            // a defect of orbis
};

// Thrown where the fact is discovered, caught once, in the worker.
//
// `message` says in one or two sentences what is wrong and what the caller can do. `where` is the place in the
// input: a JSON pointer for glTF ("/meshes/0/primitives/1/attributes/POSITION"), an option's name, or "" where
// no place applies. Neither holds a path of this machine or a library's internal text.
class Error : public std::exception {
public:
  Error(ErrorCode code, std::string message, std::string where = {})
      : code_(code), message_(std::move(message)), where_(std::move(where)) {}

  [[nodiscard]] ErrorCode code() const noexcept { return code_; }
  [[nodiscard]] const std::string& message() const noexcept { return message_; }
  [[nodiscard]] const std::string& where() const noexcept { return where_; }
  [[nodiscard]] const char* what() const noexcept override { return message_.c_str(); }

private:
  ErrorCode code_;
  std::string message_;
  std::string where_;
};

} // namespace orbis
