// Models in folders, with the files beside them.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/asset/asset.h"
#include "support/gltf_builder.h"

namespace orbis::test {

inline Bytes contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return bytes_of(text.str());
}

// Files in folders of a model's own are parts of it, by their names there.
inline asset::Attachments neighbours(const std::filesystem::path& model) {
  asset::Attachments out;
  if (model.extension() != ".gltf") return out;
  for (const auto& entry : std::filesystem::directory_iterator(model.parent_path())) {
    if (entry.is_regular_file() && entry.path() != model)
      out[entry.path().filename().string()] = contents(entry.path());
  }
  return out;
}

} // namespace orbis::test
