// Plain requests and responses: what the contract is written in. The HTTP library stays behind server/http_server.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace orbis::api {

// One uploaded file, already spooled to disk by the server: the whole body, or one part of multipart/form-data.
struct Part {
  std::string name;       // the form field; "model" for a plain body
  std::string file_name;  // as the client gave it; a key, never a path
  std::string media_type; // without parameters, lower case; "" where the client gave none
  std::filesystem::path spooled;
  std::uint64_t bytes = 0;
  std::string sha256; // of its contents, hexadecimal
};

using Fields = std::vector<std::pair<std::string, std::string>>;

struct Request {
  std::string method; // "GET", "POST", …
  std::string path;   // decoded, without the query
  Fields query;       // decoded, in the request's order
  Fields headers;     // as received
  std::vector<Part> parts;

  // The first header of that name, compared without case; "" where there is none.
  [[nodiscard]] std::string_view header(std::string_view name) const;
  // The Content-Type without parameters, lower case.
  [[nodiscard]] std::string media_type() const;
};

// Bytes [offset, offset + length) of a file.
struct FileBody {
  std::filesystem::path path;
  std::uint64_t offset = 0, length = 0;
};

// A body that is made while it is sent: each call gives the next piece and may block; nothing ends the body.
using StreamBody = std::function<std::optional<std::string>()>;

struct Response {
  int status = 200;
  Fields headers; // with Content-Type where there is a body
  std::variant<std::string, FileBody, StreamBody> body;

  [[nodiscard]] std::string_view header(std::string_view name) const;
  void set(std::string name, std::string value) { headers.emplace_back(std::move(name), std::move(value)); }
};

[[nodiscard]] bool equal_ignoring_case(std::string_view a, std::string_view b);
[[nodiscard]] std::string lower_case(std::string_view text);
[[nodiscard]] std::string_view trim(std::string_view text);

} // namespace orbis::api
