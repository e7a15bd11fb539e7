// The materials of an OBJ file as glTF's, from its libraries.
#pragma once

#include <map>
#include <string>
#include <utility>

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
  [[nodiscard]] std::optional<std::size_t> texture(const std::string& name, bool repeats);
  // A texture info of read_mtl with the texture's number in place of its file; nothing where that did not come.
  [[nodiscard]] std::optional<Json> with_index(const Json& info);

  ModelBuilder& model_;
  const ModelFiles& files_;
  std::vector<Asset::Note>& notes_;
  std::map<std::string, Json, std::less<>> read_; // read_mtl's materials by name
  std::map<std::string, std::optional<std::size_t>, std::less<>> numbers_;
  std::map<std::pair<std::string, bool>, std::optional<std::size_t>> textures_; // by file, and whether they repeat
};

} // namespace orbis::asset
