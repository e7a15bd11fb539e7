// The files beside a model on the command line's machine: what a user does not want to name one by one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace orbis::server {

struct Neighbour {
  std::string name; // relative to the model's directory, with slashes
  std::filesystem::path path;
};

// The regular files in the model's directory, and up to three levels below it, whose names the model's text has in it,
// plain or percent-encoded, or that of a material library (.mtl) found so. The text is searched, not understood:
// reading it is for the sandbox. At most 2,000 entries and the first 16 MiB of each text are looked at; symbolic links
// are left alone. Empty for a format that names no files.
[[nodiscard]] std::vector<Neighbour> named_neighbours(const std::filesystem::path& model);

} // namespace orbis::server
