// Every file of the shared collection is read, or refused as its manifest says; nothing crashes.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "core/asset/asset.h"
#include "support/model_folder.h"

using namespace orbis;
using namespace orbis::asset;
namespace fs = std::filesystem;

namespace {

struct Row {
  std::string path, kind, notes;
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
    if (cells.size() > 6)
      rows.push_back({cells[0], cells[5], cells.back(), cells[6].empty() ? 0 : std::stoul(cells[6])});
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
      const Asset asset = read_asset(test::contents(root / row.path), test::neighbours(root / row.path), Limits{});
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
      const bool is_incomplete = row.notes.find("missing ") != std::string::npos;
      CHECK((row.kind == "ERROR" || row.kind == "EMPTY" || row.path == "made/hand-nan-positions.glb" ||
             error.code() == ErrorCode::unsupported_feature ||
             (is_incomplete && error.code() == ErrorCode::missing_resource)));
    }
  }
  MESSAGE(read << " files read, " << refused << " refused");
  CHECK(read + refused > 0);
}
