// The way through the house: bytes in, bytes out. No HTTP, no job, no file system, no global state.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/checkpoints.h"
#include "core/options.h"
#include "core/progress.h"
#include "core/report.h"

namespace orbis {

struct Request {
  std::span<const std::byte> model; // GLB, glTF JSON or Draco, recognised by content
  // Files that came with the request, by name: a glTF's .bin and images; for texture=cubemap the six images
  // ("px", "nx", "py", "ny", "pz", "nz", any extension) or one "equirectangular".
  std::map<std::string, std::vector<std::byte>, std::less<>> files;
  Options options;

  [[nodiscard]] std::vector<std::string_view> file_names() const;
};

// A map that was baked: "normal.png" and its contents.
struct MapFile {
  std::string name;
  std::vector<std::byte> bytes;
};

struct Result {
  std::vector<std::byte> glb;                    // with output=zip the archive that holds it
  std::vector<std::byte> atlas_png, preview_png; // to look at: base colour of the largest page; sphere and model
  std::vector<MapFile> maps;                     // as report.maps lists them
  Report report;
};

// Called with a file name ("2-simplified.obj", "5-atlas.png", …) and its contents, for `orbis run --dump-stages`.
using StageDump = std::function<void(std::string_view name, std::span<const std::byte> contents)>;

// Does the whole job. Throws Error; never returns an uncertified result. The result is the same whether the job was
// interrupted and taken up from a checkpoint or not. `dump` may be empty.
[[nodiscard]] Result process(const Request& request, const Limits& limits, Progress& progress, Checkpoints& checkpoints,
                             const StageDump& dump = {});

// Without checkpoints.
[[nodiscard]] inline Result process(const Request& request, const Limits& limits, Progress& progress,
                                    const StageDump& dump = {}) {
  NoCheckpoints none;
  return process(request, limits, progress, none, dump);
}

} // namespace orbis
