// Every file of the shared collection is read, or refused as its manifest says; nothing crashes.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/asset/asset.h"
#include "support/gltf_builder.h"

using namespace orbis;
using namespace orbis::asset;
namespace fs = std::filesystem;

namespace {

Bytes contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return test::bytes_of(text.str());
}

// Files in folders of a model's own are parts of it, by their names there.
Attachments neighbours(const fs::path& model) {
  Attachments out;
  if (model.extension() != ".gltf") return out;
  for (const auto& entry : fs::directory_iterator(model.parent_path())) {
    if (entry.is_regular_file() && entry.path() != model)
      out[entry.path().filename().string()] = contents(entry.path());
  }
  return out;
}

struct Row {
  std::string path, kind;
  std::size_t triangles = 0;
};

std::vector<Row> manifest(const fs::path& root) {
  std::vector<Row> rows;
  std::ifstream file(root / "MANIFEST.tsv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<std::string> cells(1);
    for (const char c : line) {
      if (c == '\t') {
        cells.emplace_back();
      } else {
        cells.back() += c;
      }
    }
    if (cells.size() > 6) rows.push_back({cells[0], cells[5], cells[6].empty() ? 0 : std::stoul(cells[6])});
  }
  return rows;
}

std::size_t triangle_count(const Asset& asset) {
  std::size_t n = 0;
  for (const Primitive& p : asset.primitives) n += p.indices.size() / 3;
  return n;
}

} // namespace

TEST_CASE("every file of the shared collection reads with the triangles of its manifest, or is refused") {
  const fs::path root = ORBIS_SHARED_DATA;
  if (!fs::exists(root / "MANIFEST.tsv")) {
    MESSAGE("the shared data is not here; skipped");
    return;
  }
  std::size_t read = 0, refused = 0;
  for (const Row& row : manifest(root)) {
    CAPTURE(row.path);
    try {
      const Asset asset = read_asset(contents(root / row.path), neighbours(root / row.path), Limits{});
      ++read;
      CHECK(row.kind != "ERROR");
      for (const Primitive& p : asset.primitives)
        for (std::size_t slot = 0; slot < texture_slots; ++slot)
          (void)material_texture(asset, p, static_cast<TextureSlot>(slot));
      // The manifest counts a mesh once for each node that shows it.
      if (row.kind.rfind("SINGLE", 0) == 0) CHECK(triangle_count(asset) == row.triangles);
    } catch (const Error& error) {
      ++refused;
      INFO(error.message());
      CHECK(error.code() != ErrorCode::internal);
      CHECK((row.kind == "ERROR" || row.kind == "EMPTY" || row.path == "made/hand-nan-positions.glb" ||
             error.code() == ErrorCode::unsupported_feature));
    }
  }
  MESSAGE(read << " files read, " << refused << " refused");
  CHECK(read + refused > 0);
}
