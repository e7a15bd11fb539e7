#include "server/neighbours.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <string_view>

#include "api/http.h"

namespace orbis::server {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_text = std::size_t{16} << 20U;
constexpr std::size_t most_entries = 2'000;
constexpr int deepest = 3;

std::string lower_extension(const fs::path& path) { return api::lower_case(path.extension().string()); }

bool may_name_files(const fs::path& model) {
  constexpr std::array<std::string_view, 4> extensions{".gltf", ".glb", ".obj", ".ply"};
  return std::ranges::find(extensions, lower_extension(model)) != extensions.end();
}

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text(most_text, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  return text;
}

// Everything but the unreserved characters of RFC 3986.
std::string percent_encoded(std::string_view name) {
  constexpr std::string_view digits = "0123456789ABCDEF", also = "-._~";
  std::string out;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || also.find(c) != std::string_view::npos) {
      out += c;
    } else {
      out.append(1, '%').append(1, digits[byte >> 4U]).append(1, digits[byte & 15U]);
    }
  }
  return out;
}

std::vector<Neighbour> files_around(const fs::path& model) {
  std::vector<Neighbour> out;
  const fs::path directory = fs::absolute(model).parent_path();
  std::error_code error;
  fs::recursive_directory_iterator entry(directory, fs::directory_options::skip_permission_denied, error);
  for (std::size_t n = 0; !error && entry != fs::recursive_directory_iterator() && n < most_entries; ++n) {
    if (entry.depth() >= deepest) entry.disable_recursion_pending();
    if (entry->is_regular_file(error) && !entry->is_symlink(error) && entry->path() != fs::absolute(model))
      out.push_back({entry->path().lexically_relative(directory).generic_string(), entry->path()});
    entry.increment(error);
  }
  std::ranges::sort(out, {}, &Neighbour::name); // directories come in any order
  return out;
}

} // namespace

std::vector<Neighbour> named_neighbours(const fs::path& model) {
  std::vector<Neighbour> out;
  if (!may_name_files(model)) return out;
  std::vector<Neighbour> left = files_around(model);
  std::vector<std::string> texts;
  if (!left.empty()) texts.push_back(text_of(model));
  while (!texts.empty()) {
    const std::string text = std::move(texts.back());
    texts.pop_back();
    std::erase_if(left, [&](const Neighbour& file) {
      const std::string name = file.path.filename().string();
      const bool is_named =
          text.find(name) != std::string::npos || text.find(percent_encoded(name)) != std::string::npos;
      if (!is_named) return false;
      if (lower_extension(file.path) == ".mtl") texts.push_back(text_of(file.path));
      out.push_back(file);
      return true;
    });
  }
  return out;
}

} // namespace orbis::server
