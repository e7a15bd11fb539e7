// Material libraries of OBJ files (MTL) as glTF materials.
#pragma once

#include <map>
#include <string>

#include "core/asset/model_builder.h"
#include "core/asset/model_files.h"

namespace orbis::asset {

class ObjMaterials {
public:
  ObjMaterials(ModelBuilder& model, const ModelFiles& files, std::vector<Asset::Note>& notes)
      : model_(model), files_(files), notes_(notes) {}

  // Reads the libraries of a "mtllib" line: one name that may hold spaces, or several. One that did not come is a note
  // where the model came alone, else throws Error{missing_resource}.
  void read_libraries(std::string_view names);

  // The number of the glTF material of that name; nothing, and a note, where no library has it.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name);

private:
  void read_library(std::string_view name);
  [[nodiscard]] std::optional<std::size_t> texture(const std::string& name);

  ModelBuilder& model_;
  const ModelFiles& files_;
  std::vector<Asset::Note>& notes_;
  std::map<std::string, Json, std::less<>> read_; // glTF materials by name; textures are file names yet
  std::map<std::string, std::optional<std::size_t>, std::less<>> numbers_, textures_;
};

} // namespace orbis::asset
