// The files of the web page, part of the program.
#pragma once

#include <span>
#include <string_view>

namespace orbis::server {

struct WebFile {
  std::string_view path; // "/", "/orbis.css", …
  std::string_view type;
  std::string_view contents;
};

[[nodiscard]] std::span<const WebFile> web_files();

} // namespace orbis::server
